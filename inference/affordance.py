"""Affordance inference at the nodes of an action tree: getFeatures and getAffordance.

Paper, section 3.3. `Affordances.features` selects the rules of a node and returns the perceptual
invariants that vision has to look for. `Affordances.infer` takes the observations and concludes
what each object affords: AND over the antecedents, modus ponens with the rule's interval, fusion of
equal conclusions, and lambda against the threshold of the context (section 2).

Rules with the same antecedent are fused before modus ponens: the antecedent is one piece of
evidence and would otherwise be counted once for each rule. `NodeRules` selects the rules of one
node for one goal; more specific rules override general ones (`node_rules`).
"""

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from typing import Protocol

from ..kb.interval import CERTAIN, EPSILON, VACUOUS, Interval
from ..kb.rule import GRASP_OBJECT, KIND_OF, Atom, Rule
from .experience import NO_TRIALS, Experience, OutcomeCounts
from .interval_operators import Operators, certainty
from .node_rules import FIND, NodeRules, ObjectRules, acting_for, features_of
from .proof import LEAVES, Proof, derive
from .settings import Settings
from .taxonomy import FLAT, ImpliedAtoms, Taxonomy
from .types import Candidate, Goal, Inference, Observation, Verdict

PERCEIVED = ("object", "part", "property")  # kinds of atoms that vision reports
_REASONS: Mapping[Verdict, str] = {
    "accepted": "{0} is sure enough: lambda {1:.4g} is above {2:.4g}",
    "denied": "{0} speaks against it",
    "unsure": "{0} is not sure enough: lambda {1:.4g} is not above {2:.4g}",
    "unknown": "nothing that was told says so",
    "absent": "it is not in view",
}


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
        atoms = self._node_context(node, goal).features
        return tuple(sorted(kind for atom in atoms for kind in self._taxonomy.below(atom)))

    def infer(self, node: str, goal: Goal, observations: Sequence[Observation]) -> Inference:
        """Infer what the observed objects afford at a node (getAffordance).

        Observations are in the order of the scene, which breaks ties. The candidates are sorted,
        best first: at the find node one for each observation, at any other node one for each object
        and each part (or other argument) that a rule names. ConflictError if the chosen operators
        are not defined for the given rules.
        """
        here = self._node_context(node, goal)
        threshold = self.settings.threshold_of((each.name for each in here.contexts), here.given)
        decision = DecisionRule(node, threshold, self.settings.operators)
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
        if (sequence := self.source.sequence) != self._sequence:
            self._rules.clear()
            self._taxonomy = self._declared.with_rules(self.source.rules_at_nodes([KIND_OF]))
            self._sequence = sequence

    def _rules_at(self, key: str) -> Sequence[Rule]:
        if key not in self._rules:
            self._rules[key] = tuple(self.source.rules_at_nodes([key]))
        return self._rules[key]

    def _object_candidate(
        self, here: NodeRules, seen: Observation, decision: "DecisionRule"
    ) -> Candidate:
        target = here.goal.target
        shown = self._taxonomy.implied(seen.atoms)
        steps = [_evidence(atom, here, seen, shown) for atom in here.named_features]
        argument, applied = None, ObjectRules()
        for conclusion, is_negated in target.wanted:
            argument = conclusion.argument
            applied = here.concluding(conclusion, seen, shown)
            proof = self._conclude(applied.rules, here, seen, shown)
            steps.append(derive("not", [proof], self.settings.operators) if is_negated else proof)
        if target.is_confirmed:
            steps = [Proof("given", CERTAIN, f"{seen.name} was confirmed by the speaker")]
        return decision.candidate(seen, argument, steps, applied)

    def _argument_candidates(
        self, here: NodeRules, seen: Observation, decision: "DecisionRule"
    ) -> Iterator[Candidate]:
        shown = self._taxonomy.implied(seen.atoms)
        for argument, applied in here.binding(seen, shown).by_argument().items():
            steps = [self._conclude(applied.rules, here, seen, shown)]
            known = NO_TRIALS
            if here.action == GRASP_OBJECT and argument is not None:
                known = self.outcomes(seen.object, argument.name, acting_for(here.node))
            yield decision.candidate(seen, argument, steps, applied, experience=known)

    def _absent_candidates(
        self, here: NodeRules, observations: Sequence[Observation], decision: "DecisionRule"
    ) -> Iterator[Candidate]:
        shown = [self._taxonomy.implied(seen.atoms) for seen in observations]
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
        operators, by_rule = self.settings.operators, self.settings.stage == "conclusions"
        groups: dict[tuple[str, frozenset[Atom]], list[Rule]] = defaultdict(list)
        for rule in sorted(rules, key=lambda rule: (rule.utterance or 0, rule.id)):
            # Without the material: rules for another one never get here.
            atoms = (a for a in features_of(rule) | rule.contexts if a.kind != "material")
            groups[rule.id if by_rule else "", frozenset(atoms)].append(rule)
        concluded = list[Proof]()
        by_last_rule = sorted(groups.items(), key=lambda one: one[1][-1].utterance or 0)
        for (_, antecedent), group in by_last_rule:
            known = [_evidence(atom, here, seen, shown) for atom in sorted(antecedent)]
            told = [Proof("told", each.support, rule=each) for each in group]
            steps = (derive("and", known, operators), derive("fuse", told, operators))
            concluded.append(derive("modus ponens", steps, operators))
        return derive("fuse", concluded, operators)


