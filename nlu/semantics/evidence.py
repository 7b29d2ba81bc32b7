# SPDX-License-Identifier: Apache-2.0
"""How sure a conclusion is, where intervals of belief and plausibility meet.

Just what pragmatic rules need, on the frame {true, false}: modus ponens by conditional embedding,
Yager's rule for several intervals of one conclusion (Yager 1987), and how certain an interval is
(Núñez et al. 2013). Who has a fuller inference hands it in as another `Evidence`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import log2, prod

from .meaning import Confidence


def ponens(premise: Confidence, rule: Confidence) -> Confidence:
    """What a rule concludes from its premise, both as (lower, upper) in [0, 1]."""
    lower = premise[0]
    return lower * rule[0], 1 - lower * (1 - rule[1])


def fused(intervals: Sequence[Confidence]) -> Confidence:
    """Several intervals of one conclusion as one; nothing known for none."""
    true = prod(upper for _, upper in intervals)
    false = prod(1 - lower for lower, _ in intervals)
    either = prod(upper - lower for lower, upper in intervals)
    return true - either, 1 - false + either


def certainty(interval: Confidence) -> float:
    """How certain it is that something is so, in [0, 1]; 0 where it rather is not.

    One minus the entropy of the relative plausibility, for what is more plausible than not.
    """
    lower, upper = interval
    share = upper / (1 + upper - lower)
    if share <= 0.5:
        return 0.0
    return 1 + sum(part * log2(part) for part in (share, 1 - share) if part > 0)


@dataclass(frozen=True)
class Evidence:
    """The three steps of an inference.

    Attributes:
        ponens: (premise, rule) to the conclusion.
        fused: several conclusions to one.
        certainty: how certain it is, in [0, 1].
    """

    ponens: Callable[[Confidence, Confidence], Confidence] = ponens
    fused: Callable[[Sequence[Confidence]], Confidence] = fused
    certainty: Callable[[Confidence], float] = certainty


EVIDENCE = Evidence()
