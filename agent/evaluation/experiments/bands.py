# SPDX-License-Identifier: Apache-2.0
"""Shares with confidence bands, from trials that each asked several questions.

Wilson's score interval (1927) for a share, at the effective number of questions: those of one trial
resemble each other, so many of them count as fewer (Kish, Survey Sampling, 1965: the design effect
is the variance of the trials' shares over that of independent questions).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt

Z = 1.959964  # of a band that holds the true share 95 times in 100


@dataclass(frozen=True)
class Band:
    """A share and where the true one lies, 95 times in 100.

    Attributes:
        share: in [0, 1].
        lower: of the band, in [0, share].
        upper: of the band, in [share, 1].
    """

    share: float
    lower: float
    upper: float


def wilson(successes: float, count: float) -> Band:
    """The share of successes with Wilson's interval.

    >>> wilson(9, 10)
    Band(share=0.9, lower=0.5958499..., upper=0.9821237...)

    Args:
        successes: how many of `count`; need not be whole.
        count: how many there were; above 0.
    """
    share = successes / count
    weight = 1 + Z * Z / count
    middle = (share + Z * Z / (2 * count)) / weight
    half = Z / weight * sqrt(share * (1 - share) / count + Z * Z / (4 * count * count))
    return Band(share, max(0.0, min(middle - half, share)), min(1.0, max(middle + half, share)))


def band_of(successes: Sequence[int], per_trial: int) -> Band:
    """The share of successes over trials, with a band at their effective number.

    Args:
        successes: of each trial, in [0, per_trial]; at least one trial.
        per_trial: questions in each.
    """
    count = len(successes) * per_trial
    share = sum(successes) / count
    effective = count / _design_effect(successes, per_trial, share)
    return wilson(share * effective, effective)


def _design_effect(successes: Sequence[int], per_trial: int, share: float) -> float:
    """How many questions of a trial count as one, in [1, per_trial]."""
    if len(successes) < 2 or share in {0.0, 1.0}:
        return 1.0
    spread = sum((each / per_trial - share) ** 2 for each in successes) / (len(successes) - 1)
    return min(max(spread * per_trial / (share * (1 - share)), 1.0), float(per_trial))