@dataclass(frozen=True)
class DecisionRule:
    """Accepts and ranks the candidates of the node at a path, whose threshold is Λ."""

    node: str
    threshold: float
    operators: Operators

    def candidate(
        self,
        seen: Observation,
        argument: Atom | None,
        steps: Sequence[Proof],
        applied: ObjectRules,
        *,
        is_absent: bool = False,
        experience: OutcomeCounts = NO_TRIALS,
    ) -> Candidate:
        """Return a candidate: the conjunction of steps, discounted by experience, and a verdict."""
        inherited, overruled = applied.distance, applied.overruled
        proof = derive("and", steps, self.operators)
        known = experience if experience.outcomes else None
        if known:
            before = Proof("experienced", known.interval, str(known))
            proof = derive("discount", (proof, before), self.operators)
        proof = replace(proof, overruled=overruled)
        if argument is not None and proof.step not in LEAVES:
            # Affordances and parts imply their functor: usedFor, graspObject.
            is_plain = argument.kind in {"affordance", "part"}
            functors = {rule.functor for rule in applied.rules}
            of = argument if is_plain or len(functors) != 1 else f"{functors.pop()}({argument})"
            proof = replace(proof, label=f"{seen.name} affords {of}")
        sure, verdict = certainty(proof.interval), self._verdict(proof.interval)
        if is_absent or any(step.step == "unknown" for step in steps):
            verdict = "absent" if is_absent else "unknown"
        reason = _REASONS[verdict].format(proof.interval, sure, self.threshold)
        if inherited:
            reason += f"; inherited, {inherited} step{'s' if inherited > 1 else ''} up"
        if overruled:
            reason += "; more specific than " + ", ".join(map(repr, overruled))
        found = (seen.name, seen.object, argument, proof, sure, verdict, reason)
        return Candidate(*found, inherited, overruled, known)

    def _verdict(self, interval: Interval) -> Verdict:
        if self.operators.accepts(interval, self.threshold):
            return "accepted"
        return "denied" if self.operators.denies(interval, self.threshold) else "unsure"

    def best_index(self, intervals: Sequence[Interval]) -> int | None:
        """Return the index of the first of the best accepted intervals; None if there are none."""
        accepts = self.operators.accepts
        if not (sure := [i for i, each in enumerate(intervals) if accepts(each, self.threshold)]):
            return None
        best = max(self.operators.rank(intervals[i]) for i in sure)
        return next(i for i in sure if self.operators.rank(intervals[i]) > best - EPSILON)

    def ranked(self, found: Sequence[Candidate], absent: Sequence[Candidate] = ()) -> Inference:
        """Return all candidates as an inference, best first; equals keep their order."""
        rank = self.operators.rank
        ordered = sorted(found, key=lambda each: (not each.accepted, -rank(each.interval)))
        ties: tuple[Candidate, ...] = ()
        if ordered and ordered[0].accepted:
            best = rank(ordered[0].interval)
            # In scene order: rounding errors must not decide between equal candidates.
            sure = (each for each in found if each.accepted)
            tied = [each for each in sure if rank(each.interval) > best - EPSILON]
            ordered = [tied[0], *(each for each in ordered if each is not tied[0])]
            ties = tuple(tied) if len(tied) > 1 else ()
        return Inference(self.node, self.threshold, tuple(ordered), ties, tuple(absent))


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
