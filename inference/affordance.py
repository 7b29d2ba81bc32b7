"""Affordance inference at the nodes of an action tree: getFeatures and getAffordance.

Paper, section 3.3. `Affordances.features` selects the rules of a node and returns the perceptual
invariants that vision has to look for. `Affordances.infer` takes the observations and concludes
what each object affords: AND over the antecedents, modus ponens with the rule's interval, fusion of
equal conclusions, and lambda against the threshold of the context (section 2).

Rules with the same antecedent are fused before modus ponens: the antecedent is one piece of
evidence and would otherwise be counted once for each rule. With perfect detection both orders give
the same result. `NodeRules` selects the rules of one node for one goal; more specific rules
override general ones (`node_rules`).
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from itertools import chain
from typing import Protocol

from ..kb.interval import CERTAIN, VACUOUS
from ..kb.rule import GRASP_OBJECT, KIND_OF, Atom, Rule
from .decision import DecisionRule, ObjectRules
from .experience import NO_TRIALS, Experience, OutcomeCounts
from .node_rules import FIND, ImpliedAtoms, NodeRules, acting_for, features_of, implied_atoms
from .proof import Proof, derive
from .settings import Settings
from .taxonomy import FLAT, Taxonomy
from .types import Candidate, Goal, Inference, Observation

PERCEIVED = ("object", "part", "property")  # kinds of atoms that vision reports


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

    What is told about the parts to grasp by is discounted by `experience`, if there is any. The
    rules of a node are cached until the sequence number of the source changes.
    """

    def __init__(
        self,
        source: RuleSource,
        settings: Settings | None = None,
        taxonomy: Taxonomy = FLAT,
        experience: Experience | None = None,
    ) -> None:
        self.source = source
        self.experience = experience
        self.settings = settings or Settings()
        self._declared = self._taxonomy = taxonomy
        self._sequence: int | None = None
        self._rules: dict[str, tuple[Rule, ...]] = {}

    @property
    def taxonomy(self) -> Taxonomy:
        """The taxonomy that was given, and the kinds that the rules of the source conclude."""
        self._refresh()
        return self._taxonomy

    def features(self, node: str, goal: Goal) -> tuple[Atom, ...]:
        """Return the features that vision has to look for at a node ("pass/findObject"), sorted."""
        here = self._node_context(node, goal)
        atoms = {*here.named_features, *here.relevant_features}
        return tuple(sorted(kind for atom in atoms for kind in self._taxonomy.below(atom)))

    def infer(self, node: str, goal: Goal, observations: Sequence[Observation]) -> Inference:
        """Infer what the observed objects afford at a node (getAffordance).

        Observations are in the order of the scene, which breaks ties. The candidates are sorted,
        best first: at the find node one for each observation, at any other node one for each object
        and each part (or other argument) that a rule names. ConflictError if the chosen operators
        are not defined for the given rules.
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

    def outcomes(self, name: str, part: str, context: str) -> OutcomeCounts:
        """Return what grasps of an object by a part, for an action, came to."""
        return self.experience.of(name, part, context) if self.experience else NO_TRIALS

    def rules_at(self, keys: Iterable[str]) -> list[Rule]:
        """Return the active rules that are stored under some keys, as "pass.forbidden"."""
        self._refresh()
        return [rule for key in keys for rule in self._rules_at(key)]

    def _node_context(self, node: str, goal: Goal) -> NodeRules:
        self._refresh()
        return NodeRules(node, goal, self._rules_at, self._taxonomy)

    def _refresh(self) -> None:
        sequence = self.source.sequence
        if sequence != self._sequence:
            self._rules.clear()
            self._taxonomy = self._declared.with_rules(self.source.rules_at_nodes([KIND_OF]))
            self._sequence = sequence

    def _rules_at(self, key: str) -> Sequence[Rule]:
        if key not in self._rules:
            self._rules[key] = tuple(self.source.rules_at_nodes([key]))
        return self._rules[key]

    def _object_candidate(
        self, here: NodeRules, seen: Observation, decision: DecisionRule
    ) -> Candidate:
        target = here.goal.target
        shown = implied_atoms(seen.atoms, self._taxonomy)
        steps = [_evidence(atom, here, seen, shown) for atom in here.named_features]
        argument, applied = None, ObjectRules()
        for conclusion, is_negated in target.wanted:
            argument = conclusion.argument
            applied = here.concluding(conclusion, seen, shown)
            proof = self._conclude(applied.rules, here, seen, shown)
            operators = self.settings.operators
            steps.append(derive("not", [proof], operators) if is_negated else proof)
        if target.is_confirmed:
            steps = [Proof("given", CERTAIN, f"{seen.name} was confirmed by the speaker")]
        return decision.candidate(seen, argument, steps, applied)

    def _argument_candidates(
        self, here: NodeRules, seen: Observation, decision: DecisionRule
    ) -> Iterator[Candidate]:
        shown = implied_atoms(seen.atoms, self._taxonomy)
        for applied in here.binding(seen, shown).by_argument():
            proof = self._conclude(applied.rules, here, seen, shown)
            argument = applied.rules[0].argument
            counts = NO_TRIALS
            if here.action == GRASP_OBJECT and argument is not None:
                counts = self.outcomes(seen.object, argument.name, acting_for(here.node))
            known = counts if counts.outcomes else None
            yield decision.candidate(seen, argument, [proof], applied, experience=known)

    def _absent_candidates(
        self, here: NodeRules, observations: Sequence[Observation], decision: DecisionRule
    ) -> Iterator[Candidate]:
        shown = [implied_atoms(seen.atoms, self._taxonomy) for seen in observations]
        for conclusion, is_negated in here.goal.target.wanted:
            groups: dict[str, list[Rule]] = defaultdict(list)
            wanted = conclusion.argument
            for rule in chain.from_iterable(map(here.rules, here.keys_of(conclusion))):
                in_view = any(features_of(rule) <= each.keys() for each in shown)
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
        if not rules:
            return Proof("unknown", VACUOUS, f"nothing was told of {seen.name}")
        operators = self.settings.operators
        concluded: list[Proof] = []
        for group in self._fusion_groups(rules):
            antecedent = sorted(_evidence_atoms(group[0]))
            known = [_evidence(atom, here, seen, shown) for atom in antecedent]
            premise = derive("and", known, operators)
            told = [Proof("told", each.support, rule=each) for each in group]
            rule = derive("fuse", told, operators)
            concluded.append(derive("modus ponens", (premise, rule), operators))
        return derive("fuse", concluded, operators)

    def _fusion_groups(self, rules: Sequence[Rule]) -> Iterable[Sequence[Rule]]:
        in_time = sorted(rules, key=lambda rule: (rule.utterance or 0, rule.id))
        if self.settings.stage == "conclusions":
            return [[rule] for rule in in_time]
        groups: dict[frozenset[Atom], list[Rule]] = defaultdict(list)
        for rule in in_time:
            groups[_evidence_atoms(rule)].append(rule)
        return sorted(groups.values(), key=lambda group: group[-1].utterance or 0)


def _evidence_atoms(rule: Rule) -> frozenset[Atom]:
    """Return the antecedent without the material: rules for another material never get here."""
    return frozenset(a for a in features_of(rule) | rule.contexts if a.kind != "material")


def _evidence(atom: Atom, here: NodeRules, seen: Observation, shown: ImpliedAtoms) -> Proof:
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
