# SPDX-License-Identifier: Apache-2.0
"""From a predicate form to the question that it asks."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from .coreference import SOMETHING, RefusedError
from .interpretation import Interpreter, name_of, object_of
from .meaning import ActionRule, FunctionalRule, Question
from .predicates import Form


def question(form: Form, interpreter: Interpreter) -> Question:
    """The question that a form asks.

    Raises:
        RefusedError: it asks nothing that Hilt can answer.
    """
    if form.name not in _READERS:
        raise RefusedError("unanswerable")
    return _READERS[form.name](form.arguments, interpreter)


_Arguments = tuple[Form, ...]


def _uses_of(arguments: _Arguments, _: Interpreter) -> Question:
    return Question("uses_of", object=_object(arguments[0]))


def _which(arguments: _Arguments, interpreter: Interpreter) -> Question:
    form = arguments[0]
    if form.name not in {"usedFor", "implies"} or form.arguments[1].name == "graspObject":
        raise RefusedError("unanswerable")
    if form.arguments[0].name not in SOMETHING:
        raise RefusedError("unanswerable")
    return Question("objects_for", affordance=interpreter.affordance(form.arguments[1]))


def _best(arguments: _Arguments, interpreter: Interpreter) -> Question:
    return Question("best_for", affordance=interpreter.affordance(arguments[0]))


def _how(arguments: _Arguments, interpreter: Interpreter) -> Question:
    act = arguments[0]
    if act.name == "implies":
        act = act.arguments[0]
    return _about_act("how", act, interpreter)


def _is_true(arguments: _Arguments, interpreter: Interpreter) -> Question:
    return _about_rule("is_used_for", arguments[0], interpreter)


def _why(arguments: _Arguments, interpreter: Interpreter) -> Question:
    return _reason("why", arguments, interpreter)


def _why_not(arguments: _Arguments, interpreter: Interpreter) -> Question:
    return _reason("why_not", arguments, interpreter)


def _why_part(arguments: _Arguments, _: Interpreter) -> Question:
    return Question("why", part=_part(arguments[0]))


def _why_not_part(arguments: _Arguments, _: Interpreter) -> Question:
    return Question("why_not", part=_part(arguments[0]))


def _about(arguments: _Arguments, interpreter: Interpreter) -> Question:
    return Question("about", object=_object(arguments[0]))


def _about_use(arguments: _Arguments, interpreter: Interpreter) -> Question:
    return Question("about", affordance=interpreter.affordance(arguments[0]))


def _what_if(arguments: _Arguments, interpreter: Interpreter) -> Question:
    return Question("what_if", affordance=interpreter.affordance(arguments[0]))


def _which_context(arguments: _Arguments, interpreter: Interpreter) -> Question:
    act, part = arguments
    asked = _about_act("which_context", act, interpreter)
    # "Held by the blade" asks for any context, "passed by the blade" whether passing explains it.
    return replace(asked, context=None if act.name == "grasp" else act.name, part=_part(part))


def _how_sure(arguments: _Arguments, interpreter: Interpreter) -> Question:
    if not arguments:
        return Question("confidence")
    return _about_rule("confidence", arguments[0], interpreter)


def _source(arguments: _Arguments, interpreter: Interpreter) -> Question:
    if not arguments:
        return Question("source")
    if arguments[0].name in {"implies", "and"}:
        return _about_rule("source", arguments[0], interpreter)
    return Question("source", object=_object(arguments[0]))


def _see(arguments: _Arguments, interpreter: Interpreter) -> Question:
    if not arguments:
        return Question("see")
    target = interpreter.target(arguments[0])
    return Question("see", object=target.object, affordance=target.used_for)


def _trust(arguments: _Arguments, _: Interpreter) -> Question:
    return Question("trust", speaker=name_of(arguments[0]) if arguments else None)


def _capabilities(_: _Arguments, __: Interpreter) -> Question:
    return Question("capabilities")


_READERS: dict[str, Callable[[_Arguments, Interpreter], Question]] = {
    "usesOf": _uses_of,
    "which": _which,
    "best": _best,
    "how": _how,
    "isTrue": _is_true,
    "why": _why,
    "whyNot": _why_not,
    "whyPart": _why_part,
    "whyNotPart": _why_not_part,
    "whatIf": _what_if,
    "whichContext": _which_context,
    "about": _about,
    "aboutUse": _about_use,
    "howSure": _how_sure,
    "source": _source,
    "see": _see,
    "trust": _trust,
    "capabilities": _capabilities,
}


def _object(form: Form) -> str:
    name, props = object_of(form)
    if props or name == "*":
        raise RefusedError("one_thing_at_a_time")
    return name


def _part(form: Form) -> str:
    return name_of(form.arguments[0] if form.name == "partOf" else form)


def _about_rule(ask: str, form: Form, interpreter: Interpreter) -> Question:
    rules = list(interpreter.rules(form))
    if len(rules) != 1:
        raise RefusedError("one_thing_at_a_time")
    rule = rules[0]
    if isinstance(rule, FunctionalRule):
        return Question(ask, object=rule.object, affordance=rule.affordance)
    return _about_action(ask, rule)


def _about_action(ask: str, rule: ActionRule) -> Question:
    # "Is a knife passed by the blade?" is answered as "How is a knife passed?" is.
    asked = "how" if ask == "is_used_for" else ask
    return Question(asked, object=rule.object, context=rule.context, part=rule.part)


def _about_act(ask: str, act: Form, interpreter: Interpreter) -> Question:
    part = None
    if act.name == "holding":
        act, place = act.arguments
        part = _part(place)
    if act.name == "graspObject":
        place = act.arguments[1]
        return Question(ask, object=_object(place.arguments[1]), part=_part(place))
    if act.name in interpreter.tool_acts:
        # The last argument is the tool, or what it is used on where no tool is named.
        return Question(ask, object=_object(act.arguments[-1]), context=act.name, part=part)
    target = interpreter.target(act.arguments[1])
    return Question(
        ask, object=target.object, affordance=target.used_for, context=act.name, part=part
    )


def _reason(ask: str, arguments: _Arguments, interpreter: Interpreter) -> Question:
    if not arguments:
        return Question(ask)
    form = arguments[0]
    if form.name == "implies":
        return _about_rule(ask, form, interpreter)
    acts = {"holding", "graspObject", "pass", "pickUp", "pointTo", "use"}
    if form.name == "grasp":
        # "Why did you take the knife?" asks for the choice, not for the hold.
        return Question(ask, object=_object(form.arguments[1]))
    if form.name in acts or form.name in interpreter.tool_acts:
        return _about_act(ask, form, interpreter)
    return Question(ask, object=_object(form))
