# SPDX-License-Identifier: Apache-2.0
"""Questions answered from the graph, each with the interval and the source it rests on."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

from ...inference.abduction import Hypothesis, find_hypotheses
from ...inference.affordance import FIND, Affordances
from ...inference.evidence import relative_plausibility
from ...inference.taxonomy import Taxonomy
from ...inference.types import Conclusion, Goal, Observation, Target
from ...kb.interval import CERTAIN
from ...kb.rule import GRASP_OBJECT, USED_FOR, Atom, Rule
from ...nlu.semantics.meaning import Question
from ..execution.outcome import SpokenAnswer
from .knowledge import Answered, Knowledge, say
from .reasons import why, why_not


def answer(question: Question, known: Knowledge) -> Answered:
    """The answer to a question, and the rules that it rests on."""
    return _ANSWERS[question.ask](question, known)


def _uses_of(question: Question, known: Knowledge) -> Answered:
    strongest = _strongest(known.base.rules(object=question.object), "affordance")
    rules = [rule for rule in strongest if rule.asserts]
    if not rules:
        return say("no_uses_of", object=question.object), ()
    uses = tuple(known.weigh(rule.affordance or "", rule) for rule in rules)
    return say("uses_of", done=True, object=question.object, uses=uses), tuple(rules)


def _objects_for(question: Question, known: Knowledge) -> Answered:
    rules = [r for r in _functional(question, known) if r.asserts]
    if not rules:
        return say("nothing_known_for", affordance=question.affordance), ()
    best = {rule.object or "thing": rule for rule in reversed(rules)}  # of each the surest
    names = tuple(known.weigh(name, best[name]) for name in reversed(best))
    slots = {"objects": names, "affordance": question.affordance}
    return say("objects_for", done=True, **slots), tuple(rules)


def _best_for(question: Question, known: Knowledge) -> Answered:
    rules = _functional(question, known)
    goal = Goal("find", Target(used_for=question.affordance))
    names = dict.fromkeys(rule.object for rule in rules if rule.object)
    seen = [Observation(name, name, {Atom("object", name): CERTAIN}) for name in names]
    best = Affordances(known.base).infer(FIND, goal, seen).best
    if best is None:
        return say("nothing_known_for", affordance=question.affordance), ()
    interval = (best.interval.lower, best.interval.upper)
    speakers = tuple(dict.fromkeys(rule.speaker for rule in best.rules))
    found = {"object": best.object, "affordance": question.affordance}
    return say("best_for", done=True, confidence=interval, speakers=speakers, **found), best.rules


def _how(question: Question, known: Knowledge) -> Answered:
    rules = known.base.rules(object=question.object, context=question.context)
    grasps = _strongest((rule for rule in rules if rule.part), "part")
    if not grasps:
        return say("no_how", goal=question.context or "grasp", object=question.object), ()
    return _told("how", grasps[0], known), (grasps[0],)


def _is_used_for(question: Question, known: Knowledge) -> Answered:
    rules = [r for r in _functional(question, known) if r.object == question.object]
    if not rules:
        slots = {"object": question.object, "affordance": question.affordance}
        return say("is_not_used_for", done=True, **slots), ()
    key = "is_used_for" if rules[0].asserts else "is_denied"
    return _told(key, rules[0], known), (rules[0],)


def _about(question: Question, known: Knowledge) -> Answered:
    rules = known.base.rules(object=question.object)
    if not rules:
        return say("nothing_about", object=question.object), ()
    said = tuple(known.weigh(known.describe(rule), rule) for rule in rules)
    return say("about", done=True, object=question.object, rules=said), tuple(rules)


def _confidence(question: Question, known: Knowledge) -> Answered:
    rules = _meant(question, known)
    if not rules:
        return say("not_known"), ()
    interval = rules[0].support
    slots = {"rule": known.describe(rules[0]), "confidence": (interval.lower, interval.upper)}
    return say("confidence", done=True, **slots), (rules[0],)


def _source(question: Question, known: Knowledge) -> Answered:
    rules = _meant(question, known)
    if not rules or rules[0].utterance is None:
        return say("no_source"), ()
    text = known.base.utterance(rules[0].utterance).text
    return say("source", done=True, speaker=rules[0].speaker, texts=text), (rules[0],)


def _what_if(question: Question, known: Knowledge) -> Answered:
    """Abduction: of which things would it follow that they are used for something?"""
    argument = Atom("affordance", question.affordance or "")
    found = find_hypotheses(known.base.rules(), Conclusion(USED_FOR, argument))
    if not found:
        return say("nothing_known_for", affordance=question.affordance), ()
    things = tuple(dict.fromkeys(_thing(each) for each in found))
    key = "what_if_one" if len(things) == 1 else "what_if"
    said = say(key, done=True, affordance=question.affordance, things=things)
    return said, tuple(rule for each in found for rule in each.rules)


def _thing(hypothesis: Hypothesis) -> str:
    """What a thing would have to be: "sharp knife", "red thing with a handle"."""
    named: dict[str, list[str]] = {"object": [], "property": [], "part": []}
    for atom in sorted(hypothesis.features | hypothesis.contexts):
        named.setdefault(atom.kind, []).append(atom.name)
    parts = "".join(f" with a {part}" for part in named["part"])
    places = "".join(f" in a {place}" for place in named.get("place", ()))
    return " ".join([*named["property"], *(named["object"] or ["thing"])]) + parts + places


def _which_context(question: Question, known: Knowledge) -> Answered:
    """Abduction: which context explains that a thing is held by a part?"""
    given = frozenset({Atom("object", question.object or "")})
    wanted = Conclusion(GRASP_OBJECT, Atom("part", question.part or ""))
    kinds = Taxonomy.from_base(known.base)
    found = find_hypotheses(known.base.rules(), wanted, given=given, taxonomy=kinds)
    asked = {question.context, None}
    fitting = [h for h in found if question.context is None or asked & {r.context for r in h.rules}]
    rules = tuple(rule for each in fitting for rule in each.rules)
    if not rules:
        return say("not_explained", object=question.object, part=question.part), ()
    said = tuple(dict.fromkeys(known.describe(rule) for rule in rules))
    return say("explained", done=True, rules=said), rules


def _see(question: Question, known: Knowledge) -> Answered:
    names = known.visible()
    if question.object:
        seen = question.object in names
        return say("see_one" if seen else "nothing_seen", done=True, object=question.object), ()
    return (say("see", done=True, objects=names) if names else say("see_nothing")), ()


def _trust(question: Question, known: Knowledge) -> Answered:
    if question.speaker is None:
        return say("trusts_whom", done=True, speakers=tuple(known.base.speakers())), ()
    trust = known.base.trust(known.base.match_speaker(question.speaker))
    key = "trusts" if trust is not None and trust.upper > 0 else "trusts_not"
    return say(key, done=True, speaker=question.speaker), ()


def _capabilities(_: Question, __: Knowledge) -> Answered:
    return say("capabilities", done=True), ()


# --- Helpers -------------------------------------------------------------------------------


def _told(key: str, rule: Rule, known: Knowledge) -> SpokenAnswer:
    interval = (rule.support.lower, rule.support.upper)
    said = known.describe(rule)
    return say(key, done=True, rule=said, confidence=interval, speaker=rule.speaker)


def _functional(question: Question, known: Knowledge) -> list[Rule]:
    return _by_strength(known.base.rules(affordance=question.affordance))


def _meant(question: Question, known: Knowledge) -> list[Rule]:
    """The rules a question is about: those it names, else those last spoken of."""
    named = (question.object, question.affordance, question.context)
    if not any(named):
        return list(known.topic) or _latest(known)
    rules = known.base.rules(
        object=question.object, affordance=question.affordance, context=question.context
    )
    return _by_strength(rule for rule in rules if question.part in {None, rule.part})


def _latest(known: Knowledge) -> list[Rule]:
    return sorted(known.base.rules(), key=lambda rule: -(rule.utterance or 0))[:1]


def _by_strength(rules: Iterable[Rule]) -> list[Rule]:
    return sorted(rules, key=lambda rule: -relative_plausibility(rule.support))


def _strongest(rules: Iterable[Rule], argument: str) -> list[Rule]:
    """Of rules with the same conclusion the strongest, best first."""
    best: dict[str, Rule] = {}
    for rule in _by_strength(rules):
        concluded = getattr(rule, argument)
        if concluded:
            best.setdefault(concluded, rule)
    return list(best.values())


_ANSWERS: Mapping[str, Callable[[Question, Knowledge], Answered]] = {
    "about": _about,
    "best_for": _best_for,
    "capabilities": _capabilities,
    "confidence": _confidence,
    "how": _how,
    "is_used_for": _is_used_for,
    "objects_for": _objects_for,
    "see": _see,
    "source": _source,
    "trust": _trust,
    "uses_of": _uses_of,
    "what_if": _what_if,
    "which_context": _which_context,
    "why": why,
    "why_not": why_not,
}
