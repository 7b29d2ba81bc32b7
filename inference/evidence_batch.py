# SPDX-License-Identifier: Apache-2.0
"""The evidence operators over many intervals at once, with NumPy.

An array of intervals has shape (..., 2): lower and upper bound, in [0, 1]. Each function gives what
its namesake in `evidence` gives for every row, to 1e-12; the docstrings there say where the
formulas come from. Work is linear in the number of rows, and so is memory.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

import numpy as np
from numpy.typing import NDArray

from .evidence import EPSILON

Array = NDArray[np.float64]
Flags = NDArray[np.bool_]
Groups = NDArray[np.intp]


def conjunction(intervals: Array) -> Array:
    """AND along the last but one axis: (..., k, 2) -> (..., 2)."""
    return np.prod(intervals, axis=-2)


def conjunction_frechet(intervals: Array) -> Array:
    """AND whatever the dependence: (..., k, 2) -> (..., 2)."""
    lower = intervals[..., 0].sum(axis=-1) - (intervals.shape[-2] - 1)
    return _pairs(np.maximum(lower, 0.0), intervals[..., 1].min(axis=-1))


def conjunction_min(intervals: Array) -> Array:
    """AND where one implies the other: (..., k, 2) -> (..., 2)."""
    return intervals.min(axis=-2)


def disjunction(intervals: Array) -> Array:
    """OR along the last but one axis: (..., k, 2) -> (..., 2)."""
    return negation(conjunction(negation(intervals)))


def negation(intervals: Array) -> Array:
    """NOT: (..., 2) -> (..., 2)."""
    return 1.0 - intervals[..., ::-1]


def modus_ponens(antecedents: Array, rules: Array) -> Array:
    """Conclude by the conditional reading: (..., 2), (..., 2) -> (..., 2)."""
    a = antecedents[..., 0]
    return _pairs(a * rules[..., 0], 1.0 - a * (1.0 - rules[..., 1]))


def modus_ponens_published(antecedents: Array, rules: Array) -> Array:
    """Conclude [a·α, β]: (..., 2), (..., 2) -> (..., 2)."""
    return _pairs(antecedents[..., 0] * rules[..., 0], rules[..., 1] + 0.0 * antecedents[..., 0])


def modus_ponens_material(antecedents: Array, rules: Array) -> Array:
    """Conclude by the material implication: (..., 2), (..., 2) -> (..., 2)."""
    upper = 1.0 - antecedents[..., 1] * (1.0 - rules[..., 1])
    return _pairs(antecedents[..., 0] * rules[..., 0], upper)


def fuse_yager(intervals: Array, starts: Groups) -> Array:
    """Fuse runs of rows by Yager's rule: (n, 2), (g,) -> (g, 2).

    Args:
        intervals: rows, those of one conclusion next to each other.
        starts: index of the first row of each conclusion, increasing, the first 0.
    """
    true, false, either = _commonalities(intervals, starts)
    return _pairs(true - either, 1.0 - false + either)


def fuse_dempster(intervals: Array, starts: Groups) -> Array:
    """Fuse runs of rows by Dempster's rule: (n, 2), (g,) -> (g, 2); NaN at full conflict."""
    true, false, either = _commonalities(intervals, starts)
    agreement = true + false - either
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(agreement > 0, 1.0 / agreement, np.nan)
    return _pairs((true - either) * share, true * share)


def fuse_cautious(intervals: Array, starts: Groups) -> Array:
    """Fuse runs of rows by the cautious rule: (n, 2), (g,) -> (g, 2); NaN where lower = upper."""
    lower, upper = intervals[:, 0], intervals[:, 1]
    width = np.where(upper > lower, upper - lower, np.nan)
    with np.errstate(divide="ignore", invalid="ignore"):
        true, false = width / upper, width / (1.0 - lower)
    weights = np.minimum.reduceat(true, starts), np.minimum.reduceat(false, starts)
    ones, zeros = np.ones(len(starts)), np.zeros(len(starts))
    sources = (_pairs(1.0 - weights[0], ones), _pairs(zeros, weights[1]))
    return fuse_dempster(np.stack(sources, axis=1).reshape(-1, 2), np.arange(len(starts)) * 2)


