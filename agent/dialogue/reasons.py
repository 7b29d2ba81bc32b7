# SPDX-License-Identifier: Apache-2.0
"""Why this, and why not that: the last choice, or what was last spoken of, and what it rests on."""

from __future__ import annotations

from collections.abc import Sequence

from ...inference.explanation import candidate_names, rejection_reason
from ...inference.types import Inference
from ...kb.rule import Rule
from ...nlu.semantics.meaning import Command, Question, ToolCommand
from ..execution.outcome import Decision
from .knowledge import Answered, Knowledge, say
from .reply import Reply


def why(question: Question, known: Knowledge) -> Answered:
    """The sentences that a choice rests on, or the rules that were last spoken of."""
    rules = _reasons(question, known)
    if rules:
        return _because(rules, known)
    if known.last is None:
        return say("nothing_done"), ()
    wrong = _not_so(question, known.decision)
    if wrong:
        return say(wrong, object=question.object, part=question.part), ()
    if question.object or question.part or (known.decision and known.decision.object.best):
        # What the command itself names needs no rule.
        last = known.last
        return say("because_told", done=True, speakers=(last.speaker,), texts=(last.text,)), ()
    reason = _reason(known.decision, None)
    return (say("because", done=True, reason=reason) if reason else say("not_known")), ()


def why_not(question: Question, known: Knowledge) -> Answered:
    """What speaks against another thing, or another part."""
    if known.last is None:
        return say("nothing_done"), ()
    if question.part and not question.object:
        return _why_not_part(question.part, known)
    return _why_not_thing(question.object or "thing", known.last, known)


def _why_not_thing(name: str, last: Reply, known: Knowledge) -> Answered:
    best = known.decision and known.decision.object.best
    denials = _denials(known.decision and known.decision.object, name)
    reason, wanted = _reason(known.decision, name), _wanted_use(last)
    if best and best.object == name:
        said = say("is_so", done=True, object=name)
    elif denials:
        return say("why_not_said", done=True, object=name, **_sources(denials, known)), denials
    elif reason:
        said = say("why_not", done=True, object=name, reason=reason)
    elif name not in known.visible():
        said = say("why_not_seen", done=True, object=name)
    elif wanted and not known.base.rules(object=name, affordance=wanted):
        said = say("why_not_told", done=True, object=name, affordance=wanted)
    else:
        said = say("why_not_asked", done=True, object=name)
    return said, ()


def _why_not_part(part: str, known: Knowledge) -> Answered:
    decision = known.decision
    if decision is not None and decision.chosen_part == part:
        return say("is_so_part", done=True, part=part), ()
    chosen = tuple(rule for rule in decision.rules if rule.part) if decision else ()
    rules = _denials(decision and decision.part, part) or chosen
    if rules:
        return say("why_not_part", done=True, part=part, **_sources(rules, known)), rules
    return say("why_not_part_told", done=True, part=part), ()


def _denials(made: Inference | None, name: str) -> tuple[Rule, ...]:
    """The rules that say of a thing, or of a part, that it is not to be taken."""
    denied = (each for each in (made.denied if made else ()) if name in candidate_names(each))
    return tuple(rule for each in denied for rule in each.rules if not rule.asserts)


def _sources(rules: Sequence[Rule], known: Knowledge) -> dict[str, tuple[str, ...]]:
    """Who told rules, and in which words, each once."""
    texts = tuple(dict.fromkeys(_words(rule, known) for rule in rules))
    return {"speakers": tuple(dict.fromkeys(rule.speaker for rule in rules)), "texts": texts}


def _reasons(question: Question, known: Knowledge) -> Sequence[Rule]:
    """The rules that are the reason of what is asked for."""
    decision = known.decision
    if not question.object and not question.part:
        return [rule for rule in known.topic if rule.utterance]
    if decision is None or _not_so(question, decision):
        return ()
    rules = [rule for rule in decision.rules if rule.utterance]
    if question.part:
        return [rule for rule in rules if rule.part == question.part]
    return rules if any(rule.part is None for rule in rules) else ()


def _because(rules: Sequence[Rule], known: Knowledge) -> Answered:
    if rules[-1].status == "induced":
        return say("because_alike", done=True, texts=_words(rules[-1], known)), tuple(rules)
    return say("because_told", done=True, **_sources(rules, known)), tuple(rules)


def _words(rule: Rule, known: Knowledge) -> str:
    """The sentence that taught a rule; what came from a file was not said in words."""
    utterance = known.base.utterance(rule.utterance or 0)
    return known.describe(rule) if utterance.kind == "import" else utterance.text


def _not_so(question: Question, decision: Decision | None) -> str:
    """The answer to a question about what was not chosen; empty where it was."""
    if decision is None:
        return ""
    best = decision.object.best
    if question.object and best and question.object != best.object:
        return "is_not_so"
    if question.part and question.part != decision.chosen_part:
        return "is_not_so_part"
    return ""


def _reason(decision: Decision | None, name: str | None) -> str | None:
    """Why a thing was or was not taken; None when it was not looked for."""
    if decision is None:
        return None
    tried = next((each for each in decision.rejected if each.candidate.object == name), None)
    if tried:
        return tried.reason
    found = next((each for each in decision.object.candidates if name in {None, each.object}), None)
    return rejection_reason(decision.object, found) if found else None


def _wanted_use(last: Reply) -> str | None:
    """What the thing of the last command was to be used for."""
    said = last.understanding.meaning
    if isinstance(said, ToolCommand):
        return said.tool.used_for
    return said.target.used_for if isinstance(said, Command) else None
