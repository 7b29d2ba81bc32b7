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
from collections.abc import Iterable, Iterator, Sequence
from typing import Protocol

from ..kb.interval import CERTAIN, VACUOUS
from ..kb.rule import Atom, Rule
from .decision import Applicable, Judge
from .proof import Proof, derived, told, unknown
from .selection import FIND, NodeContext, Shown, closure, nearest
from .settings import Settings
from .taxonomy import FLAT, Taxonomy
from .types import Candidate, Goal, Inference, Observation

PERCEIVED = ("object", "part", "property")  # kinds of atoms that eyes report


class RuleSource(Protocol):
    """Where rules come from: a knowledge base, or anything else that keeps them by node."""

    @property
    def sequence(self) -> int:
        """The number of the last change; equal numbers mean equal rules."""
        ...

    def rules_at_nodes(self, nodes: Sequence[str]) -> Sequence[Rule]:
        """The active rules that hang on any of these nodes."""
        ...


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
        here = self._situation(node, goal)
        atoms = set(here.asked)
        for key in here.levels:
            atoms.update(*(rule.features for rule in here.relevant(key)))
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
        here = self._situation(node, goal)
        judge = Judge(node, here.threshold(self.settings), self.settings.operators)
        if here.action != FIND:
            found = [each for seen in observations for each in self._bound(here, seen, judge)]
            return judge.ranked(found)
        found = [self._find(here, seen, judge) for seen in observations]
        if any(each.accepted for each in found):
            return judge.ranked(found)
        return judge.ranked(found, list(self._absent(here, observations, judge)))

    def infer_many(
        self, node: str, goals: Sequence[Goal], scenes: Sequence[Sequence[Observation]]
    ) -> list[Inference]:
        """`infer` for several goals, each with the scene of the same index.

        Raises:
            ValueError: there are not as many scenes as goals.
        """
        return [self.infer(node, *pair) for pair in zip(goals, scenes, strict=True)]

    def _situation(self, node: str, goal: Goal) -> NodeContext:
        """A node with a goal, after what was told since is assimilated."""
        sequence = self.source.sequence
        if sequence != self._sequence:
            self._rules.clear()
            self._sequence = sequence
        return NodeContext(node, goal, self._rules_at, self.taxonomy)

    def _rules_at(self, key: str) -> Sequence[Rule]:
        if key not in self._rules:
            self._rules[key] = tuple(self.source.rules_at_nodes([key]))
        return self._rules[key]

    # --- Concluding ----------------------------------------------------------------------

    def _find(self, here: NodeContext, seen: Observation, judge: Judge) -> Candidate:
        """How surely one thing is what the command asks for."""
        target = here.goal.target
        shown = closure(seen.atoms, self.taxonomy)
        steps = [_evidence(atom, here, seen, shown) for atom in here.asked]
        argument, applied = None, Applicable()
        for conclusion, is_negated in target.wanted:
            argument = conclusion.argument
            applied = here.concluding(conclusion, shown)
            proof = self._concluded(applied.rules, here, seen, shown)
            operators = self.settings.operators
            steps.append(derived("not", [proof], operators) if is_negated else proof)
        if target.is_confirmed:
            steps = [Proof("given", CERTAIN, f"{seen.name} was confirmed by the speaker")]
        return judge.candidate(seen, argument, steps, applied)

    def _bound(self, here: NodeContext, seen: Observation, judge: Judge) -> Iterator[Candidate]:
        """Which part (or other argument) the rules of the nearest context name for one thing."""
        shown = closure(seen.atoms, self.taxonomy)
        for key in here.levels:
            applied = nearest(here.relevant(key), shown)
            if applied.rules:
                for argument, group in _by_argument(applied.rules).items():
                    proof = self._concluded(group, here, seen, shown)
                    yield judge.candidate(seen, argument, [proof], applied)
                return

    def _absent(
        self, here: NodeContext, observations: Sequence[Observation], judge: Judge
    ) -> Iterator[Candidate]:
        """What rules speak for that is not in view: each as if it had been looked for in vain."""
        shown = [closure(seen.atoms, self.taxonomy) for seen in observations]
        for conclusion, is_negated in here.goal.target.wanted:
            groups: dict[str, list[Rule]] = defaultdict(list)
            for key in here.keys_of(conclusion):
                for rule in here.relevant(key):
                    in_view = any(rule.features <= each.keys() for each in shown)
                    fits = conclusion.argument is None or rule.argument in {
                        None,
                        conclusion.argument,
                    }
                    if rule.asserts and fits and not is_negated and not in_view:
                        groups[rule.object or "thing"].append(rule)
            for name, rules in groups.items():
                nothing = Observation(name, name, {})
                steps = [self._concluded(rules, here, nothing, {})]
                applied = Applicable(tuple(rules))
                yield judge.candidate(nothing, conclusion.argument, steps, applied, is_absent=True)

    def _concluded(
        self, rules: Sequence[Rule], here: NodeContext, seen: Observation, shown: Shown
    ) -> Proof:
        """One conclusion from rules that agree in what they conclude; unknown from none."""
        if not rules:
            return unknown(seen.name)
        operators = self.settings.operators
        concluded: list[Proof] = []
        for group in self._groups(rules):
            antecedent = sorted(group[0].features | group[0].contexts)
            known = [_evidence(atom, here, seen, shown) for atom in antecedent]
            premise = derived("and", known, operators)
            rule = derived("fuse", [told(each) for each in group], operators)
            concluded.append(derived("modus ponens", (premise, rule), operators))
        return derived("fuse", concluded, operators)

    def _groups(self, rules: Sequence[Rule]) -> Iterable[Sequence[Rule]]:
        """Rules that are fused before modus ponens, the one told last in the last group."""
        if len(rules) == 1:
            return [rules]
        in_time = sorted(rules, key=lambda rule: (rule.utterance or 0, rule.id))
        if self.settings.stage == "conclusions":
            return [[rule] for rule in in_time]
        groups: dict[frozenset[Atom], list[Rule]] = defaultdict(list)
        for rule in in_time:
            groups[rule.features | rule.contexts].append(rule)
        return sorted(groups.values(), key=lambda group: group[-1].utterance or 0)


def _evidence(atom: Atom, here: NodeContext, seen: Observation, shown: Shown) -> Proof:
    """How surely an antecedent holds; an action on the path of the node holds by itself."""
    if atom in shown:
        origin = shown[atom][1]
        return Proof("seen", seen.atoms[origin], f"{origin} seen on {seen.name}{_as(origin, atom)}")
    if atom.kind in PERCEIVED:
        where = f" on {seen.name}" if seen.atoms else ""
        return Proof("seen", VACUOUS, f"{atom} not seen{where}")
    if atom not in here.given:
        return Proof("given", CERTAIN, str(atom))
    origin = here.given[atom][1]
    return Proof("given", here.goal.contexts[origin], f"{origin}{_as(origin, atom)}")


def _as(origin: Atom, atom: Atom) -> str:
    return "" if origin == atom else f", which is a kind of {atom.name}"


def _by_argument(rules: Sequence[Rule]) -> dict[Atom | None, list[Rule]]:
    groups: dict[Atom | None, list[Rule]] = defaultdict(list)
    for rule in rules:
        groups[rule.argument].append(rule)
    return groups