def fuse_mean(intervals: Array, starts: Groups) -> Array:
    """Fuse runs of rows by the average of their bounds: (n, 2), (g,) -> (g, 2)."""
    counts = np.diff(np.append(starts, len(intervals)))
    return np.add.reduceat(intervals, starts, axis=0) / counts[:, None]


def fuse_latest(intervals: Array, starts: Groups) -> Array:
    """The last row of each run: (n, 2), (g,) -> (g, 2)."""
    return intervals[np.append(starts[1:], len(intervals)) - 1]


def relative_plausibility(intervals: Array) -> Array:
    """PlP, in [0, 1]: (..., 2) -> (...)."""
    return intervals[..., 1] / (1.0 + intervals[..., 1] - intervals[..., 0])


def belief(intervals: Array) -> Array:
    """The lower bound: (..., 2) -> (...)."""
    return intervals[..., 0]


def pignistic(intervals: Array) -> Array:
    """The middle, in [0, 1]: (..., 2) -> (...)."""
    return intervals.sum(axis=-1) / 2.0


def certainty(intervals: Array) -> Array:
    """The measure lambda, in [0, 1]: (..., 2) -> (...)."""
    share = relative_plausibility(intervals)
    return np.maximum(0.0, 1.0 + _entropy_term(share) + _entropy_term(1.0 - share))


def is_affirmed(intervals: Array, threshold: float) -> Flags:
    """Which to act on: (..., 2) -> (...)."""
    rather_true = intervals.sum(axis=-1) > 1.0 + EPSILON
    return rather_true & (certainty(intervals) > threshold)


def is_certain(intervals: Array, threshold: float) -> Flags:
    """Where lambda alone is above the threshold: (..., 2) -> (...)."""
    return certainty(intervals) > threshold


def _commonalities(intervals: Array, starts: Groups) -> tuple[Array, Array, Array]:
    lower, upper = intervals[:, 0], intervals[:, 1]
    return (
        np.multiply.reduceat(upper, starts),
        np.multiply.reduceat(1.0 - lower, starts),
        np.multiply.reduceat(upper - lower, starts),
    )


def _entropy_term(share: Array) -> Array:
    logarithms = np.zeros_like(share)
    np.log2(share, out=logarithms, where=share > 0)
    return share * logarithms


def _pairs(lower: Array, upper: Array) -> Array:
    pairs = np.empty((*np.broadcast_shapes(lower.shape, upper.shape), 2))
    pairs[..., 0], pairs[..., 1] = lower, upper
    return np.clip(pairs, 0.0, 1.0, out=pairs)


CONJUNCTIONS: Mapping[str, Callable[[Array], Array]] = MappingProxyType(
    {"product": conjunction, "frechet": conjunction_frechet, "min": conjunction_min}
)
MODUS_PONENS: Mapping[str, Callable[[Array, Array], Array]] = MappingProxyType(
    {
        "conditional": modus_ponens,
        "published": modus_ponens_published,
        "material": modus_ponens_material,
    }
)
FUSIONS: Mapping[str, Callable[[Array, Groups], Array]] = MappingProxyType(
    {
        "yager": fuse_yager,
        "dempster": fuse_dempster,
        "cautious": fuse_cautious,
        "mean": fuse_mean,
        "latest": fuse_latest,
    }
)
RANKINGS: Mapping[str, Callable[[Array], Array]] = MappingProxyType(
    {
        "plausibility": relative_plausibility,
        "belief": belief,
        "pignistic": pignistic,
        "lambda": certainty,
    }
)
ACCEPTANCES: Mapping[str, Callable[[Array, float], Flags]] = MappingProxyType(
    {"directed": is_affirmed, "lambda": is_certain}
)
