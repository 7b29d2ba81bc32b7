# SPDX-License-Identifier: Apache-2.0
"""Between what language means and what the knowledge base and inference take.

`nlu` knows no rules and `kb` no sentences; the two meet here and nowhere else.
"""

from __future__ import annotations

from ..inference.goal import Target
from ..kb.interval import Interval
from ..kb.rule import Rule, functional, grasping
from ..nlu import meaning
from .goals import Argument, Request


def rule_of(said: meaning.Rule, speaker: str, heard: float = 1.0) -> Rule:
    """The rule that a statement asserts, as far as it was heard.

    Args:
        said: what was meant.
        speaker: who said it.
        heard: how surely a recogniser heard it, in [0, 1].
    """
    interval = Interval(*said.confidence).discounted(heard)
    if isinstance(said, meaning.FunctionalRule):
        return functional(
            said.object, said.affordance, interval=interval, properties=said.props, speaker=speaker
        )
    return grasping(
        said.object,
        said.part,
        said.context,
        interval=interval,
        properties=said.props,
        speaker=speaker,
    )


def said_of(rule: Rule) -> meaning.Rule | None:
    """What a speaker would mean by a rule; None where no sentence can say it."""
    confidence = (rule.interval.lower, rule.interval.upper)
    props = tuple(sorted(atom.name for atom in rule.features if atom.kind == "property"))
    name = rule.object or meaning.ANY_OBJECT
    if rule.affordance:
        return meaning.FunctionalRule(name, rule.affordance, confidence, props)
    if rule.part and rule.context:
        return meaning.ActionRule(name, rule.context, rule.part, confidence, props)
    return None


def request_of(command: meaning.Command | meaning.ToolCommand, speaker: str) -> Request:
    """The goal that a command asks for."""
    if isinstance(command, meaning.ToolCommand):
        arguments: dict[str, Argument] = {"patient": command.patient, "tool": _target(command.tool)}
        return Request(command.goal, arguments, speaker)
    arguments = {"object": _target(command.target)}
    if command.recipient:
        arguments["recipient"] = command.recipient
    return Request(command.goal, arguments, speaker, part=command.part)


def _target(said: meaning.Target) -> Target:
    name = None if said.object == meaning.ANY_OBJECT else said.object
    return Target(name, said.used_for, said.not_used_for, frozenset(said.props))
