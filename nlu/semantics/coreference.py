"""Coreference: resolving "it", "they", "one" and "the former" from what was said before.

Outside a rule, "it" refers to the object mentioned last, "they" to all objects that the last turn
named, "the former" and "the latter" to the first and the last of them. "One" is an object of the
kind mentioned last. A turn that failed leaves no referent. In a rule, "it" is the object of its
other half; one about two objects is rejected, one over several objects or acts becomes several.
"""

from dataclasses import replace

from .discourse import SOMETHING, Discourse, use_form
from .meaning import ActionRule, Command, Question
from .predicates import PredicateForm, UninterpretableError, load_predicates

IT, THEY, ONE, THE_TWO = map(PredicateForm, ("it", "they", "one", "theTwo"))
LAST_USE = PredicateForm("lastUse")
_LAST_MATERIAL = PredicateForm("lastMaterial")
_THE_OTHER = PredicateForm("theOther")
PRONOUNS = frozenset({IT, THEY, _THE_OTHER})
PERSONAL = frozenset(map(PredicateForm, ("him", "her", "them")))

_ONE_OF_SEVERAL = PredicateForm("oneOfSeveral")
_ORDINALS = {"former": 0, "latter": -1}
_HILT = PredicateForm("self")
_TWICE = frozenset({"obliged", "beforehand", "without", "whenIs"})
"""Norms that may name an object twice, once as "it"."""
_HOLDING = frozenset({"implies", "permitted", "holding", "graspObject", "correctPart", "fillPart"})
"""The forms that may say by which part, and by which other part not."""


