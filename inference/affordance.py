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
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Protocol

from ..kb.interval import CERTAIN, VACUOUS, Interval
from ..kb.rule import Atom, Rule
from ..ontology.errors import UnknownNameError
from ..ontology.source import read_yaml
from .evidence import EPSILON, Operators, certainty, is_affirmed, is_denied
from .goal import Candidate, Goal, Inference, Observation, Verdict
from .proof import LEAVES, UNKNOWN, Proof, derived, told
from .taxonomy import FLAT, Taxonomy

FIND = "findObject"  # the action whose rules are functional: usedFor(object, affordance)
THRESHOLDS_FILE = Path(__file__).parents[1] / "ontology" / "thresholds.yaml"
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
        threshold: Λ, what lambda must exceed to act, in [0, 1].
        thresholds: Λ of single contexts (action names), before the general one.
    """

    operators: Operators = field(default_factory=Operators)
    stage: str = "rules"
    threshold: float = 0.005
    thresholds: Mapping[str, float] = field(default_factory=dict[str, float])

    def __post_init__(self) -> None:
        if self.stage not in STAGES:
            raise UnknownNameError("fusion stage", self.stage, STAGES)

    @classmethod
    def load(cls, path: Path = THRESHOLDS_FILE) -> Settings:
        """The defaults, with the thresholds of a file.

        Raises:
            DataError: the file is wrong; says where and what was expected.
        """
        top = read_yaml(path).entries(required={"default"}, optional={"contexts"})
        contexts = top["contexts"].entries() if "contexts" in top else {}
        return cls(
            threshold=top["default"].number(low=0, high=1),
            thresholds={name: each.number(low=0, high=1) for name, each in contexts.items()},
        )

    def threshold_of(self, contexts: Iterable[str]) -> float:
        """Λ of the nearest context that has one of its own."""
        own = (self.thresholds[c] for c in contexts if c in self.thresholds)
        return next(own, self.threshold)


class Affordances:
    """Inference over the rules of a knowledge base.

    Rules are assimilated by sequence number: what a node's rules are is asked anew only when
    something was told since.

    Args:
        source: where the rules are.
        settings: the choices of the theory.
        taxonomy: what is a kind of what; rules are inherited along it.
    """

    def __init__(
        self,
        source: RuleSource,
        settings: Settings | None = None,
        taxonomy: Taxonomy = FLAT,
    ) -> None:
        self.source = source
        self.settings = settings or Settings()
        self.taxonomy = taxonomy
        self._sequence = -1
        self._rules: dict[str, tuple[Rule, ...]] = {}

    def features(self, node: str, goal: Goal) -> tuple[Atom, ...]:
        """What vision has to look for at a node (getFeatures), sorted.

        Args:
            node: path of the node in the action tree ("pass/graspObject").
            goal: what the walk is for.
        """
        atoms = set(_asked(node, goal))
        for key in self._levels(node, goal):
            atoms.update(*(rule.features for rule in self._relevant(key, node, goal)))
        return tuple(sorted(kind for atom in atoms for kind in self.taxonomy.below(atom)))

    def infer(self, node: str, goal: Goal, observations: Sequence[Observation]) -> Inference:
        """What the observed things afford at a node (getAffordance).

        Args:
            node: path of the node in the action tree.
            goal: what the walk is for.
            observations: what vision reports, in the order of the scene, which breaks ties.

        Returns:
            All candidates, best first. At the find node there is one for each observation; at any
            other node one for each thing and each part (or other argument) that a rule names.

        Raises:
            ConflictError: the chosen operators are not defined for what was told.
        """
        judge = Judge(node, self.settings)
        if _action(node) == FIND:
            found = [self._find(node, goal, seen, judge) for seen in observations]
        else:
            found = [each for seen in observations for each in self._bound(node, goal, seen, judge)]
        return judge.ranked(found)

    def infer_many(
        self, node: str, goals: Sequence[Goal], scenes: Sequence[Sequence[Observation]]
    ) -> list[Inference]:
        """`infer` for several goals, each with the scene of the same index.

        Raises:
            ValueError: there are not as many scenes as goals.
        """
        return [self.infer(node, *pair) for pair in zip(goals, scenes, strict=True)]

    # --- Selecting rules -----------------------------------------------------------------

    def _levels(self, node: str, goal: Goal) -> tuple[str, ...]:
        """The keys under which rules of this node hang, nearest context first."""
        if _action(node) == FIND:
            wanted = (goal.target.used_for, goal.target.not_used_for)
            return tuple(f"{FIND}.{affordance}" for affordance in wanted if affordance)
        action = _action(node)
        return (*(f"{context.name}.{action}" for context in self._contexts(node)), action)

    def _contexts(self, node: str) -> tuple[Atom, ...]:
        """The actions above a node, nearest first, each with what it is a kind of."""
        acting = (Atom("action", name) for name in contexts_of(node))
        return tuple(
            dict.fromkeys(above for atom in acting for above, _ in self.taxonomy.above(atom))
        )

    def _rules_at(self, key: str) -> tuple[Rule, ...]:
        if self.source.sequence != self._sequence:
            self._rules.clear()
            self._sequence = self.source.sequence
        if key not in self._rules:
            self._rules[key] = tuple(self.source.rules_of([key]))
        return self._rules[key]

    def _relevant(self, key: str, node: str, goal: Goal) -> list[Rule]:
        """The rules under a key whose context holds and, past the find node, whose object fits."""
        given = {*self._contexts(node), *self._closure(goal.contexts)}
        rules = [rule for rule in self._rules_at(key) if rule.contexts <= given]
        if goal.target.object is None or _action(node) == FIND:
            return rules
        wanted = {above.name for above, _ in self._above_object(goal.target.object)}
        return [rule for rule in rules if rule.object is None or rule.object in wanted]

    def _above_object(self, name: str) -> tuple[tuple[Atom, int], ...]:
        return self.taxonomy.above(Atom("object", name))

    def _closure(self, atoms: Iterable[Atom]) -> dict[Atom, tuple[int, Atom]]:
        """What atoms show: themselves and what they are kinds of, with distance and origin."""
        found: dict[Atom, tuple[int, Atom]] = {}
        for atom in atoms:
            for above, distance in self.taxonomy.above(atom):
                if above not in found or distance < found[above][0]:
                    found[above] = (distance, atom)
        return found

    # --- Concluding ----------------------------------------------------------------------

    def _find(self, node: str, goal: Goal, seen: Observation, judge: Judge) -> Candidate:
        """How surely one thing is what the command asks for."""
        target = goal.target
        shown = self._closure(seen.atoms)
        steps = [self._evidence(atom, goal, seen, shown) for atom in _asked(node, goal)]
        argument, inherited = None, 0
        for affordance, is_negated in ((target.used_for, False), (target.not_used_for, True)):
            if affordance:
                argument = Atom("affordance", affordance)
                rules, inherited = self._applicable(f"{FIND}.{affordance}", node, goal, shown)
                proof = self._concluded(rules, goal, seen, shown)
                operators = self.settings.operators
                steps.append(derived("not", [proof], operators) if is_negated else proof)
        if target.is_confirmed:
            steps = [Proof("given", CERTAIN, f"{seen.name} was confirmed by the speaker")]
        return judge.candidate(seen, argument, steps, inherited)

    def _bound(self, node: str, goal: Goal, seen: Observation, judge: Judge) -> Iterator[Candidate]:
        """Which part (or other argument) the rules of the nearest context name for one thing."""
        shown = self._closure(seen.atoms)
        for key in self._levels(node, goal):
            rules, inherited = self._applicable(key, node, goal, shown)
            if rules:
                for argument, group in _by_argument(rules).items():
                    proof = self._concluded(group, goal, seen, shown)
                    yield judge.candidate(seen, argument, [proof], inherited)
                return

    def _applicable(
        self, key: str, node: str, goal: Goal, shown: Mapping[Atom, tuple[int, Atom]]
    ) -> tuple[list[Rule], int]:
        """The relevant rules all of whose features are shown: the nearest, and how near."""
        fitting = [r for r in self._relevant(key, node, goal) if r.features <= shown.keys()]
        if not fitting:
            return [], 0
        distances = [max((shown[f][0] for f in r.features), default=0) for r in fitting]
        nearest = min(distances)
        return [r for r, d in zip(fitting, distances, strict=True) if d == nearest], nearest

    def _concluded(
        self,
        rules: Sequence[Rule],
        goal: Goal,
        seen: Observation,
        shown: Mapping[Atom, tuple[int, Atom]],
    ) -> Proof:
        """One conclusion from rules that agree in what they conclude; unknown from none."""
        operators = self.settings.operators
        groups: dict[frozenset[Atom], list[Proof]] = defaultdict(list)
        for rule in rules:
            groups[rule.features | rule.contexts].append(told(rule))
        concluded: list[Proof] = []
        for antecedent, said in groups.items():
            known = [self._evidence(atom, goal, seen, shown) for atom in sorted(antecedent)]
            premise = derived("and", known, operators)
            fused = [derived("fuse", said, operators)] if self.settings.stage == "rules" else said
            concluded += [derived("modus ponens", (premise, rule), operators) for rule in fused]
        return derived("fuse", concluded, operators) if concluded else UNKNOWN

    def _evidence(
        self, atom: Atom, goal: Goal, seen: Observation, shown: Mapping[Atom, tuple[int, Atom]]
    ) -> Proof:
        """How surely an antecedent holds; an action on the path of the node holds by itself."""
        if atom in shown:
            origin = shown[atom][1]
            kind = "" if origin == atom else f", which is a kind of {atom.name}"
            return Proof("seen", seen.atoms[origin], f"{origin} seen on {seen.name}{kind}")
        if atom.kind in {"object", "part", "property"}:
            return Proof("seen", VACUOUS, f"{atom} not seen on {seen.name}")
        given = self._closure(goal.contexts)
        interval = goal.contexts[given[atom][1]] if atom in given else CERTAIN
        return Proof("given", interval, str(atom))


class Judge:
    """Decides at one node which conclusions are sure enough, and which is the best."""

    def __init__(self, node: str, settings: Settings) -> None:
        self.node = node
        self.operators = settings.operators
        self.threshold = settings.threshold_of(contexts_of(node))

    def candidate(
        self, seen: Observation, argument: Atom | None, steps: Sequence[Proof], inherited: int
    ) -> Candidate:
        """What all steps together come to for one thing."""
        proof = derived("and", steps, self.operators)
        if argument is not None and proof.step not in LEAVES:
            proof = replace(proof, label=f"{seen.name} affords {argument}")
        sure = certainty(proof.interval)
        verdict = self.verdict(proof, UNKNOWN in steps)
        reason = _REASONS[verdict].format(proof.interval, sure, self.threshold)
        return Candidate(seen.name, seen.object, argument, proof, sure, verdict, reason, inherited)

    def verdict(self, proof: Proof, is_unknown: bool) -> Verdict:
        """Whether to act on a conclusion, to avoid it, or neither."""
        if is_unknown:
            return "unknown"
        if is_affirmed(proof.interval, self.threshold):
            return "accepted"
        return "denied" if is_denied(proof.interval, self.threshold) else "unsure"

    def first(self, intervals: Sequence[Interval]) -> int | None:
        """The index of the first of the best intervals that are sure enough; None of none."""
        sure = [i for i, each in enumerate(intervals) if is_affirmed(each, self.threshold)]
        if not sure:
            return None
        best = max(self.operators.rank(intervals[i]) for i in sure)
        return next(i for i in sure if self.operators.rank(intervals[i]) > best - EPSILON)

    def ranked(self, found: Sequence[Candidate]) -> Inference:
        """All candidates, the best first; equals in the order in which they were found."""
        rank = self.operators.rank
        ordered = sorted(found, key=lambda each: (not each.accepted, -rank(each.interval)))
        ties: tuple[Candidate, ...] = ()
        if ordered and ordered[0].accepted:
            best = rank(ordered[0].interval)
            # In scene order, so that rounding in the last bit cannot decide between equals.
            tied = [
                each for each in found if each.accepted and rank(each.interval) > best - EPSILON
            ]
            ordered = [tied[0], *(each for each in ordered if each is not tied[0])]
            ties = tuple(tied) if len(tied) > 1 else ()
        return Inference(self.node, self.threshold, tuple(ordered), ties)


_REASONS: Mapping[Verdict, str] = {
    "accepted": "{0} is sure enough: lambda {1:.4g} is above {2:.4g}",
    "denied": "{0} speaks against it",
    "unsure": "{0} is not sure enough: lambda {1:.4g} is not above {2:.4g}",
    "unknown": "nothing that was told says so",
}


def contexts_of(node: str) -> tuple[str, ...]:
    """The contexts of a node, nearest first: the actions above it on its path."""
    return tuple(reversed(node.split("/")[:-1]))


def _action(node: str) -> str:
    return node.rsplit("/", 1)[-1]


def _asked(node: str, goal: Goal) -> list[Atom]:
    """The features that the command itself names, which matter at the find node only."""
    if _action(node) != FIND:
        return []
    named = [Atom("object", goal.target.object)] if goal.target.object else []
    return named + [Atom("property", name) for name in sorted(goal.target.properties)]


def _by_argument(rules: Sequence[Rule]) -> dict[Atom | None, list[Rule]]:
    groups: dict[Atom | None, list[Rule]] = defaultdict(list)
    for rule in rules:
        groups[rule.argument].append(rule)
    return groups
