# SPDX-License-Identifier: Apache-2.0
"""Affordance inference at the nodes of an action tree: getFeatures and getAffordance.

Paper, section 3.3. `Affordances.features` selects the rules of a node and returns the perceptual
invariants that vision has to look for. `Affordances.infer` takes the observations and concludes
what each object affords: AND over the antecedents, modus ponens with the rule's interval, fusion of
equal conclusions, and lambda against the threshold of the context (section 2).

Rules with the same antecedent are fused before modus ponens: the antecedent is one piece of
evidence and would otherwise be counted once for each rule. With perfect detection both orders give
the same result. A `NodeRules` selects the rules of one node for one goal.

A use may have a material, which is a context of its rule: a saw is used for cutting wood. Which
rules apply depends on whether the goal names a material:

| rule | asked for bread | asked for no material |
|---|---|---|
| used for cutting; not used for cutting | applies | applies |
| used for cutting bread | applies | applies |
| not used for cutting bread | applies | does not apply |
| used, or not used, for cutting wood | does not apply | as for bread |
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cached_property
from itertools import chain
from typing import Protocol

from ..kb.interval import CERTAIN, VACUOUS
from ..kb.rule import USED_FOR, Atom, Rule
from ..ontology.actions import Actions
from .decision import DecisionRule, ObjectRules
from .proof import Proof, derive, rule_proof, unknown_proof
from .settings import Settings
from .taxonomy import FLAT, Taxonomy
from .types import Candidate, Conclusion, Goal, Inference, Observation

FIND = "findObject"  # the action that selects an object; its rules conclude usedFor(affordance)
PERCEIVED = ("object", "part", "property")  # kinds of atoms that vision reports
MATERIAL = "material"

ImpliedAtoms = Mapping[Atom, tuple[int, Atom]]  # atom -> steps up from the given atom, given atom


class RuleSource(Protocol):
    """A source of rules by node, such as a knowledge base."""

    @property
    def sequence(self) -> int:
        """The number of the last change; equal numbers mean equal rules."""
        ...

    def rules_at_nodes(self, nodes: Sequence[str]) -> Sequence[Rule]:
        """Return the active rules at any of the given nodes."""
        ...


class Affordances:
    """Inference over the rules of a source, which are inherited along a taxonomy.

    The rules of a node are cached until the sequence number of the source changes.
    """

    def __init__(
        self, source: RuleSource, settings: Settings | None = None, taxonomy: Taxonomy = FLAT
    ) -> None:
        self.source = source
        self.settings = settings or Settings()
        self.taxonomy = taxonomy
        self._sequence = -1
        self._rules: dict[str, tuple[Rule, ...]] = {}

    def features(self, node: str, goal: Goal) -> tuple[Atom, ...]:
        """Return the features that vision has to look for at a node (getFeatures), sorted.

        `node` is the path of the node in the action tree of the goal ("pass/graspObject").
        """
        here = self._node_context(node, goal)
        atoms = set(here.named_features)
        for key in here.keys:
            atoms.update(*(rule.features for rule in here.rules(key)))
        return tuple(sorted(kind for atom in atoms for kind in self.taxonomy.below(atom)))

    def infer(self, node: str, goal: Goal, observations: Sequence[Observation]) -> Inference:
        """Infer what the observed objects afford at a node (getAffordance).

        Observations are in the order of the scene, which breaks ties. The candidates are sorted,
        best first: at the find node one for each observation, at any other node one for each object
        and each part (or other argument) that a rule names.

        Raises:
            ConflictError: the chosen operators are not defined for the given rules.
        """
        here = self._node_context(node, goal)
        decision = DecisionRule(node, here.threshold(self.settings), self.settings.operators)
        if here.action != FIND:
            groups = (self._argument_candidates(here, seen, decision) for seen in observations)
            return decision.ranked(list(chain.from_iterable(groups)))
        found = [self._object_candidate(here, seen, decision) for seen in observations]
        if any(each.accepted for each in found):
            return decision.ranked(found)
        return decision.ranked(found, list(self._absent_candidates(here, observations, decision)))

    def _node_context(self, node: str, goal: Goal) -> NodeRules:
        """Return the context of a node, after dropping cached rules that are out of date."""
        sequence = self.source.sequence
        if sequence != self._sequence:
            self._rules.clear()
            self._sequence = sequence
        return NodeRules(node, goal, self._rules_at, self.taxonomy)

    def _rules_at(self, key: str) -> Sequence[Rule]:
        if key not in self._rules:
            self._rules[key] = tuple(self.source.rules_at_nodes([key]))
        return self._rules[key]

    def _object_candidate(
        self, here: NodeRules, seen: Observation, decision: DecisionRule
    ) -> Candidate:
        """Return how surely an object is what the command asks for."""
        target = here.goal.target
        shown = implied_atoms(seen.atoms, self.taxonomy)
        steps = [_evidence(atom, here, seen, shown) for atom in here.named_features]
        argument, applied = None, ObjectRules()
        for conclusion, is_negated in target.wanted:
            argument = conclusion.argument
            applied = here.concluding(conclusion, shown)
            proof = self._conclude(applied.rules, here, seen, shown)
            operators = self.settings.operators
            steps.append(derive("not", [proof], operators) if is_negated else proof)
        if target.is_confirmed:
            steps = [Proof("given", CERTAIN, f"{seen.name} was confirmed by the speaker")]
        return decision.candidate(seen, argument, steps, applied)

    def _argument_candidates(
        self, here: NodeRules, seen: Observation, decision: DecisionRule
    ) -> Iterator[Candidate]:
        """Yield the parts (or other arguments) that the rules of the nearest context name."""
        shown = implied_atoms(seen.atoms, self.taxonomy)
        for key in here.keys:
            applied = nearest_rules(here.rules(key), shown)
            if applied.rules:
                groups: dict[Atom | None, list[Rule]] = defaultdict(list)
                for rule in applied.rules:
                    groups[rule.argument].append(rule)
                for argument, group in groups.items():
                    proof = self._conclude(group, here, seen, shown)
                    yield decision.candidate(seen, argument, [proof], applied)
                return

    def _absent_candidates(
        self, here: NodeRules, observations: Sequence[Observation], decision: DecisionRule
    ) -> Iterator[Candidate]:
        """Yield candidates for objects that rules name but that are not in view."""
        shown = [implied_atoms(seen.atoms, self.taxonomy) for seen in observations]
        for conclusion, is_negated in here.goal.target.wanted:
            groups: dict[str, list[Rule]] = defaultdict(list)
            wanted = conclusion.argument
            for rule in chain.from_iterable(map(here.rules, here.keys_of(conclusion))):
                in_view = any(rule.features <= each.keys() for each in shown)
                fits = wanted is None or rule.argument in {None, wanted}
                if rule.asserts and fits and not is_negated and not in_view:
                    groups[rule.object or "thing"].append(rule)
            for name, rules in groups.items():
                nothing = Observation(name, name, {})
                steps = [self._conclude(rules, here, nothing, {})]
                applied = ObjectRules(tuple(rules))
                yield decision.candidate(nothing, wanted, steps, applied, is_absent=True)

    def _conclude(
        self, rules: Sequence[Rule], here: NodeRules, seen: Observation, shown: ImpliedAtoms
    ) -> Proof:
        """Return the proof of one conclusion from its rules; unknown if there are none."""
        if not rules:
            return unknown_proof(seen.name)
        operators = self.settings.operators
        concluded: list[Proof] = []
        for group in self._fusion_groups(rules):
            antecedent = sorted(_evidence_atoms(group[0]))
            known = [_evidence(atom, here, seen, shown) for atom in antecedent]
            premise = derive("and", known, operators)
            rule = derive("fuse", [rule_proof(each) for each in group], operators)
            concluded.append(derive("modus ponens", (premise, rule), operators))
        return derive("fuse", concluded, operators)

    def _fusion_groups(self, rules: Sequence[Rule]) -> Iterable[Sequence[Rule]]:
        """Group the rules that are fused before modus ponens; the newest is in the last group."""
        if len(rules) == 1:
            return [rules]
        in_time = sorted(rules, key=lambda rule: (rule.utterance or 0, rule.id))
        if self.settings.stage == "conclusions":
            return [[rule] for rule in in_time]
        groups: dict[frozenset[Atom], list[Rule]] = defaultdict(list)
        for rule in in_time:
            groups[_evidence_atoms(rule)].append(rule)
        return sorted(groups.values(), key=lambda group: group[-1].utterance or 0)


def _evidence_atoms(rule: Rule) -> frozenset[Atom]:
    """Return the antecedent without the material: rules for another material never get here."""
    return frozenset(a for a in rule.features | rule.contexts if a.kind != MATERIAL)


def _evidence(atom: Atom, here: NodeRules, seen: Observation, shown: ImpliedAtoms) -> Proof:
    """Return the evidence for an antecedent; an action on the path of the node is certain."""
    if atom in shown:
        origin = shown[atom][1]
        label = f"{origin} seen on {seen.name}{_kind_of(origin, atom)}"
        return Proof("seen", seen.atoms[origin], label)
    if atom.kind in PERCEIVED:
        where = f" on {seen.name}" if seen.atoms else ""
        return Proof("seen", VACUOUS, f"{atom} not seen{where}")
    if atom not in here.given:
        return Proof("given", CERTAIN, str(atom))
    origin = here.given[atom][1]
    return Proof("given", here.goal.contexts[origin], f"{origin}{_kind_of(origin, atom)}")


def _kind_of(origin: Atom, atom: Atom) -> str:
    return "" if origin == atom else f", which is a kind of {atom.name}"


class NodeRules:
    """The rules that apply at one node for one goal; shared by all objects observed there.

    `rules_at` returns the rules stored under a key.
    """

    def __init__(
        self, node: str, goal: Goal, rules_at: Callable[[str], Sequence[Rule]], taxonomy: Taxonomy
    ) -> None:
        self.node, self.goal, self.taxonomy = node, goal, taxonomy
        self.action = node.rsplit("/", 1)[-1]
        self._rules_at = rules_at
        self._selected: dict[str, Sequence[Rule]] = {}

    @cached_property
    def contexts(self) -> tuple[Atom, ...]:
        """The actions above the node, nearest first, each with its more general actions."""
        acting = (Atom("action", name) for name in Actions.contexts(self.node))
        kinds = (above for atom in acting for above, _ in self.taxonomy.above(atom))
        return tuple(dict.fromkeys(kinds))

    @cached_property
    def given(self) -> ImpliedAtoms:
        """The other contexts of the goal, with their more general kinds."""
        return implied_atoms(self.goal.contexts, self.taxonomy)

    @cached_property
    def named_features(self) -> tuple[Atom, ...]:
        """The features that the command itself names; used at the find node only."""
        if self.action != FIND:
            return ()
        target = self.goal.target
        named = [Atom("object", target.object)] if target.object else []
        return (*named, *(Atom("property", name) for name in sorted(target.properties)))

    @cached_property
    def keys(self) -> tuple[str, ...]:
        """The keys of the rules of this node, nearest context first."""
        if self.action != FIND:
            return self._keys(self.action)
        wanted = (self.keys_of(conclusion) for conclusion, _ in self.goal.target.wanted)
        return tuple(key for keys in wanted for key in keys)

    def keys_of(self, wanted: Conclusion) -> tuple[str, ...]:
        """Return the keys of the rules that can conclude what is wanted."""
        if wanted.functor == USED_FOR and wanted.argument:
            return (f"{FIND}.{wanted.argument.name}",)
        return self._keys(wanted.functor)

    def threshold(self, settings: Settings) -> float:
        """Return the threshold Λ at this node."""
        if not settings.thresholds:
            return settings.threshold
        return settings.threshold_of((context.name for context in self.contexts), self.given)

    def rules(self, key: str) -> Sequence[Rule]:
        """Return the rules of a key whose contexts hold and (past the find node) object fits."""
        if key not in self._selected:
            rules = [rule for rule in self._rules_at(key) if self._holds(rule)]
            name = self.goal.target.object
            if name is not None and self.action != FIND:
                wanted = {above.name for above, _ in self.taxonomy.above(Atom("object", name))}
                rules = [rule for rule in rules if rule.object is None or rule.object in wanted]
            self._selected[key] = rules
        return self._selected[key]

    def concluding(self, wanted: Conclusion, shown: ImpliedAtoms) -> ObjectRules:
        """Return the rules of the nearest context that conclude what is wanted of an object."""
        arguments = implied_atoms([wanted.argument], self.taxonomy) if wanted.argument else None
        for key in self.keys_of(wanted):
            rules = self.rules(key)
            if arguments is not None:
                rules = [r for r in rules if r.argument is None or r.argument in arguments]
            applied = nearest_rules(rules, shown, arguments or {})
            if applied.rules:
                return applied
        return ObjectRules()

    @cached_property
    def _held(self) -> frozenset[Atom]:
        """The contexts that hold: the actions, and those of the goal."""
        return frozenset((*self.contexts, *self.given))

    @cached_property
    def _material(self) -> frozenset[str]:
        return material_kinds(self.goal.target.material, self.taxonomy)

    def _holds(self, rule: Rule) -> bool:
        contexts = (atom for atom in rule.contexts if atom.kind != MATERIAL)
        return rule.applies_to(self._material) and self._held.issuperset(contexts)

    def _keys(self, functor: str) -> tuple[str, ...]:
        return (*(f"{context.name}.{functor}" for context in self.contexts), functor)


def material_kinds(name: str | None, taxonomy: Taxonomy) -> frozenset[str]:
    """Return the names of a material and of its more general kinds: rye bread is bread."""
    kinds = taxonomy.above(Atom("object", name)) if name else ()
    return frozenset(kind.name for kind, _ in kinds)


def implied_atoms(atoms: Iterable[Atom], taxonomy: Taxonomy) -> ImpliedAtoms:
    """Return the atoms and all kinds above them, with distance and the atom they follow from."""
    found: dict[Atom, tuple[int, Atom]] = {}
    for atom in atoms:
        for above, distance in taxonomy.above(atom):
            if above not in found or distance < found[above][0]:
                found[above] = (distance, atom)
    return found


def nearest_rules(
    rules: Sequence[Rule], shown: ImpliedAtoms, arguments: ImpliedAtoms | None = None
) -> ObjectRules:
    """Return the nearest of the rules whose features are all observed."""
    fitting = [rule for rule in rules if rule.features <= shown.keys()]
    if not fitting:
        return ObjectRules()
    pairs = [(rule, _distance(rule, shown, arguments or {})) for rule in fitting]
    least = min(distance for _, distance in pairs)
    near = tuple(rule for rule, distance in pairs if distance == least)
    return ObjectRules(near, least, tuple(rule for rule, far in pairs if far > least))


def _distance(rule: Rule, shown: ImpliedAtoms, arguments: ImpliedAtoms) -> int:
    """Return the number of is-a steps from the observation and the wanted argument to a rule."""
    above = max((shown[feature][0] for feature in rule.features), default=0)
    if rule.argument is None or rule.argument not in arguments:
        return above
    return above + arguments[rule.argument][0]
