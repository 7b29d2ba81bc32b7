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
from typing import Protocol

from ..kb.interval import CERTAIN, VACUOUS
from ..kb.rule import USED_FOR, Atom, Rule
from .goal import Candidate, Conclusion, Goal, Inference, Observation
from .judging import Applicable, Judge
from .proof import Proof, derived, told, unknown
from .settings import Settings
from .taxonomy import FLAT, Taxonomy

FIND = "findObject"  # the action whose rules say which thing: usedFor(object, affordance)

Shown = Mapping[Atom, tuple[int, Atom]]  # what holds -> steps up from what was seen, and that


class RuleSource(Protocol):
    """Where rules come from: a knowledge base, or anything else that keeps them by node."""

    @property
    def sequence(self) -> int:
        """The number of the last change; equal numbers mean equal rules."""
        ...

    def rules_of(self, nodes: Sequence[str]) -> Sequence[Rule]:
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
        judge = Judge(node, self._threshold(node, goal), self.settings.operators)
        if _action(node) != FIND:
            found = [each for seen in observations for each in self._bound(node, goal, seen, judge)]
            return judge.ranked(found)
        found = [self._find(node, goal, seen, judge) for seen in observations]
        if any(each.accepted for each in found):
            return judge.ranked(found)
        return judge.ranked(found, list(self._absent(node, goal, observations, judge)))

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
        if _action(node) != FIND:
            return self._keys(node, _action(node))
        wanted = (self._keys_of(node, conclusion) for conclusion, _ in goal.target.wanted)
        return tuple(key for keys in wanted for key in keys)

    def _keys_of(self, node: str, wanted: Conclusion) -> tuple[str, ...]:
        """The keys under which rules hang that conclude what is wanted of a thing."""
        if wanted.functor == USED_FOR and wanted.argument:
            return (f"{FIND}.{wanted.argument.name}",)
        return self._keys(node, wanted.functor)

    def _keys(self, node: str, functor: str) -> tuple[str, ...]:
        return (*(f"{context.name}.{functor}" for context in self._contexts(node)), functor)

    def _contexts(self, node: str) -> tuple[Atom, ...]:
        """The actions above a node, nearest first, each with what it is a kind of."""
        acting = (Atom("action", name) for name in contexts_of(node))
        return tuple(
            dict.fromkeys(above for atom in acting for above, _ in self.taxonomy.above(atom))
        )

    def _threshold(self, node: str, goal: Goal) -> float:
        if not self.settings.thresholds:
            return self.settings.threshold
        actions = (context.name for context in self._contexts(node))
        return self.settings.threshold_of(actions, self._closure(goal.contexts))

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
        argument, applied = None, Applicable()
        for conclusion, is_negated in target.wanted:
            argument = conclusion.argument
            applied = self._concluding(conclusion, node, goal, shown)
            proof = self._concluded(applied.rules, goal, seen, shown)
            operators = self.settings.operators
            steps.append(derived("not", [proof], operators) if is_negated else proof)
        if target.is_confirmed:
            steps = [Proof("given", CERTAIN, f"{seen.name} was confirmed by the speaker")]
        return judge.candidate(seen, argument, steps, applied)

    def _bound(self, node: str, goal: Goal, seen: Observation, judge: Judge) -> Iterator[Candidate]:
        """Which part (or other argument) the rules of the nearest context name for one thing."""
        shown = self._closure(seen.atoms)
        for key in self._levels(node, goal):
            applied = self._nearest(self._relevant(key, node, goal), shown)
            if applied.rules:
                for argument, group in _by_argument(applied.rules).items():
                    proof = self._concluded(group, goal, seen, shown)
                    yield judge.candidate(seen, argument, [proof], applied)
                return

    def _absent(
        self, node: str, goal: Goal, observations: Sequence[Observation], judge: Judge
    ) -> Iterator[Candidate]:
        """What rules speak for that is not in view: each as if it had been looked for in vain."""
        shown = [self._closure(seen.atoms) for seen in observations]
        for conclusion, is_negated in goal.target.wanted:
            groups: dict[str, list[Rule]] = defaultdict(list)
            for key in self._keys_of(node, conclusion):
                for rule in self._relevant(key, node, goal):
                    in_view = any(rule.features <= each.keys() for each in shown)
                    if rule.asserts and not is_negated and not in_view:
                        groups[rule.object or "thing"].append(rule)
            for name, rules in groups.items():
                nothing = Observation(name, name, {})
                proof = self._concluded(rules, goal, nothing, {})
                applied = Applicable(tuple(rules))
                yield judge.candidate(
                    nothing, conclusion.argument, [proof], applied, is_absent=True
                )

    def _concluding(self, wanted: Conclusion, node: str, goal: Goal, shown: Shown) -> Applicable:
        """The rules of the nearest context that conclude what is wanted of a thing."""
        arguments = self._closure([wanted.argument]) if wanted.argument else None
        for key in self._keys_of(node, wanted):
            rules = self._relevant(key, node, goal)
            if arguments is not None:
                rules = [r for r in rules if r.argument is None or r.argument in arguments]
            applied = self._nearest(rules, shown, arguments or {})
            if applied.rules:
                return applied
        return Applicable()

    def _nearest(
        self, rules: Sequence[Rule], shown: Shown, arguments: Shown | None = None
    ) -> Applicable:
        """Of rules those all of whose features are shown, and of these the nearest."""
        fitting = [rule for rule in rules if rule.features <= shown.keys()]
        if not fitting:
            return Applicable()
        distances = [_distance(rule, shown, arguments or {}) for rule in fitting]
        nearest = min(distances)
        pairs = list(zip(fitting, distances, strict=True))
        near = tuple(rule for rule, distance in pairs if distance == nearest)
        return Applicable(near, nearest, tuple(rule for rule, d in pairs if d > nearest))

    def _concluded(
        self, rules: Sequence[Rule], goal: Goal, seen: Observation, shown: Shown
    ) -> Proof:
        """One conclusion from rules that agree in what they conclude; unknown from none."""
        if not rules:
            return unknown(seen.name)
        operators = self.settings.operators
        concluded: list[Proof] = []
        for group in self._groups(rules):
            antecedent = sorted(group[0].features | group[0].contexts)
            known = [self._evidence(atom, goal, seen, shown) for atom in antecedent]
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

    def _evidence(self, atom: Atom, goal: Goal, seen: Observation, shown: Shown) -> Proof:
        """How surely an antecedent holds; an action on the path of the node holds by itself."""
        if atom in shown:
            origin = shown[atom][1]
            kind = "" if origin == atom else f", which is a kind of {atom.name}"
            return Proof("seen", seen.atoms[origin], f"{origin} seen on {seen.name}{kind}")
        if atom.kind in {"object", "part", "property"}:
            where = f" on {seen.name}" if seen.atoms else ""
            return Proof("seen", VACUOUS, f"{atom} not seen{where}")
        given = self._closure(goal.contexts)
        if atom not in given:
            return Proof("given", CERTAIN, str(atom))
        origin = given[atom][1]
        kind = "" if origin == atom else f", which is a kind of {atom.name}"
        return Proof("given", goal.contexts[origin], f"{origin}{kind}")


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


def _distance(rule: Rule, shown: Shown, arguments: Shown) -> int:
    """How many steps up from what is seen, and from what is wanted, a rule was found."""
    above = max((shown[feature][0] for feature in rule.features), default=0)
    if rule.argument is None or rule.argument not in arguments:
        return above
    return above + arguments[rule.argument][0]


def _by_argument(rules: Sequence[Rule]) -> dict[Atom | None, list[Rule]]:
    groups: dict[Atom | None, list[Rule]] = defaultdict(list)
    for rule in rules:
        groups[rule.argument].append(rule)
    return groups
