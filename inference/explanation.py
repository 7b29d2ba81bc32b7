# SPDX-License-Identifier: Apache-2.0
"""Why, why not, and what would change your mind.

An explanation is made of the decision's own proofs, never of a story told afterwards: what it
prints is what was worked out, and working it out again gives the same numbers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from ..kb.interval import Interval
from ..ontology.errors import UnknownNameError
from .affordance import Judge, Settings
from .goal import Candidate, Inference
from .proof import Json, Proof

HALVINGS = 40  # of a bound, when the turning point is searched: to 1e-12


@dataclass(frozen=True)
class Change:
    """A change of one interval that turns a decision.

    Attributes:
        evidence: the leaf of the proof that would be different.
        after: what it would have to be.
        chosen: the name that would be chosen then; None when nothing would be.
    """

    evidence: Proof
    after: Interval
    chosen: str | None

    @property
    def size(self) -> float:
        """How far the bounds move together."""
        before = self.evidence.interval
        return abs(before.lower - self.after.lower) + abs(before.upper - self.after.upper)

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
    candidate, best = found[0], inference.best
    reason = candidate.reason
    if candidate.accepted and best is not None and candidate is not best:
        equal = (
            "it is as good, and comes after"
            if candidate in inference.ties
            else "it is less sure than"
        )
        reason = f"{candidate.interval}: {equal} {best.name} {best.interval}"
    return "\n".join((reason, *candidate.proof.lines()))


def names_of(candidate: Candidate) -> tuple[str, ...]:
    """By which names a candidate is asked for: the thing, its class, and its argument."""
    argument = (candidate.argument.name,) if candidate.argument else ()
    return tuple(dict.fromkeys((candidate.name, candidate.object, *argument)))


def changes_of_mind(inference: Inference, settings: Settings) -> list[Change]:
    """The smallest change of each interval alone that turns the decision, the smallest first.

    Args:
        inference: the decision.
        settings: those it was made with.
    """
    leaves = dict.fromkeys(leaf for each in inference.candidates for leaf in each.proof.leaves)
    found = (change for leaf in leaves for change in _turning(inference, settings, leaf))
    return sorted(found, key=lambda change: change.size)


def _turning(inference: Inference, settings: Settings, leaf: Proof) -> Iterator[Change]:
    """The nearest values of each bound of one leaf at which the decision is another."""
    now = leaf.interval
    decided = _decided(inference, settings, leaf, now)
    for end in (Interval(0.0, now.upper), Interval(now.upper, now.upper)):
        yield from _nearest(inference, settings, leaf, end, decided)
    for end in (Interval(now.lower, now.lower), Interval(now.lower, 1.0)):
        yield from _nearest(inference, settings, leaf, end, decided)


def _nearest(
    inference: Inference, settings: Settings, leaf: Proof, end: Interval, decided: int | None
) -> Iterator[Change]:
    """Halve the way from here to `end`, at which the decision is another, to the turning point."""
    now = leaf.interval
    if end == now or _decided(inference, settings, leaf, end) == decided:
        return
    same, other = 0.0, 1.0
    for _ in range(HALVINGS):
        middle = (same + other) / 2
        if _decided(inference, settings, leaf, _between(now, end, middle)) == decided:
            same = middle
        else:
            other = middle
    after = _between(now, end, other)
    index = _decided(inference, settings, leaf, after)
    yield Change(leaf, after, None if index is None else inference.candidates[index].name)


def _between(start: Interval, end: Interval, share: float) -> Interval:
    lower = start.lower + share * (end.lower - start.lower)
    upper = start.upper + share * (end.upper - start.upper)
    return Interval(min(lower, upper), upper)


def _decided(
    inference: Inference, settings: Settings, leaf: Proof, instead: Interval
) -> int | None:
    """Which candidate would be chosen, by its index, if one leaf were another; None for none."""
    judge = Judge(inference.node, settings)
    candidates: Sequence[Candidate] = inference.candidates
    intervals = [each.proof.evaluate(settings.operators, {leaf: instead}) for each in candidates]
    return judge.first(intervals)
