# SPDX-License-Identifier: Apache-2.0
"""Coreference: resolving "it" in the sentence and in the conversation before it.

Within a rule, "it" in one half refers to the object of the other half: "to pass a knife grab it by
the blade". Elsewhere it refers to the object mentioned last. A rule about two different objects is
rejected.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

from .meaning import AskBack, Meaning, Misunderstanding, Rule, Statement
from .predicates import Form

IT = Form("it")
SOMETHING = frozenset({"something", "anything"})

_OF_USE = frozenset({"usedFor", "notUsedFor", "both"})
_HILT = Form("self")
_OBJECT_FIRST = frozenset(
    {"usesOf", "about", "see", "source", "why", "whyNot", "topic", "exceptions", "inHand"}
)
_OBJECT_SECOND = frozenset({"pass", "pickUp", "pointTo", "grasp", "use", "need", "have"})


@dataclass(frozen=True)
class Discourse:
    """The discourse state: the object mentioned last and the rule taught or corrected last."""

    object: Form | None = None
    rule: Rule | None = None


class RefusedError(ValueError):
    """A predicate form has no meaning for Hilt.

    The reason is the answer template `key` with its slots; it may ask a clarification question.
    """

    def __init__(self, key: str, *, asks: bool = False, **slots: str) -> None:
        self.key, self.asks, self.slots = key, asks, slots
        super().__init__(key)


def resolve(form: Form, discourse: Discourse) -> Form:
    """Return the form with every "it" replaced by its referent.

    Raises:
        RefusedError: there is no referent, or one rule is about two objects.
    """
    form = form.mapped(_with_use).mapped(_with_tool)
    rest = _simplified(_resolve_rules(form, discourse))
    if not any(part == IT for part in rest):
        return rest
    if discourse.object is None:
        raise RefusedError("no_referent", asks=True, word=IT.name)
    return _simplified(_replace_it(rest, discourse.object))


def _with_use(form: Form) -> Form | None:
    """`thatIs(x, implies(x, cutting, high))`, a relative clause, as `usedFor(x, cutting)`."""
    if form.name != "thatIs":
        return None
    thing, clause = form.arguments
    if clause.name != "implies" or clause.arguments[1].name in {"graspObject", *_OF_USE}:
        raise RefusedError("one_thing_at_a_time")
    _, use, degree = clause.arguments
    return Form("notUsedFor" if degree.name == "none" else "usedFor", (thing, use))


def _with_tool(form: Form) -> Form | None:
    """`use(self, hammer, pound(self, nail))` as `pound(self, nail, hammer)`."""
    if form.name != "use" or len(form.arguments) != 3:
        return None
    _, tool, act = form.arguments
    if not _is_tool_act(act) or len(act.arguments) != 2:
        raise RefusedError("one_thing_at_a_time")
    return Form(act.name, (*act.arguments, tool))


def _resolve_rules(form: Form, discourse: Discourse) -> Form:
    match form.name, form.arguments:
        case "and", (one, other):
            # The second rule may speak of the first one's object.
            first = _resolve_rules(one, discourse)
            known = _object_of_rule(first) or discourse.object
            return Form("and", (first, _resolve_rules(other, Discourse(known))))
        case "implies", _:
            return _resolve_rule(form, discourse)
        case "within", (occasion, rule):
            form = _on_occasion(occasion, rule)
        case "holding", (Form(arguments=(_, held, *_)) as act, place):
            return Form("holding", (act, _replace_it(place, held)))
        case "how", (act, held):
            return Form("how", (_replace_it(act, held),))
        case "first", (thing, act):
            # "Take the mug and pass it to me": the second act must be on the first one's object.
            if IT not in act:
                raise RefusedError("one_thing_at_a_time")
            form = _replace_it(act, thing)
        case _:
            arguments = (_resolve_rules(part, discourse) for part in form.arguments)
            return Form(form.name, tuple(arguments))
    return _resolve_rules(form, discourse)


def _on_occasion(occasion: Form, rule: Form) -> Form:
    """A rule stated with its occasion: "if I want a mug, pass it by the rim"."""
    if rule.name == "and":
        return Form("and", tuple(_on_occasion(occasion, each) for each in rule.arguments))
    if rule.name != "implies":
        raise RefusedError("not_a_rule")
    context, act, degree = rule.arguments
    if context.name != occasion.name or len(occasion.arguments) < 2:
        raise RefusedError("one_thing_at_a_time")
    return _replace_it(Form("implies", (context, act, degree)), occasion.arguments[1])


def _resolve_rule(form: Form, discourse: Discourse) -> Form:
    alternatives = _alternatives(form)
    if alternatives:
        return _resolve_rules(Form("and", alternatives), discourse)
    if form.arguments[1].name == "graspObject":
        return _resolve_action_rule(form, discourse)
    return _replace_it(form, discourse.object) if discourse.object else form


def _alternatives(form: Form) -> tuple[Form, ...]:
    """The rules that one `implies` over two objects, uses or acts expands to; empty for one."""
    for place, argument in enumerate(form.arguments):
        if argument.name in {"both", "eitherOf", "butNot"}:
            before, after = form.arguments[:place], form.arguments[place + 1 :]
            rules = [Form("implies", (*before, each, *after)) for each in argument.arguments]
            if argument.name == "butNot":
                rules[1] = Form("implies", (*rules[1].arguments[:-1], Form("none")))
            return tuple(rules)
    return ()


def _replace_it(form: Form, known: Form) -> Form:
    return form.mapped(lambda part: known if part == IT else None)


def _resolve_action_rule(form: Form, discourse: Discourse) -> Form:
    """`implies(context, graspObject(self, partOf(part, object)), degree)` about one object."""
    context, act, degree = form.arguments
    actor, place = act.arguments
    part, owners = _part(place)
    candidates = [_grasped_object(context, owners), *owners]
    known = _most_specific(candidates) or discourse.object
    if known is None:
        raise RefusedError("of_which_object", asks=True)
    act = Form("graspObject", (actor, Form("partOf", (part, known))))
    return Form("implies", (_with_object(context, known), act, degree))


def _part(place: Form) -> tuple[Form, list[Form]]:
    """The innermost part, and all objects that it is called a part of."""
    owners: list[Form] = []
    while place.name == "partOf":
        place, owner = place.arguments
        owners.append(owner)
    return place, owners


def _simplified(form: Form) -> Form:
    """The form with nested parts of one object flattened, and uses "on something" as plain uses."""

    def change(part: Form) -> Form | None:
        if part.name == "of" and part.arguments[1].name in SOMETHING:
            return part.arguments[0]
        if part.name != "partOf" or part.arguments[0].name != "partOf":
            return None
        innermost, owners = _part(part)
        known = _most_specific(owners)
        return Form("partOf", (innermost, known)) if known is not None else None

    return form.mapped(change)


def _grasped_object(context: Form, owners: list[Form]) -> Form:
    """The object grasped in a context: the tool, where there is one."""
    arguments = context.arguments
    if len(arguments) == 3 and context.name != "pass":
        return arguments[2]
    if len(arguments) < 2:
        raise RefusedError("no_act")
    held = arguments[1]
    if _is_tool_act(context) and owners and _most_specific(owners) not in {None, held}:
        return IT
    return held


def _is_tool_act(context: Form) -> bool:
    return context.name not in {"pass", "pickUp", "pointTo", "grasp", "use"}


def _with_object(context: Form, known: Form) -> Form:
    arguments = tuple(known if argument == IT else argument for argument in context.arguments)
    if len(arguments) == 3 and context.name != "pass":
        return Form(context.name, (*arguments[:2], known))
    if _is_tool_act(context) and _noun(arguments[1]) != _noun(known):
        return Form(context.name, (*arguments, known))
    return Form(context.name, (arguments[0], known, *arguments[2:]))


def _most_specific(candidates: list[Form]) -> Form | None:
    """The most specific of the candidates, which must be one object; None when all are "it"."""
    known: Form | None = None
    for candidate in candidates:
        if candidate == IT:
            continue
        if known is not None:
            first, second = _noun(known).name, _noun(candidate).name
            if _noun(known) != _noun(candidate) and not SOMETHING & {first, second}:
                raise RefusedError("two_objects", first=first, second=second)
        if known is None or len(list(candidate)) >= len(list(known)):
            known = candidate
    return known


def _noun(form: Form) -> Form:
    while form.name in {"having", "usedFor", "notUsedFor"}:
        form = form.arguments[0]
    return form


def _object_of_rule(form: Form) -> Form | None:
    if form.name == "and":
        return _object_of_rule(form.arguments[-1])
    if form.name != "implies":
        return None
    if form.arguments[1].name == "graspObject":
        return form.arguments[1].arguments[1].arguments[1]
    return form.arguments[0]


def update_discourse(meaning: Meaning, content: Form, discourse: Discourse) -> Discourse:
    """Return the discourse state after an utterance with a meaning and a predicate form."""
    if isinstance(meaning, (AskBack, Misunderstanding)):
        return discourse
    mentioned = _mentioned_object(content)
    if mentioned is not None:
        discourse = replace(discourse, object=mentioned)
    if isinstance(meaning, Statement):
        discourse = replace(discourse, rule=meaning.rules[-1])
    return discourse


def _mentioned_object(form: Form) -> Form | None:
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
