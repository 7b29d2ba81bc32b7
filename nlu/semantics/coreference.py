# SPDX-License-Identifier: Apache-2.0
"""What "it" stands for, in the sentence and in the conversation before it.

Within a rule, "it" in one half is the object of the other half: "to pass a knife grab it by the
blade". Elsewhere it is what was last spoken of. Two different objects in one rule are no rule.
"""

from __future__ import annotations

from dataclasses import dataclass

from .meaning import Rule
from .predicates import Form

IT = Form("it")
SOMETHING = frozenset({"something", "anything"})


@dataclass(frozen=True)
class Discourse:
    """What a conversation has spoken of so far.

    Attributes:
        object: the last object, as a form; None before the first.
        rule: the last rule that was taught or corrected; None before the first.
    """

    object: Form | None = None
    rule: Rule | None = None


class RefusedError(ValueError):
    """A form that has no meaning for Hilt.

    Attributes:
        key: the answer to give, a key of the spoken answers.
        asks: whether that answer is a question back.
        slots: what fills the answer.
    """

    def __init__(self, key: str, *, asks: bool = False, **slots: str) -> None:
        self.key, self.asks, self.slots = key, asks, slots
        super().__init__(key)


def resolved(form: Form, discourse: Discourse) -> Form:
    """The form with every "it" replaced by what it stands for.

    Raises:
        RefusedError: nothing fits, or one rule is about two objects.
    """
    rest = _settled(_in_rules(form.mapped(_with_tool), discourse))
    if not any(part == IT for part in rest):
        return rest
    if discourse.object is None:
        raise RefusedError("no_referent", asks=True, word=IT.name)
    return _settled(_replaced(rest, discourse.object))


def _with_tool(form: Form) -> Form | None:
    """`use(self, hammer, pound(self, nail))` as `pound(self, nail, hammer)`."""
    if form.name != "use" or len(form.arguments) != 3:
        return None
    _, tool, act = form.arguments
    if not _is_tool_act(act) or len(act.arguments) != 2:
        raise RefusedError("one_thing_at_a_time")
    return Form(act.name, (*act.arguments, tool))


def _in_rules(form: Form, discourse: Discourse) -> Form:
    match form.name, form.arguments:
        case "and", (one, other):
            # The second rule may speak of the first one's object.
            first = _in_rules(one, discourse)
            known = _object_of_rule(first) or discourse.object
            return Form("and", (first, _in_rules(other, Discourse(known))))
        case "implies", _:
            return _in_rule(form, discourse)
        case "within", (occasion, rule):
            return _in_rules(_on_occasion(occasion, rule), discourse)
        case "holding", (Form(arguments=(_, held, *_)) as act, place):
            return Form("holding", (act, _replaced(place, held)))
        case "first", (thing, act):
            return _in_rules(_with_thing(thing, act), discourse)
        case _:
            return _below(form, discourse)


def _below(form: Form, discourse: Discourse) -> Form:
    if form.name == "how" and len(form.arguments) == 2:
        act, held = form.arguments
        return Form("how", (_replaced(act, held),))
    return Form(form.name, tuple(_in_rules(part, discourse) for part in form.arguments))


def _with_thing(thing: Form, act: Form) -> Form:
    """An act on a thing that is taken first: "take the mug and pass it to me"."""
    if IT not in act:
        raise RefusedError("one_thing_at_a_time")
    return _replaced(act, thing)


def _on_occasion(occasion: Form, rule: Form) -> Form:
    """A rule that is said with its occasion: "if I want a mug, pass it by the rim"."""
    if rule.name == "and":
        return Form("and", tuple(_on_occasion(occasion, each) for each in rule.arguments))
    if rule.name != "implies":
        raise RefusedError("not_a_rule")
    context, act, degree = rule.arguments
    if context.name != occasion.name or len(occasion.arguments) < 2:
        raise RefusedError("one_thing_at_a_time")
    return _replaced(Form("implies", (context, act, degree)), occasion.arguments[1])


def _in_rule(form: Form, discourse: Discourse) -> Form:
    alternatives = _alternatives(form)
    if alternatives:
        return _in_rules(Form("and", alternatives), discourse)
    if form.arguments[1].name == "graspObject":
        return _rule(form, discourse)
    return _replaced(form, discourse.object) if discourse.object else form


def _alternatives(form: Form) -> tuple[Form, ...]:
    """The rules that one `implies` over two things, uses or acts stands for; none for one."""
    for place, argument in enumerate(form.arguments):
        if argument.name in {"both", "eitherOf"}:
            before, after = form.arguments[:place], form.arguments[place + 1 :]
            return tuple(Form("implies", (*before, each, *after)) for each in argument.arguments)
        if argument.name == "butNot":
            before, after = form.arguments[:place], form.arguments[place + 1 : -1]
            degrees = (form.arguments[-1], Form("none", ()))
            pairs = zip(argument.arguments, degrees, strict=True)
            return tuple(Form("implies", (*before, each, *after, degree)) for each, degree in pairs)
    return ()


def _replaced(form: Form, known: Form) -> Form:
    return form.mapped(lambda part: known if part == IT else None)


def _rule(form: Form, discourse: Discourse) -> Form:
    """`implies(context, graspObject(self, partOf(part, object)), degree)`, about one object."""
    context, act, degree = form.arguments
    actor, place = act.arguments
    part, owners = _part(place)
    candidates = [_object(context, owners), *owners]
    known = _one(candidates) or discourse.object
    if known is None:
        raise RefusedError("of_which_object", asks=True)
    act = Form("graspObject", (actor, Form("partOf", (part, known))))
    return Form("implies", (_with_object(context, known), act, degree))


def _part(place: Form) -> tuple[Form, list[Form]]:
    """The part, and all objects that it is said to be a part of."""
    owners: list[Form] = []
    while place.name == "partOf":
        place, owner = place.arguments
        owners.append(owner)
    return place, owners


def _settled(form: Form) -> Form:
    """Parts of parts of one object as parts of that object, and uses on something as uses."""

    def change(part: Form) -> Form | None:
        if part.name == "of" and part.arguments[1].name in SOMETHING:
            return part.arguments[0]
        if part.name != "partOf" or part.arguments[0].name != "partOf":
            return None
        innermost, owners = _part(part)
        known = _one(owners)
        return Form("partOf", (innermost, known)) if known is not None else None

    return form.mapped(change)


def _object(context: Form, owners: list[Form]) -> Form:
    """The object that is held in a context: the tool, where there is one."""
    arguments = context.arguments
    if len(arguments) == 3 and context.name != "pass":
        return arguments[2]
    if len(arguments) < 2:
        raise RefusedError("no_act")
    held = arguments[1]
    if _is_tool_act(context) and owners and _one(owners) not in {None, held}:
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


def _one(candidates: list[Form]) -> Form | None:
    """The one object that all candidates are, the most specific; None when all are "it"."""
    known: Form | None = None
    for candidate in candidates:
        if candidate == IT:
            continue
        if known is None or _noun(known).name in SOMETHING:
            known = _more_specific(candidate, known)
        elif _noun(candidate).name not in SOMETHING and _noun(candidate) != _noun(known):
            first, second = _noun(known).name, _noun(candidate).name
            raise RefusedError("two_objects", first=first, second=second)
        else:
            known = _more_specific(candidate, known)
    return known


def _more_specific(one: Form, other: Form | None) -> Form:
    return one if other is None or sum(1 for _ in one) >= sum(1 for _ in other) else other


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
