# SPDX-License-Identifier: Apache-2.0
"""Affordance inference at the nodes of an action tree: getFeatures and getAffordance.

Paper, section 3.3. `Affordances.features` selects the rules of a node and returns the perceptual
invariants that vision has to look for; `Affordances.infer` takes what was seen and concludes, for
each thing, what it affords: AND over the antecedents, modus ponens with the rule's interval, fusion
of equal conclusions, lambda against the threshold of the context (section 2).

Rules that share their antecedent are fused before modus ponens: the antecedent is one piece of
evidence and would otherwise be counted once a rule. With perfect detection both stages agree.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import Protocol

from ..kb.interval import CERTAIN, VACUOUS, Interval
from ..kb.rule import Atom, Rule
from ..ontology.errors import UnknownNameError
from .evidence import EPSILON, Operators, certainty, is_affirmed, is_denied, negation
from .goal import Candidate, Goal, Inference, Observation

FIND = "findObject"  # the action whose rules are functional: usedFor(object, affordance)
STAGES = ("rules", "conclusions")


class RuleSource(Protocol):
    """Where rules come from: a knowledge base, or anything else that keeps them by node."""

    @property
    def sequence(self) -> int:
        """The number of the last change; equal numbers mean equal rules."""
        ...

    def rules_of(self, nodes: Sequence[str]) -> Sequence[Rule]:
        """The active rules that hang on any of these nodes."""
        ...


@dataclass(frozen=True)
class Settings:
    """The choices of the theory.

    Attributes:
        operators: AND, modus ponens, fusion and ranking, by name.
        stage: fuse "rules" that share an antecedent, then conclude (default); or conclude from each
            rule and fuse the "conclusions", the letter of the paper.
        threshold: Λ, what lambda must exceed to act, in [0, 1]. The paper gives no number; .005
            keeps "occasionally" feasible down to a detection confidence of .62.
        thresholds: Λ of single contexts (action names), before the general one.
    """

    operators: Operators = field(default_factory=Operators)
    stage: str = "rules"
    threshold: float = 0.005
    thresholds: Mapping[str, float] = field(default_factory=dict[str, float])

    def __post_init__(self) -> None:
        if self.stage not in STAGES:
            raise UnknownNameError("fusion stage", self.stage, STAGES)

    def threshold_of(self, contexts: Iterable[str]) -> float:
        """Λ of the nearest context that has one of its own."""
        own = (self.thresholds[c] for c in contexts if c in self.thresholds)
        return next(own, self.threshold)


class Affordances:
    """Inference over the rules of a knowledge base.

    Rules are assimilated by sequence number: what a node's rules are is asked anew only when
    something was told since.
    """

    def __init__(self, source: RuleSource, settings: Settings | None = None) -> None:
        self.source = source
        self.settings = settings or Settings()
        self._sequence = -1
        self._rules: dict[str, tuple[Rule, ...]] = {}

    def features(self, node: str, goal: Goal) -> tuple[Atom, ...]:
        """What vision has to look for at a node (getFeatures), sorted.

        Args:
            node: path of the node in the action tree ("pass/graspObject").
            goal: what the walk is for.
        """
        atoms: set[Atom] = set(_asked(node, goal))
        for level in self._levels(node, goal):
            atoms.update(*(rule.features for rule in self._relevant(level, node, goal)))
        return tuple(sorted(atoms))

    def infer(self, node: str, goal: Goal, observations: Sequence[Observation]) -> Inference:
        """What the observed things afford at a node (getAffordance).

        Args:
            node: path of the node in the action tree.
            goal: what the walk is for.
            observations: what vision reports, in the order of the scene, which breaks ties.

        Returns:
            All candidates, best first. At the find node there is one for each observation; at any
            other node one for each thing and each part (or other argument) that a rule names.
        """
        threshold = self.settings.threshold_of(_contexts(node))
        if _action(node) == FIND:
            found = [self._find(node, goal, seen, threshold) for seen in observations]
        else:
            found = self._constrain(node, goal, observations, threshold)
        return self._ranked(node, threshold, found)

    # --- Selecting rules -----------------------------------------------------------------

    def _levels(self, node: str, goal: Goal) -> tuple[str, ...]:
        """The keys under which rules of this node hang, nearest context first."""
        if _action(node) == FIND:
            wanted = (goal.target.used_for, goal.target.not_used_for)
            return tuple(f"{FIND}.{affordance}" for affordance in wanted if affordance)
        action = _action(node)
        return (*(f"{context}.{action}" for context in _contexts(node)), action)

    def _rules_at(self, key: str) -> tuple[Rule, ...]:
        if self.source.sequence != self._sequence:
            self._rules.clear()
            self._sequence = self.source.sequence
        if key not in self._rules:
            self._rules[key] = tuple(self.source.rules_of([key]))
        return self._rules[key]

    def _relevant(self, key: str, node: str, goal: Goal) -> list[Rule]:
        """The rules under a key whose context holds and, past the find node, whose object fits."""
        acting = {Atom("action", context) for context in _contexts(node)}
        given = acting | set(goal.contexts)
        rules = [rule for rule in self._rules_at(key) if rule.contexts <= given]
        wanted = goal.target.object
        if wanted is None or _action(node) == FIND:
            return rules
        return [rule for rule in rules if rule.object in {wanted, None}]

    # --- Concluding ----------------------------------------------------------------------

    def _find(self, node: str, goal: Goal, seen: Observation, threshold: float) -> Candidate:
        """How surely one thing is what the command asks for."""
        target = goal.target
        parts = [seen.atoms.get(atom, VACUOUS) for atom in _asked(node, goal)]
        used: list[Rule] = []
        argument = None
        for affordance, is_negated in ((target.used_for, False), (target.not_used_for, True)):
            if affordance:
                argument = Atom("affordance", affordance)
                rules = self._applicable(f"{FIND}.{affordance}", node, goal, seen)
                concluded = self._concluded(rules, goal, seen)
                parts.append(negation(concluded) if is_negated else concluded)
                used += rules
        interval = self.settings.operators.all_of(parts)
        return _judged(seen, argument, interval, threshold, used, needs_rule=argument is not None)

    def _constrain(
        self, node: str, goal: Goal, observations: Sequence[Observation], threshold: float
    ) -> list[Candidate]:
        """Which part (or other argument) the rules of the nearest context name, for each thing."""
        found: list[Candidate] = []
        for seen in observations:
            for key in self._levels(node, goal):
                rules = self._applicable(key, node, goal, seen)
                if rules:
                    found += self._by_argument(rules, goal, seen, threshold)
                    break
        return found

    def _by_argument(
        self, rules: Sequence[Rule], goal: Goal, seen: Observation, threshold: float
    ) -> list[Candidate]:
        groups: dict[Atom | None, list[Rule]] = defaultdict(list)
        for rule in rules:
            groups[rule.argument].append(rule)
        return [
            _judged(seen, argument, self._concluded(group, goal, seen), threshold, group)
            for argument, group in groups.items()
        ]

    def _applicable(self, key: str, node: str, goal: Goal, seen: Observation) -> list[Rule]:
        """The relevant rules all of whose features were looked for and reported."""
        atoms = seen.atoms.keys()
        return [rule for rule in self._relevant(key, node, goal) if rule.features <= atoms]

    def _concluded(self, rules: Sequence[Rule], goal: Goal, seen: Observation) -> Interval:
        """One interval from rules with the same conclusion; [0, 1] from none."""
        operators = self.settings.operators
        groups: dict[frozenset[Atom], list[Interval]] = defaultdict(list)
        for rule in rules:
            groups[rule.features | rule.contexts].append(rule.support)
        concluded: list[Interval] = []
        for antecedent, intervals in groups.items():
            known = [_degree(atom, goal, seen) for atom in antecedent]
            premise = operators.all_of(known)
            fused = [operators.fuse(intervals)] if self.settings.stage == "rules" else intervals
            concluded += [operators.conclude(premise, rule) for rule in fused]
        return operators.fuse(concluded) if concluded else VACUOUS

    def _ranked(self, node: str, threshold: float, found: Sequence[Candidate]) -> Inference:
        rank = self.settings.operators.rank
        ordered = sorted(found, key=lambda c: (not c.accepted, -rank(c.interval)))
        ties: tuple[Candidate, ...] = ()
        if ordered and ordered[0].accepted:
            best = rank(ordered[0].interval)
            # In scene order, so that rounding in the last bit cannot decide between equals.
            tied = [c for c in found if c.accepted and rank(c.interval) > best - EPSILON]
            ordered = [tied[0], *(c for c in ordered if c is not tied[0])]
            ties = tuple(tied) if len(tied) > 1 else ()
        denied = tuple(c for c in found if is_denied(c.interval, threshold))
        return Inference(node, threshold, tuple(ordered), ties, denied)


def _action(node: str) -> str:
    return node.rsplit("/", 1)[-1]


def _contexts(node: str) -> tuple[str, ...]:
    return tuple(reversed(node.split("/")[:-1]))


def _asked(node: str, goal: Goal) -> list[Atom]:
    """The features that the command itself names, which matter at the find node only."""
    if _action(node) != FIND:
        return []
    named = [Atom("object", goal.target.object)] if goal.target.object else []
    return named + [Atom("property", name) for name in sorted(goal.target.properties)]


def _degree(atom: Atom, goal: Goal, seen: Observation) -> Interval:
    """How surely an antecedent holds; an action on the path of the node holds by itself."""
    if atom in seen.atoms:
        return seen.atoms[atom]
    return goal.contexts.get(atom, CERTAIN)


def _judged(
    seen: Observation,
    argument: Atom | None,
    interval: Interval,
    threshold: float,
    rules: Sequence[Rule],
    *,
    needs_rule: bool = True,
) -> Candidate:
    accepted = is_affirmed(interval, threshold)
    sure = certainty(interval)
    if needs_rule and not rules:
        reason = "nothing that was told says so"
    elif accepted:
        reason = f"{interval} is sure enough: lambda {sure:.4g} is above {threshold:.4g}"
    elif is_denied(interval, threshold):
        reason = f"{interval} speaks against it"
    else:
        reason = f"{interval} is not sure enough: lambda {sure:.4g} is not above {threshold:.4g}"
    return Candidate(
        seen.name, seen.object, argument, interval, sure, accepted, reason, tuple(rules)
    )
