"""Coreference within a rule: "it" in one half is the object of the other half.

"To pass a knife grab it by the blade" is about one knife. A rule about two different objects is
rejected, and one over several objects, uses or acts becomes as many rules.
"""

from dataclasses import replace

from .discourse import SOMETHING, Discourse
from .predicates import PredicateForm, UninterpretableError

IT = PredicateForm("it")

_HILT = PredicateForm("self")
_TWICE = frozenset({"obliged", "beforehand", "without", "whenIs"})
"""Norms that may name an object twice, once as "it"."""


def resolve_rules(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    """Return the form with the pronouns of each rule replaced by what the rule is about."""
    match form.name, form.arguments:
        case "and", (one, other):
            # The second rule may speak of the first one's object.
            first = resolve_rules(one, discourse)
            known = _object_of_rule(first) or discourse.object
            second = resolve_rules(other, replace(discourse, object=known))
            return PredicateForm("and", (first, second))
        case "implies", _:
            return _resolve_rule(form, discourse)
        case "within", (occasion, rule):
            form = _on_occasion(occasion, rule)
        case "holding", (PredicateForm(arguments=(_, held, *_)) as act, place):
            return PredicateForm("holding", (act, place.replacing(IT, held)))
        case "how", (act, held):
            return PredicateForm("how", (act.replacing(IT, held),))
        case "first", (thing, act):
            # "Take the mug and pass it to me": the second act must be on the first one's object.
            if IT not in act:
                raise UninterpretableError("one_thing_at_a_time")
            form = act.replacing(IT, thing)
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


def _resolve_rule(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    alternatives = _alternatives(form)
    if alternatives:
        return resolve_rules(PredicateForm("and", alternatives), discourse)
    if form.arguments[1].name == "graspObject":
        return _resolve_action_rule(form, discourse)
    return form.replacing(IT, discourse.object) if discourse.object else form


def _alternatives(form: PredicateForm) -> tuple[PredicateForm, ...]:
    for place, argument in enumerate(form.arguments):
        if argument.name in {"both", "eitherOf", "butNot"}:
            before, after = form.arguments[:place], form.arguments[place + 1 :]
            rules = [(*before, each, *after) for each in argument.arguments]
            if argument.name == "butNot":
                rules[1] = (*rules[1][:-1], PredicateForm("none"))
            return tuple(PredicateForm("implies", each) for each in rules)
    return ()


def _resolve_action_rule(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    context, act, degree = form.arguments
    actor, place = act.arguments
    part, owners = _part(place)
    candidates = [_grasped_object(context, owners), *owners]
    known = _most_specific(candidates) or discourse.object
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
    arguments = context.arguments
    if len(arguments) == 3 and context.name != "pass":
        return arguments[2]
    if len(arguments) < 2:
        raise UninterpretableError("no_act")
    held = arguments[1]
    if is_tool_act(context) and owners and _most_specific(owners) not in {None, held}:
        return IT
    return held


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
