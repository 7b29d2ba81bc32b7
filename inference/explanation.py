# SPDX-License-Identifier: Apache-2.0
"""Why, why not, and what would change your mind.

An explanation is made of the decision's own proofs, never of a story told afterwards: what it
prints is what was worked out, and working it out again gives the same numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..kb.interval import Interval
from ..ontology.errors import UnknownNameError
from .decision import Judge
from .proof import Json, Proof
from .settings import Settings
from .types import Candidate, Inference

HALVINGS = 40  # of a stretch of a path, when the turning point is searched: to 1e-12
STRETCHES = 64  # of a path that are looked at


@dataclass(frozen=True)
class Counterfactual:
    """A change of one interval that turns a decision.

    Attributes:
        evidence: the leaf of the proof that would be different.
        after: what it would have to be.
        chosen: the thing or part that would be chosen then; None when nothing would be.
    """

    evidence: Proof
    after: Interval
    chosen: str | None

    @property
    def size(self) -> float:
        """How far the bounds move together."""
        return _distance(self.evidence.interval, self.after)

    def as_json(self) -> Json:
        """As `hilt explain --json` prints it."""
        return {
            "about": self.evidence.about,
            "before": [self.evidence.interval.lower, self.evidence.interval.upper],
            "after": [self.after.lower, self.after.upper],
            "chosen": self.chosen,
        }


def why(inference: Inference) -> str:
    """The proof of the best candidate as indented text; of the first one when none is accepted."""
    if not inference.candidates:
        return "nothing was seen that could be meant"
    return "\n".join(inference.candidates[0].proof.lines())


def why_not(inference: Inference, name: str) -> str:
    """Why a thing (or part) was not chosen, with the proof of what was concluded about it.

    Raises:
        UnknownNameError: nothing was concluded about it.
    """
    found = [each for each in inference.candidates if name in names_of(each)]
    if not found:
        known = sorted({known for each in inference.candidates for known in names_of(each)})
        raise UnknownNameError("candidate", name, known)
    return "\n".join((reason_against(inference, found[0]), *found[0].proof.lines()))


def reason_against(inference: Inference, candidate: Candidate) -> str:
    """Why a candidate is not the one that was chosen; its own reason if it is."""
    best = inference.best
    if not candidate.accepted or best is None or candidate is best:
        return candidate.reason
    is_tied = candidate in inference.ties
    equal = "it is as good, and comes after" if is_tied else "it is less sure than"
    return f"{candidate.interval}: {equal} {best.name} {best.interval}"


def names_of(candidate: Candidate) -> tuple[str, ...]:
    """By which names a candidate is asked for: the thing, its class, and its argument."""
    argument = (candidate.argument.name,) if candidate.argument else ()
    return tuple(dict.fromkeys((candidate.name, candidate.object, *argument)))


def changes_of_mind(inference: Inference, settings: Settings) -> list[Counterfactual]:
    """The smallest changes of one interval alone that turn the decision, the smallest first.

    An interval can grow in truth in two ways that are no detour: its lower bound first, taking the
    upper one along where they meet, or its upper bound first, then the lower one. Likewise it can
    shrink. With the default operators whether a thing is chosen is a linear condition on the two
    bounds of any one leaf, so the smallest change |Δlower| + |Δupper| lies on one of these four.

    Args:
        inference: the decision.
        settings: those it was made with.

    Returns:
        Of each leaf of the proofs the smallest change in each direction that turns the decision.
    """
    mind = _Mind(inference, settings)
    leaves = dict.fromkeys(leaf for each in mind.candidates for leaf in each.proof.leaves)
    found = [change for leaf in leaves for change in mind.turned_by(leaf)]
    return sorted(found, key=lambda change: change.size)


class _Mind:
    """A decision that can be made again with other evidence."""

    def __init__(self, inference: Inference, settings: Settings) -> None:
        self.candidates = (*inference.candidates, *inference.absent)
        self.leaves = [frozenset(each.proof.leaves) for each in self.candidates]
        self.operators = settings.operators
        self.judge = Judge(inference.node, inference.threshold, settings.operators)
        self.intervals = [each.interval for each in self.candidates]
        self.decided = self.judge.first(self.intervals)

    def turned_by(self, leaf: Proof) -> Iterator[Counterfactual]:
        """The smallest change of a leaf upwards, and the smallest downwards, that turn it."""
        about = [i for i, leaves in enumerate(self.leaves) if leaf in leaves]
        for paths in _paths(leaf.interval):
            turned = [each for path in paths if (each := self._turned(leaf, path, about))]
            yield from sorted(turned, key=lambda change: change.size)[:1]

    def _turned(
        self, leaf: Proof, path: Sequence[Interval], about: Sequence[int]
    ) -> Counterfactual | None:
        """The nearest point of a path at which the decision is another."""
        before = 0.0
        for stretch in range(1, STRETCHES + 1):
            after = stretch / STRETCHES
            if self._chosen(leaf, _along(path, after), about) != self.decided:
                break
            before = after
        else:
            return None
        for _ in range(HALVINGS):
            middle = (before + after) / 2
            if self._chosen(leaf, _along(path, middle), about) == self.decided:
                before = middle
            else:
                after = middle
        instead = _along(path, after)
        index = self._chosen(leaf, instead, about)
        return Counterfactual(
            leaf, instead, None if index is None else _called(self.candidates[index])
        )

    def _chosen(self, leaf: Proof, instead: Interval, about: Sequence[int]) -> int | None:
        """Which candidate would be chosen, by its index, if one leaf were another."""
        intervals = list(self.intervals)
        for index in about:
            proof = self.candidates[index].proof
            intervals[index] = proof.evaluate(self.operators, {leaf: instead})
        return self.judge.first(intervals)


def _called(candidate: Candidate) -> str:
    """A candidate by its part, where that is what is decided, else by its name."""
    argument = candidate.argument
    return argument.name if argument and argument.kind == "part" else candidate.name


def _paths(now: Interval) -> tuple[Sequence[Sequence[Interval]], ...]:
    """The corners of the two ways to more truth, and of the two to less."""
    low, high = now.lower, now.upper
    return (
        (
            (now, Interval(high, high), Interval(1.0, 1.0)),
            (now, Interval(low, 1.0), Interval(1.0, 1.0)),
        ),
        (
            (now, Interval(low, low), Interval(0.0, 0.0)),
            (now, Interval(0.0, high), Interval(0.0, 0.0)),
        ),
    )


def _along(path: Sequence[Interval], share: float) -> Interval:
    """The point after a share of a path's length, in [0, 1]."""
    lengths = [_distance(*pair) for pair in pairwise(path)]
    left = share * sum(lengths)
    for (start, end), length in zip(pairwise(path), lengths, strict=True):
        if left <= length and length > 0:
            return _between(start, end, left / length)
        left -= length
    return path[-1]


def _distance(one: Interval, other: Interval) -> float:
    return abs(one.lower - other.lower) + abs(one.upper - other.upper)


def _between(start: Interval, end: Interval, share: float) -> Interval:
    lower = start.lower + share * (end.lower - start.lower)
    upper = start.upper + share * (end.upper - start.upper)
    return Interval(min(lower, upper), upper)
