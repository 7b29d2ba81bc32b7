"""Explanations of decisions: proofs, reasons for rejection, and counterfactuals.

They consist of the proofs of the decision itself; evaluating these again gives the same numbers.
"""

from bisect import bisect_left
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..kb.interval import CERTAIN, Interval
from ..ontology.confidence import distance
from .affordance import DecisionRule
from .proof import Json, Proof
from .settings import Settings
from .types import Candidate, Inference, Verdict

HALVINGS = 40  # bisections of a path segment: to a precision of 1e-12
SEGMENTS = 64  # of a path that are searched

_SPOKEN: Mapping[Verdict, str] = {
    "accepted": "I am sure enough of it",
    "denied": "what I know speaks against it",
    "unsure": "I am not sure enough of it",
    "unknown": "nobody has told me so",
    "absent": "I don't see it",
}


@dataclass(frozen=True)
class Counterfactual:
    """A change of one leaf's interval, after which another object or part, or None, is `chosen`."""

    evidence: Proof
    after: Interval
    chosen: str | None

    @property
    def size(self) -> float:
        """The size of the change: the sum of the changes of both bounds."""
        return distance(self.evidence.interval, self.after)

    def as_json(self) -> Json:
        """Return the JSON object that `hilt explain --json` prints."""
        return {
            "about": self.evidence.about,
            "before": [self.evidence.interval.lower, self.evidence.interval.upper],
            "after": [self.after.lower, self.after.upper],
            "chosen": self.chosen,
        }


def rejection_reason(inference: Inference, candidate: Candidate) -> str:
    """Return why a candidate was not chosen, or why it was, as the end of a spoken sentence."""
    best = inference.best
    if not candidate.accepted or best is None or candidate is best:
        return _SPOKEN[candidate.verdict]
    if candidate in inference.ties:
        return f"the {best.name} is as good, and I saw it first"
    return f"I am surer of the {best.name}"


def counterfactuals(inference: Inference, settings: Settings) -> list[Counterfactual]:
    """Return the smallest changes of a single interval that change the decision, smallest first.

    There are two shortest paths by which an interval can increase: raise the lower bound first,
    and the upper one with it where they meet; or raise the upper bound first, then the lower one.
    There are two likewise by which it can decrease. With the default operators, whether a candidate
    is chosen is a linear condition on the bounds of each leaf, so the smallest change
    |Δlower| + |Δupper| lies on one of these four paths: at most one in each direction for each leaf
    of the proofs. `settings` are those of the decision.
    """
    search = _CounterfactualSearch(inference, settings)
    leaves = dict.fromkeys(leaf for each in search.candidates for leaf in each.proof.leaves)
    found = [change for leaf in leaves for change in search.smallest_changes(leaf)]
    return sorted(found, key=lambda change: change.size)


class _CounterfactualSearch:
    def __init__(self, inference: Inference, settings: Settings) -> None:
        self.candidates = (*inference.candidates, *inference.absent)
        self.leaves = [frozenset(each.proof.leaves) for each in self.candidates]
        self.operators = settings.operators
        self.decision = DecisionRule(inference.node, inference.threshold, settings.operators)
        self.intervals = [each.interval for each in self.candidates]
        self.decided = self.decision.best_index(self.intervals)

    def smallest_changes(self, leaf: Proof) -> Iterator[Counterfactual]:
        about = [i for i, leaves in enumerate(self.leaves) if leaf in leaves]
        now, false = leaf.interval, Interval(0.0, 0.0)
        low, high = now.lower, now.upper
        increasing = (now, Interval(high, high), CERTAIN), (now, Interval(low, 1.0), CERTAIN)
        decreasing = (now, Interval(low, low), false), (now, Interval(0.0, high), false)
        for paths in (increasing, decreasing):
            changes = [each for path in paths if (each := self._turning_point(leaf, path, about))]
            yield from sorted(changes, key=lambda change: change.size)[:1]

    def _turning_point(
        self, leaf: Proof, path: Sequence[Interval], about: Sequence[int]
    ) -> Counterfactual | None:
        def is_changed(share: float) -> bool:
            return self._chosen(leaf, _along(path, share), about) != self.decided

        segment = next((n for n in range(SEGMENTS) if is_changed((n + 1) / SEGMENTS)), None)
        if segment is None:
            return None
        start, end = segment << HALVINGS, (segment + 1) << HALVINGS
        whole = SEGMENTS << HALVINGS
        place = bisect_left(range(end), True, start, key=lambda n: is_changed(n / whole))
        instead = _along(path, place / whole)
        index = self._chosen(leaf, instead, about)
        chosen = None if index is None else self.candidates[index]
        return Counterfactual(leaf, instead, chosen and (chosen.part or chosen.name))

    def _chosen(self, leaf: Proof, instead: Interval, about: Sequence[int]) -> int | None:
        intervals = list(self.intervals)
        for index in about:
            proof = self.candidates[index].proof
            intervals[index] = proof.evaluate(self.operators, {leaf: instead})
        return self.decision.best_index(intervals)


def _along(path: Sequence[Interval], share: float) -> Interval:
    left = share * sum(distance(*pair) for pair in pairwise(path))
    for start, end in pairwise(path):
        if left < (length := distance(start, end)):
            part = left / length
            lower = start.lower + part * (end.lower - start.lower)
            upper = start.upper + part * (end.upper - start.upper)
            return Interval(min(lower, upper), upper)
        left -= length
    return path[-1]
