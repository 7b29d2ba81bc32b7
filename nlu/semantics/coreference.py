# SPDX-License-Identifier: Apache-2.0
"""Coreference: resolving "it", "they", "one" and "the former" in and before a sentence.

Within a rule, "it" in one half refers to the object of the other half: "to pass a knife grab it by
the blade". Elsewhere it refers to the object mentioned last, "they" to all objects that the last
turn named, "the former" and "the latter" to the first and the last of them. "One" is an object of
the kind mentioned last. A turn that failed leaves no referent. A rule about two different objects
is rejected.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace

from .meaning import (
    ANY_OBJECT,
    Acknowledgement,
    AskBack,
    Command,
    FunctionalRule,
    Meaning,
    Misunderstanding,
    ObjectReference,
    Question,
    Rule,
    Statement,
    ToolCommand,
)
from .predicates import PredicateForm

IT, THEY, ONE = PredicateForm("it"), PredicateForm("they"), PredicateForm("one")
LAST_USE = PredicateForm("lastUse")
PRONOUNS = frozenset({IT, THEY})
PERSONAL = frozenset(map(PredicateForm, ("him", "her", "them")))
SOMETHING = frozenset({"something", "anything"})

_ONE_OF_SEVERAL = PredicateForm("oneOfSeveral")
_ORDINALS = {"former": 0, "latter": -1}
_OF_USE = frozenset({"usedFor", "notUsedFor", "both"})
_HILT = PredicateForm("self")
_OBJECT_FIRST = frozenset(
    {"usesOf", "about", "see", "source", "why", "whyNot", "topic", "exceptions", "inHand"}
)
_OBJECT_SECOND = frozenset({"pass", "pickUp", "pointTo", "grasp", "use", "need", "have"})


@dataclass(frozen=True)
class Discourse:
    """The discourse state.

    Attributes:
        object: the object mentioned last.
        rule: the rule taught, corrected or applied last.
        last: the last rule, question or command, which a fragment completes.
        command: the last command, which "do it again" repeats.
        named: all objects that the last turn with any named, in order.
        pair: "the former", ..., "the latter": the last turn's objects, or two mentioned in a row.
        person: the person named last, except the speaker.
        asks_why: whether the last turn asked why a thing was held as it was, or just why.
        has_failed: whether the last turn was not understood, so that nothing can be referred to.
    """

    object: PredicateForm | None = None
    rule: Rule | None = None
    last: Rule | Question | Command | ToolCommand | None = None
    command: Command | ToolCommand | None = None
    named: tuple[PredicateForm, ...] = ()
    pair: tuple[PredicateForm, ...] = ()
    person: PredicateForm | None = None
    asks_why: bool = False
    has_failed: bool = False

    def about(self, name: str) -> Discourse:
        """Return this state after an object of this name was mentioned."""
        return self.naming(PredicateForm(name.replace(" ", "_")))

    def with_person(self, name: str) -> Discourse:
        """Return this state after a person of this name was mentioned."""
        return replace(self, person=PredicateForm(name.replace(" ", "_")), has_failed=False)

    def naming(self, *named: PredicateForm, last: PredicateForm | None = None) -> Discourse:
        """Return this state after a turn that named these objects; `last` is that of "it"."""
        pair = self.pair
        if len(named) > 1:
            pair = named
        elif self.object is not None and not set(named) <= set(pair):
            pair = (self.object, *named)
        return replace(self, object=last or tuple(named)[-1], named=named, pair=pair)

    @property
    def accessible(self) -> Discourse:
        """This state, or an empty one after a turn that failed."""
        return Discourse() if self.has_failed else self


class UninterpretableError(ValueError):
    """A predicate form has no meaning for Hilt.

    The reason is the answer template `key` with its slots; it may ask a clarification question.
    """

    def __init__(self, key: str, *, asks: bool = False, **slots: str) -> None:
        self.key, self.asks, self.slots = key, asks, slots
        super().__init__(key)


class UnlearnableError(UninterpretableError):
    """What was said is clear as a whole, but is nothing that Hilt learns."""


def resolve(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    """Return the form with every pronoun replaced by its referent.

    Raises:
        RefusedError: there is no referent, or one rule is about two objects.
    """
    discourse = discourse.accessible
    form = form.mapped(lambda part: _ordinal(part, discourse)).mapped(_with_use).mapped(_with_tool)
    form = form.mapped(_with_each_material).mapped(_with_each_part)
    form = form.mapped(_to_anyone).mapped(lambda part: _person(part, discourse))
    if THEY in form:
        return _resolve_they(form, discourse)
    if len(discourse.named) > 1 and discourse.object != THEY:
        discourse = replace(discourse, object=_ONE_OF_SEVERAL)
    rest = _simplified(_resolve_rules(form, discourse))
    if IT in rest and discourse.object is None:
        raise UninterpretableError("no_referent", asks=True, word=IT.name)
    rest = _simplified(_replace_it(rest, discourse.object)) if discourse.object else rest
    if _ONE_OF_SEVERAL in rest:
        raise UninterpretableError("which_thing", asks=True)
    return rest


def _ordinal(part: PredicateForm, discourse: Discourse) -> PredicateForm | None:
    """The referent of "the former" or "the latter", the kind of "one", and the last use."""
    if part == LAST_USE:
        return _last_use(discourse)
    if part == ONE:
        is_described = isinstance(discourse.last, Command) and discourse.last.target.object is None
        known = None if is_described else discourse.object
        return _noun(known) if known else PredicateForm("something")
    if part.name not in _ORDINALS or part.arguments:
        return None
    if len(discourse.pair) < 2:
        raise UninterpretableError("no_referent", asks=True, word=f"the {part.name}")
    return discourse.pair[_ORDINALS[part.name]]


def _to_anyone(part: PredicateForm) -> PredicateForm | None:
    """A rule on what "them" are passed as one on what is passed: it says nothing of a person."""
    if part.name not in {"implies", "within"}:
        return None
    return part.mapped(_without_recipient) if not PERSONAL.isdisjoint(part) else None


def _without_recipient(act: PredicateForm) -> PredicateForm | None:
    is_to_them = len(act.arguments) > 2 and act.arguments[-1] in PERSONAL
    return PredicateForm(act.name, act.arguments[:-1]) if is_to_them else None


def _person(part: PredicateForm, discourse: Discourse) -> PredicateForm | None:
    """The person named last for "him", "her" or "them"; an error when there is none."""
    if part not in PERSONAL:
        return None
    if discourse.person is None:
        raise UninterpretableError("which_person", asks=True, word=part.name)
    return discourse.person


def _last_use(discourse: Discourse) -> PredicateForm:
    """The use that the last rule or question is about."""
    last = discourse.last
    if not isinstance(last, (FunctionalRule, Question)) or last.affordance is None:
        raise UninterpretableError("no_referent", asks=True, word="the use")
    return _use_form(last.affordance, last.material)


def _use_form(use: str, material: str | None) -> PredicateForm:
    act = PredicateForm(use.replace(" ", "_"))
    return (
        PredicateForm("of", (act, PredicateForm(material.replace(" ", "_")))) if material else act
    )


def _resolve_they(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    """The form with "they" as its own object, else once for each of the objects named."""
    as_one = form.mapped(lambda part: IT if part == THEY else None)
    rest = resolve(as_one, replace(discourse, object=THEY))
    if THEY not in rest:
        return rest
    if not discourse.named:
        raise UninterpretableError("no_referent", asks=True, word=THEY.name)
    each = [_simplified(rest.mapped(_replacing(THEY, named))) for named in discourse.named]
    return each[0] if len(each) == 1 else PredicateForm("and", tuple(each))


def _replacing(
    old: PredicateForm, new: PredicateForm
) -> Callable[[PredicateForm], PredicateForm | None]:
    return lambda part: new if part == old else None


def _with_use(form: PredicateForm) -> PredicateForm | None:
    """`thatIs(x, implies(x, cutting, high))`, a relative clause, as `usedFor(x, cutting)`."""
    if form.name != "thatIs":
        return None
    thing, clause = form.arguments
    if clause.name != "implies" or clause.arguments[1].name in {"graspObject", *_OF_USE}:
        raise UninterpretableError("one_thing_at_a_time")
    _, use, degree = clause.arguments
    return PredicateForm("notUsedFor" if degree.name == "none" else "usedFor", (thing, use))


def _with_tool(form: PredicateForm) -> PredicateForm | None:
    """`use(self, hammer, pound(self, nail))` as `pound(self, nail, hammer)`."""
    if form.name != "use" or len(form.arguments) != 3:
        return None
    _, tool, act = form.arguments
    if not _is_tool_act(act) or len(act.arguments) != 2:
        raise UninterpretableError("one_thing_at_a_time")
    return PredicateForm(act.name, (*act.arguments, tool))


def _with_each_material(form: PredicateForm) -> PredicateForm | None:
    """`of(cutting, both(bread, wood))` as `both(of(cutting, bread), of(cutting, wood))`."""
    if form.name != "of" or form.arguments[1].name not in {"both", "butNot"}:
        return None
    use, several = form.arguments
    each = (PredicateForm("of", (use, material)) for material in several.arguments)
    return PredicateForm(several.name, tuple(part.mapped(_with_each_material) for part in each))


def _with_each_part(form: PredicateForm) -> PredicateForm | None:
    """A rule on `butNot(handle, blade)` as one on `butNot` of two grasps; an act on the first."""
    if form.name not in {"implies", "holding", "graspObject", "correctPart", "fillPart"}:
        return None
    act = form.arguments[1] if form.name == "implies" else form
    several = next((part for part in act if part.name == "butNot"), None)
    if several is None or (form.name == "implies" and act.name != "graspObject"):
        return None
    each = tuple(act.mapped(_replacing(several, part)) for part in several.arguments)
    if form.name != "implies":
        return each[0]
    context, _, degree = form.arguments
    return PredicateForm("implies", (context, PredicateForm("butNot", each), degree))


def _resolve_rules(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    match form.name, form.arguments:
        case "and", (one, other):
            # The second rule may speak of the first one's object.
            first = _resolve_rules(one, discourse)
            known = _object_of_rule(first) or discourse.object
            second = _resolve_rules(other, replace(discourse, object=known))
            return PredicateForm("and", (first, second))
        case "implies", _:
            return _resolve_rule(form, discourse)
        case "within", (occasion, rule):
            form = _on_occasion(occasion, rule)
        case "holding", (PredicateForm(arguments=(_, held, *_)) as act, place):
            return PredicateForm("holding", (act, _replace_it(place, held)))
        case "how", (act, held):
            return PredicateForm("how", (_replace_it(act, held),))
        case "first", (thing, act):
            # "Take the mug and pass it to me": the second act must be on the first one's object.
            if IT not in act:
                raise UninterpretableError("one_thing_at_a_time")
            form = _replace_it(act, thing)
        case _:
            arguments = (_resolve_rules(part, discourse) for part in form.arguments)
            return PredicateForm(form.name, tuple(arguments))
    return _resolve_rules(form, discourse)


def _on_occasion(occasion: PredicateForm, rule: PredicateForm) -> PredicateForm:
    """A rule stated with its occasion: "if I want a mug, pass it by the rim"."""
    if rule.name == "and":
        return PredicateForm("and", tuple(_on_occasion(occasion, each) for each in rule.arguments))
    if rule.name != "implies":
        raise UninterpretableError("not_a_rule")
    context, act, degree = rule.arguments
    if context.name != occasion.name or len(occasion.arguments) < 2:
        raise UninterpretableError("one_thing_at_a_time")
    return _replace_it(PredicateForm("implies", (context, act, degree)), occasion.arguments[1])


def _resolve_rule(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    alternatives = _alternatives(form)
    if alternatives:
        return _resolve_rules(PredicateForm("and", alternatives), discourse)
    if form.arguments[1].name == "graspObject":
        return _resolve_action_rule(form, discourse)
    return _replace_it(form, discourse.object) if discourse.object else form


def _alternatives(form: PredicateForm) -> tuple[PredicateForm, ...]:
    """The rules that one `implies` over two objects, uses or acts expands to; empty for one."""
    for place, argument in enumerate(form.arguments):
        if argument.name in {"both", "eitherOf", "butNot"}:
            before, after = form.arguments[:place], form.arguments[place + 1 :]
            rules = [
                PredicateForm("implies", (*before, each, *after)) for each in argument.arguments
            ]
            if argument.name == "butNot":
                rules[1] = PredicateForm(
                    "implies", (*rules[1].arguments[:-1], PredicateForm("none"))
                )
            return tuple(rules)
    return ()


def _replace_it(form: PredicateForm, known: PredicateForm) -> PredicateForm:
    return form.mapped(lambda part: known if part == IT else None)


def _resolve_action_rule(form: PredicateForm, discourse: Discourse) -> PredicateForm:
    """`implies(context, graspObject(self, partOf(part, object)), degree)` about one object."""
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
    """The innermost part, and all objects that it is called a part of."""
    owners: list[PredicateForm] = []
    while place.name == "partOf":
        place, owner = place.arguments
        owners.append(owner)
    return place, owners


def _simplified(form: PredicateForm) -> PredicateForm:
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


def _grasped_object(context: PredicateForm, owners: list[PredicateForm]) -> PredicateForm:
    """The object grasped in a context: the tool, where there is one."""
    arguments = context.arguments
    if len(arguments) == 3 and context.name != "pass":
        return arguments[2]
    if len(arguments) < 2:
        raise UninterpretableError("no_act")
    held = arguments[1]
    if _is_tool_act(context) and owners and _most_specific(owners) not in {None, held}:
        return IT
    return held


def _is_tool_act(context: PredicateForm) -> bool:
    return context.name not in {"pass", "pickUp", "pointTo", "grasp", "use"}


def _with_object(context: PredicateForm, known: PredicateForm) -> PredicateForm:
    arguments = tuple(known if argument == IT else argument for argument in context.arguments)
    if len(arguments) == 3 and context.name != "pass":
        return PredicateForm(context.name, (*arguments[:2], known))
    if _is_tool_act(context) and _noun(arguments[1]) != _noun(known):
        return PredicateForm(context.name, (*arguments, known))
    return PredicateForm(context.name, (arguments[0], known, *arguments[2:]))


def _most_specific(candidates: list[PredicateForm]) -> PredicateForm | None:
    """The most specific of the candidates, which must be one object; None when all are "it"."""
    known: PredicateForm | None = None
    for candidate in candidates:
        if candidate == IT:
            continue
        if known is not None:
            first, second = _noun(known).name, _noun(candidate).name
            if _noun(known) != _noun(candidate) and not SOMETHING & {first, second}:
                raise UninterpretableError("two_objects", first=first, second=second)
        if known is None or len(list(candidate)) >= len(list(known)):
            known = candidate
    return known


def _noun(form: PredicateForm) -> PredicateForm:
    while form.name in {"having", "usedFor", "notUsedFor"}:
        form = form.arguments[0]
    return form


def _object_of_rule(form: PredicateForm) -> PredicateForm | None:
    if form.name == "and":
        return _object_of_rule(form.arguments[-1])
    if form.name != "implies":
        return None
    if form.arguments[1].name == "graspObject":
        return form.arguments[1].arguments[1].arguments[1]
    return form.arguments[0]


def update_discourse(meaning: Meaning, content: PredicateForm, discourse: Discourse) -> Discourse:
    """Return the discourse state after an utterance with a meaning and a predicate form."""
    if isinstance(meaning, (Acknowledgement, AskBack, Misunderstanding)):
        return discourse
    person = _named_person(meaning) or discourse.person
    asks_why = _asks_why_held(meaning)
    discourse = replace(discourse.accessible, person=person, asks_why=asks_why)
    mentioned = None if isinstance(meaning, Command) else _mentioned_object(content)
    named = tuple(dict.fromkeys(_named_objects(meaning)))
    if mentioned is not None:
        named = named if len(named) > 1 else (mentioned,)
    if named:
        discourse = discourse.naming(*named, last=mentioned)
    match meaning:
        case Statement(rules=rules):
            last = replace(rules[-1], source=None)  # what completes it are the speaker's own words
            return replace(discourse, rule=last, last=last)
        case Question(object=None, affordance=None):
            return discourse  # about Hilt or about what was just said
        case Question():
            return replace(discourse, last=meaning)
        case Command() | ToolCommand():
            return replace(discourse, last=meaning, command=meaning)
        case _:
            return discourse


def _asks_why_held(meaning: Meaning) -> bool:
    """Whether a meaning asks why a thing was held as it was, or just why."""
    if not isinstance(meaning, Question) or meaning.ask != "why":
        return False
    return meaning.part is not None or meaning.object is None


def after_offer(choices: Sequence[Meaning | str], discourse: Discourse) -> Discourse:
    """Return the discourse state after meanings were offered: "it" is what they all name."""
    offered = [tuple(_named_objects(choice)) for choice in choices if not isinstance(choice, str)]
    named = offered[0] if offered else ()
    if not named or any(each != named for each in offered):
        return discourse
    discourse = discourse.accessible.naming(*dict.fromkeys(named))
    match choices:
        case (Statement(rules=(rule,)),):  # "no, by the handle" may correct it
            return replace(discourse, rule=rule, last=rule)
        case _:
            return discourse


def _named_person(meaning: Meaning) -> PredicateForm | None:
    """The person whom a command names as its recipient, or a statement as its source."""
    match meaning:
        case Command(recipient=str(name)) | Statement(source=str(name)):
            return PredicateForm(name.replace(" ", "_"))
        case _:
            return None


def _named_objects(meaning: Meaning) -> Iterator[PredicateForm]:
    """The objects that a meaning is about, in order."""
    match meaning:
        case Statement(rules=rules):
            for rule in rules:
                yield from _object_form(rule.object, rule.props)
        case Command(target=ObjectReference(used_for=str(use)) as target):
            act = _use_form(use, target.material)
            yield _with_props(
                PredicateForm("usedFor", (PredicateForm("something"), act)), target.props
            )
        case Command(target=ObjectReference(object=name, props=props)):
            yield from _object_form(name, props)
        case ToolCommand(patient=name):
            yield from _object_form(name, ())
        case Question(object=name):
            yield from _object_form(name, ())
        case _:
            return


def _object_form(name: str | None, props: tuple[str, ...]) -> Iterator[PredicateForm]:
    if name is None or name == ANY_OBJECT:
        return
    yield _with_props(PredicateForm(name.replace(" ", "_")), props)


def _with_props(form: PredicateForm, props: tuple[str, ...]) -> PredicateForm:
    for prop in props:
        form = PredicateForm("having", (form, PredicateForm(prop.replace(" ", "_"))))
    return form


def _mentioned_object(form: PredicateForm) -> PredicateForm | None:
    """The object that a form is about: the last one named in it."""
    if form.name == "partOf":
        return form.arguments[1]
    if form.name == "and":
        return _mentioned_object(form.arguments[-1])
    if form.name == "implies" and form.arguments[1].name != "graspObject":
        return form.arguments[0]
    within = next(filter(None, map(_mentioned_object, form.arguments)), None)
    if form.name in _OBJECT_FIRST and form.arguments and not within:
        return form.arguments[0]
    is_act = form.name in _OBJECT_SECOND or form.arguments[:1] == (_HILT,)
    if is_act and len(form.arguments) > 1:
        # Of an act with a tool it is what it is done to, if that was named.
        return next((each for each in form.arguments[1:] if each.name not in SOMETHING), None)
    return within