def resolve(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    """Return the form with every pronoun replaced by its referent.

    It raises `UninterpretableError` without a referent, or where one rule is about two objects.
    """
    discourse = discourse.accessible
    if any(part.name in load_predicates().fragments for part in form):
        form = form.replacing(_THE_OTHER, PredicateForm("other", (ONE,)))
    form = form.mapped(lambda part: _ordinal(part, discourse))
    # Twice, since the tool may be "something that is used for cutting".
    form = form.mapped(_with_use_or_tool).mapped(_with_use_or_tool)
    form = _as_correction(form, discourse) or form
    if form.name in {"correctPart", "fillPart"}:
        parts = {getattr(said, "part", None) for said in (discourse.rule, discourse.last)} - {None}
        others = {each.arguments[1].said for each in form if each.name == "butNot"}
        if parts and not others <= parts:  # "not by the rim", of which nobody spoke
            raise UninterpretableError("of_which_object", asks=True)
    form = form.mapped(_with_each_material).mapped(_with_each_part)
    form = form.mapped(_to_anyone).mapped(lambda part: _person(part, discourse))
    if THE_TWO in form:
        if len(discourse.pair) < 2:
            raise UninterpretableError("no_referent", asks=True, word="both")
        form, discourse = form.replacing(THE_TWO, THEY), replace(discourse, named=discourse.pair)
    if THEY in form:
        return _resolve_they(form, discourse)
    if len(discourse.named) > 1 and discourse.object != THEY:
        discourse = replace(discourse, object=_ONE_OF_SEVERAL)
    rest = simplified(resolve_rules(form, discourse))
    if discourse.object:
        rest = simplified(rest.replacing(IT, discourse.object))
    elif IT in rest:
        raise UninterpretableError("no_referent", asks=True, word=IT.name)
    if _ONE_OF_SEVERAL in rest:
        raise UninterpretableError("which_thing", asks=True)
    return rest


def _ordinal(part: PredicateForm, discourse: Discourse) -> PredicateForm | None:
    if part == LAST_USE:
        last = discourse.last
        named = getattr(last, "target", None) or getattr(last, "tool", last)
        use = getattr(named, "affordance", None) or getattr(named, "used_for", None)
        is_guess = discourse.is_offered and isinstance(last, Question)
        if named is None or use is None or is_guess:
            raise UninterpretableError("no_referent", asks=True, word="the use")
        return use_form(use, getattr(named, "material", None) or getattr(last, "patient", None))
    if part == _LAST_MATERIAL:
        said = (getattr(each, "material", None) for each in (discourse.last, discourse.rule))
        if material := next(filter(None, said), None):
            return PredicateForm.named(material)
        raise UninterpretableError("no_referent", asks=True, word="them")
    if part == ONE:
        is_described = isinstance(discourse.last, Command) and discourse.last.target.object is None
        known = None if is_described else discourse.object
        return noun_of(known) if known else PredicateForm("something")
    if part == _THE_OTHER:
        others = [each for each in discourse.pair if each != discourse.object]
        is_clear = len(discourse.pair) == 2 and len(others) == 1
        return others[0] if is_clear else PredicateForm("other", (_ordinal(ONE, discourse) or ONE,))
    if part.name not in _ORDINALS or part.arguments:
        return None
    if len(discourse.pair) < 2:
        raise UninterpretableError("no_referent", asks=True, word=f"the {part.name}")
    return discourse.pair[_ORDINALS[part.name]]


def _to_anyone(form: PredicateForm) -> PredicateForm | None:
    def change(act: PredicateForm) -> PredicateForm | None:
        is_to_them = len(act.arguments) > 2 and act.arguments[-1] in PERSONAL
        return PredicateForm(act.name, act.arguments[:-1]) if is_to_them else None

    return form.mapped(change) if form.name in {"implies", "within"} else None


def _person(part: PredicateForm, discourse: Discourse) -> PredicateForm | None:
    if part in PERSONAL and discourse.person is None:
        raise UninterpretableError("which_person", asks=True, word=part.name)
    return discourse.person if part in PERSONAL else None


def _resolve_they(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    rest = resolve(form.replacing(THEY, IT), replace(discourse, object=THEY))
    if THEY not in rest:
        return rest
    if not discourse.named:
        raise UninterpretableError("no_referent", asks=True, word=THEY.name)
    each = [simplified(rest.replacing(THEY, named)) for named in discourse.named]
    return each[0] if len(each) == 1 else PredicateForm("and", tuple(each))


def _with_use_or_tool(form: PredicateForm) -> PredicateForm | None:
    match form.name, form.arguments:
        case "thatIs", (thing, PredicateForm("implies", (_, use, degree))) if use.name not in {
            "graspObject",
            "usedFor",
            "notUsedFor",
            "both",
        }:
            return PredicateForm("notUsedFor" if degree.name == "none" else "usedFor", (thing, use))
        case "use", (_, tool, act) if is_tool_act(act) and len(act.arguments) == 2:
            return PredicateForm(act.name, (*act.arguments, tool))
        case ("thatIs", _) | ("use", (_, _, _)):
            raise UninterpretableError("one_thing_at_a_time")
        case _:
            return None


def _with_each_material(form: PredicateForm) -> PredicateForm | None:
    if form.name != "of" or form.arguments[1].name not in {"both", "butNot"}:
        return None
    use, several = form.arguments
    each = (PredicateForm("of", (use, material)) for material in several.arguments)
    return PredicateForm(several.name, tuple(part.mapped(_with_each_material) for part in each))


def _as_correction(form: PredicateForm, discourse: Discourse) -> PredicateForm | None:
    # "Hold it by the handle instead of the blade", after a rule that said the blade.
    rule = discourse.rule
    if form.name not in {"holding", "graspObject"} or not isinstance(rule, ActionRule):
        return None
    act, place = form.arguments
    several = next((part for part in place if part.name == "butNot"), None)
    thing = place.arguments[-1] if form.name == "graspObject" else act.arguments[1]
    is_of_rule = form.name == "graspObject" or act.name in {rule.context, "grasp"}
    if several is None or not is_of_rule or thing.said not in {IT.name, rule.object}:
        return None
    part, other = several.arguments
    return PredicateForm("correctPart", (part,)) if other.said == rule.part else None


def _with_each_part(form: PredicateForm) -> PredicateForm | None:
    if form.name not in _HOLDING:
        return None
    act = form.arguments[1] if form.name == "implies" else form
    several = next((part for part in act if part.name == "butNot"), None)
    if several is None or (form.name == "implies" and act.name != "graspObject"):
        return None
    each = tuple(act.replacing(several, part) for part in several.arguments)
    if form.name == "permitted":  # by the rim, but not by the handle
        return PredicateForm("and", (each[0], PredicateForm("forbidden", each[1].arguments)))
    if form.name != "implies":
        return each[0]
    context, _, degree = form.arguments
    return PredicateForm("implies", (context, PredicateForm("butNot", each), degree))


def resolve_rules(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    """Return the form with the pronouns of each rule replaced by what the rule is about."""
    match form.name, form.arguments:
        case "and", (one, other):
            # The second rule may speak of the first one's object.
            first = resolve_rules(one, discourse)
            known = _object_of_rule(first) or discourse.object
            second = resolve_rules(other, replace(discourse, object=known))
            return PredicateForm("and", (first, second))
        case "implies", (_, act, *_):
            alternatives, known = _alternatives(form), discourse.object or IT
            if not alternatives:
                is_held = act.name == "graspObject"
                return _resolve_act(form, discourse) if is_held else form.replacing(IT, known)
            form = PredicateForm("and", alternatives)
        case "within", (occasion, rule):
            form = _on_occasion(occasion, rule)
        case "holding", (PredicateForm(arguments=(_, held, *_)) as act, place):
            return PredicateForm("holding", (act, place.replacing(IT, held)))
        case "how", (act, held):
            act = act.replacing(IT, held)
            is_tool = is_tool_act(act) and len(act.arguments) == 2 and act.arguments[1] != held
            return PredicateForm(
                "how", (PredicateForm(act.name, (*act.arguments, held)) if is_tool else act,)
            )
        case "first", (thing, act):
            # "Take the mug and pass it to me": the second act must be on the first one's object.
            if IT not in act:
                raise UninterpretableError("one_thing_at_a_time")
            form = act.replacing(IT, thing)
        case "whenIs", (norm, state) if IT in norm and noun_of(state) != IT:
            form = PredicateForm("whenIs", (norm.replacing(IT, noun_of(state)), state))
        case name, _ if name in _TWICE and IT in form and _acted_on(form):
            form = form.replacing(IT, _acted_on(form) or IT)
        case _:
            arguments = (resolve_rules(part, discourse) for part in form.arguments)
            return PredicateForm(form.name, tuple(arguments))
    return resolve_rules(form, discourse)


def _acted_on(form: PredicateForm) -> PredicateForm | None:
    acts = (each.arguments for each in form if len(each.arguments) > 1)
    return next((held for actor, held, *_ in acts if actor == _HILT and held != IT), None)


def simplified(form: PredicateForm) -> PredicateForm:
    """The form with nested parts of one object flattened, and uses "on something" as plain uses."""

    def change(part: PredicateForm) -> PredicateForm | None:
        if part.name == "of" and part.arguments[1].name in SOMETHING:
            return part.arguments[0]
        if part.name != "partOf" or part.arguments[0].name != "partOf":
            return None
        innermost, owners = _part(part)
        known = _most_specific(owners)
        return PredicateForm("partOf", (innermost, known)) if known is not None else None

    return form.mapped(change)


def is_tool_act(context: PredicateForm) -> bool:
    """Return whether a context is an act with a tool."""
    return context.name not in {"pass", "pickUp", "pointTo", "grasp", "use"}


def noun_of(form: PredicateForm) -> PredicateForm:
    """Return an object without its properties and uses."""
    while form.name in {"having", "usedFor", "notUsedFor"}:
        form = form.arguments[0]
    return form


def _on_occasion(occasion: PredicateForm, rule: PredicateForm) -> PredicateForm:
    if rule.name == "and":
        return PredicateForm("and", tuple(_on_occasion(occasion, each) for each in rule.arguments))
    if rule.name != "implies":
        raise UninterpretableError("not_a_rule")
    if rule.arguments[0].name != occasion.name or len(occasion.arguments) < 2:
        raise UninterpretableError("one_thing_at_a_time")
    return rule.replacing(IT, occasion.arguments[1])


def _alternatives(form: PredicateForm) -> tuple[PredicateForm, ...]:
    for place, argument in enumerate(form.arguments):
        if argument.name in {"both", "eitherOf", "butNot"}:
            before, after = form.arguments[:place], form.arguments[place + 1 :]
            rules = [(*before, each, *after) for each in argument.arguments]
            if argument.name == "butNot":
                rules[1] = (*rules[1][:-1], PredicateForm("none"))
            return tuple(PredicateForm("implies", each) for each in rules)
    return ()


def _resolve_act(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    context, act, degree = form.arguments
    actor, place = act.arguments
    part, owners = _part(place)
    known = _most_specific([_grasped_object(context, owners), *owners]) or discourse.object
    if known is None:
        raise UninterpretableError("of_which_object", asks=True)
    act = PredicateForm("graspObject", (actor, PredicateForm("partOf", (part, known))))
    return PredicateForm("implies", (_with_object(context, known), act, degree))


def _part(place: PredicateForm) -> tuple[PredicateForm, list[PredicateForm]]:
    owners: list[PredicateForm] = []
    while place.name == "partOf":
        place, owner = place.arguments
        owners.append(owner)
    return place, owners


def _grasped_object(context: PredicateForm, owners: list[PredicateForm]) -> PredicateForm:
    match context.arguments:
        case _, _, tool if context.name != "pass":
            return tool
        case _, held, *_:
            is_of_tool = is_tool_act(context) and _most_specific(owners) not in {None, held}
            return IT if is_of_tool else held
        case _:
            raise UninterpretableError("no_act")


def _with_object(context: PredicateForm, known: PredicateForm) -> PredicateForm:
    arguments = tuple(known if argument == IT else argument for argument in context.arguments)
    if len(arguments) == 3 and context.name != "pass":
        return PredicateForm(context.name, (*arguments[:2], known))
    if is_tool_act(context) and noun_of(arguments[1]) != noun_of(known):
        return PredicateForm(context.name, (*arguments, known))
    return PredicateForm(context.name, (arguments[0], known, *arguments[2:]))


def _most_specific(candidates: list[PredicateForm]) -> PredicateForm | None:
    known: PredicateForm | None = None
    for candidate in candidates:
        if candidate == IT:
            continue
        if known is not None:
            first, second = noun_of(known).name, noun_of(candidate).name
            if noun_of(known) != noun_of(candidate) and not SOMETHING & {first, second}:
                raise UninterpretableError("two_objects", first=first, second=second)
        if known is None or len(list(candidate)) >= len(list(known)):
            known = candidate
    return known


def _object_of_rule(form: PredicateForm) -> PredicateForm | None:
    if form.name == "and":
        return _object_of_rule(form.arguments[-1])
    if form.name != "implies":
        return None
    if form.arguments[1].name == "graspObject":
        return form.arguments[1].arguments[1].arguments[1]
    return form.arguments[0]
