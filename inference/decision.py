# SPDX-License-Identifier: Apache-2.0
"""Which conclusions are sure enough to act on, and which of them is the best."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

from ..kb.interval import Interval
from ..kb.rule import Atom, Rule
from .evidence import EPSILON, Operators, certainty
from .proof import LEAVES, Proof, derived
from .types import Candidate, Inference, Observation, Verdict

_REASONS: Mapping[Verdict, str] = {
    "accepted": "{0} is sure enough: lambda {1:.4g} is above {2:.4g}",
    "denied": "{0} speaks against it",
    "unsure": "{0} is not sure enough: lambda {1:.4g} is not above {2:.4g}",
    "unknown": "nothing that was told says so",
    "absent": "it is not in view",
}


@dataclass(frozen=True)
class Applicable:
    """Rules that apply to a thing.

    Attributes:
        rules: the nearest ones.
        distance: how many steps up they were found: 0 for this very kind of thing.
        overruled: those found further up.
    """

    rules: tuple[Rule, ...] = ()
    distance: int = 0
    overruled: tuple[Rule, ...] = ()


@dataclass(frozen=True)
class Judge:
    """Decides at one node.

    Attributes:
        node: the path of the node.
        threshold: Λ there.
        operators: those of the settings.
    """

    node: str
    threshold: float
    operators: Operators

    def candidate(
        self,
        seen: Observation,
        argument: Atom | None,
        steps: Sequence[Proof],
        applied: Applicable,
        *,
        is_absent: bool = False,
    ) -> Candidate:
        """What all steps together come to for one thing."""
        proof = derived("and", steps, self.operators)
        if argument is not None and proof.step not in LEAVES:
            # Of a use or a part the functor is plain: usedFor, graspObject.
            is_plain = argument.kind in {"affordance", "part"}
            functors = {rule.functor for rule in applied.rules}
            of = argument if is_plain or len(functors) != 1 else f"{functors.pop()}({argument})"
            proof = replace(proof, label=f"{seen.name} affords {of}")
        sure = certainty(proof.interval)
        is_unknown = any(step.step == "unknown" for step in steps)
        verdict: Verdict = "absent" if is_absent else self.verdict(proof.interval, is_unknown)
        reason = _REASONS[verdict].format(proof.interval, sure, self.threshold)
        if applied.distance:
            reason += f"; inherited, {_steps(applied.distance)} up"
        if applied.overruled:
            reason += "; a nearer rule goes before " + ", ".join(map(repr, applied.overruled))
        return Candidate(
            seen.name,
            seen.object,
            argument,
            proof,
            sure,
            verdict,
            reason,
            applied.distance,
            applied.overruled,
        )

    def verdict(self, interval: Interval, is_unknown: bool) -> Verdict:
        """Whether to act on a conclusion, to avoid it, or neither."""
        if is_unknown:
            return "unknown"
        if self.operators.accepts(interval, self.threshold):
            return "accepted"
        return "denied" if self.operators.denies(interval, self.threshold) else "unsure"

    def first(self, intervals: Sequence[Interval]) -> int | None:
        """The index of the first of the best intervals that are sure enough; None of none."""
        accepts = self.operators.accepts
        sure = [i for i, each in enumerate(intervals) if accepts(each, self.threshold)]
        if not sure:
            return None
        best = max(self.operators.rank(intervals[i]) for i in sure)
        return next(i for i in sure if self.operators.rank(intervals[i]) > best - EPSILON)

    def ranked(self, found: Sequence[Candidate], absent: Sequence[Candidate] = ()) -> Inference:
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
        return Inference(self.node, self.threshold, tuple(ordered), ties, tuple(absent))


def _steps(distance: int) -> str:
    return f"{distance} step{'s' if distance > 1 else ''}"
