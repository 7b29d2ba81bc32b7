"""The decision at a node: which candidates are certain enough to act on, and which is best."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

from ..kb.interval import EPSILON, Interval
from ..kb.rule import Atom, Rule
from .experience import OutcomeCounts
from .interval_operators import Operators, certainty
from .proof import LEAVES, Proof, derive
from .types import Candidate, Inference, Observation, Verdict

_REASONS: Mapping[Verdict, str] = {
    "accepted": "{0} is sure enough: lambda {1:.4g} is above {2:.4g}",
    "denied": "{0} speaks against it",
    "unsure": "{0} is not sure enough: lambda {1:.4g} is not above {2:.4g}",
    "unknown": "nothing that was told says so",
    "absent": "it is not in view",
}


@dataclass(frozen=True)
class ObjectRules:
    """The most specific rules that apply to an object.

    `overrides` are pairs of one of these and a rule that it overrides; `distances` maps the
    features of a rule to their distance in the is-a hierarchy.
    """

    rules: tuple[Rule, ...] = ()
    overrides: tuple[tuple[Rule, Rule], ...] = ()
    distances: Mapping[frozenset[Atom], int] = field(default_factory=dict[frozenset[Atom], int])

    @property
    def distance(self) -> int:
        """The distance of the nearest rule: 0 for a rule about exactly this kind."""
        return min((self.distances.get(rule.features, 0) for rule in self.rules), default=0)

    @property
    def overruled(self) -> tuple[Rule, ...]:
        """The rules that more specific ones override."""
        return tuple(dict.fromkeys(general for _, general in self.overrides))

    def by_argument(self) -> Iterator[ObjectRules]:
        """Yield the rules about each argument."""
        groups: dict[Atom | None, list[Rule]] = defaultdict(list)
        for rule in self.rules:
            groups[rule.argument].append(rule)
        for argument, rules in groups.items():
            pairs = (pair for pair in self.overrides if pair[0].argument == argument)
            yield ObjectRules(tuple(rules), tuple(pairs), self.distances)


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
        experience: OutcomeCounts | None = None,
    ) -> Candidate:
        """Return a candidate: the conjunction of steps, discounted by experience, and a verdict."""
        proof = derive("and", steps, self.operators)
        if experience:
            seen_before = Proof("experienced", experience.interval, str(experience))
            proof = derive("discount", (proof, seen_before), self.operators)
        proof = replace(proof, overruled=applied.overruled)
        if argument is not None and proof.step not in LEAVES:
            # Affordances and parts imply their functor: usedFor, graspObject.
            is_plain = argument.kind in {"affordance", "part"}
            functors = {rule.functor for rule in applied.rules}
            of = argument if is_plain or len(functors) != 1 else f"{functors.pop()}({argument})"
            proof = replace(proof, label=f"{seen.name} affords {of}")
        sure = certainty(proof.interval)
        is_unknown = any(step.step == "unknown" for step in steps)
        verdict: Verdict = "absent" if is_absent else self._verdict(proof.interval, is_unknown)
        reason = _REASONS[verdict].format(proof.interval, sure, self.threshold)
        inherited, overruled = applied.distance, applied.overruled
        if inherited:
            reason += f"; inherited, {inherited} step{'s' if inherited > 1 else ''} up"
        if overruled:
            reason += "; more specific than " + ", ".join(map(repr, overruled))
        found = (seen.name, seen.object, argument, proof, sure, verdict, reason)
        return Candidate(*found, inherited, overruled, experience)

    def _verdict(self, interval: Interval, is_unknown: bool) -> Verdict:
        if is_unknown:
            return "unknown"
        if self.operators.accepts(interval, self.threshold):
            return "accepted"
        return "denied" if self.operators.denies(interval, self.threshold) else "unsure"

    def best_index(self, intervals: Sequence[Interval]) -> int | None:
        """Return the index of the first of the best accepted intervals; None if there are none."""
        accepts = self.operators.accepts
        sure = [i for i, each in enumerate(intervals) if accepts(each, self.threshold)]
        if not sure:
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
