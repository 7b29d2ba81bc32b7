"""Evidence operators on pairs (lower, upper) = (Bel, Pl) in [0, 1] of one proposition.

A pair (a, b) stands for the Dempster-Shafer masses m(true) = a, m(false) = 1 - b and m(either) =
b - a. Both the inference engine and the pragmatic rules of the language part use these operators.
Factors are multiplied in sorted order, so that no result depends on the order of its arguments.
"""

from collections.abc import Iterable, Sequence
from math import log2, prod

Bounds = tuple[float, float]
Pair = Iterable[float]  # of bounds


def clip(lower: float, upper: float) -> Bounds:
    """Return the pair, with bounds clipped to [0, 1] against rounding errors."""
    lower = min(max(lower, 0.0), 1.0)
    return lower, min(max(upper, lower), 1.0)


def product(factors: Iterable[float]) -> float:
    """Return the product of the factors, multiplied in sorted order."""
    return prod(sorted(factors))


def modus_ponens(antecedent: Pair, rule: Pair) -> Bounds:
    """Conclude by the conditional reading: [a·α, 1 - a·(1-β)].

    Derived by conditional embedding (Smets): the bounds of P(C) over P(A) in [a, b] and P(C|A) in
    [α, β] with P(C|not A) free. A doubtful antecedent never yields more than ignorance.
    """
    (a, _), (lower, upper) = antecedent, rule
    return clip(a * lower, 1 - a * (1 - upper))


def commonalities(intervals: Sequence[Pair]) -> tuple[float, float, float]:
    """Return the products (Π b, Π (1-a), Π (b-a)): compatible with true, with false, with both."""
    return (
        product([upper for _, upper in intervals]),
        product([1 - lower for lower, _ in intervals]),
        product([upper - lower for lower, upper in intervals]),
    )


def fuse_yager(intervals: Sequence[Pair]) -> Bounds:
    """Fuse all sources at once by Yager's rule (1987): conflict becomes ignorance.

    Always defined: [1, 1] with [0, 0] gives [0, 1]. It takes all sources at once because pairwise
    it is not associative, and the result would depend on the order of teaching.
    """
    if len(intervals) == 1:
        lower, upper = intervals[0]
        return lower, upper
    true, false, either = commonalities(intervals)
    return clip(true - either, 1 - false + either)


def relative_plausibility(interval: Pair) -> float:
    """Return PlP = b / (1 + b - a) in [0, 1], the plausibility transform (Cobb & Shenoy 2006)."""
    lower, upper = interval
    return upper / (1 + upper - lower)


def certainty(interval: Pair) -> float:
    """Return the confidence measure lambda of Núñez et al. (2013), in [0, 1].

    lambda = 1 + (b/γ)·log2(b/γ) + ((1-a)/γ)·log2((1-a)/γ) with γ = 1 + b - a, one minus the entropy
    of the plausibility transform. It ignores the direction: [0, 0] is as certain as [1, 1].
    """
    share = relative_plausibility(interval)
    return max(0.0, 1 + _entropy_term(share) + _entropy_term(1 - share))


def _entropy_term(share: float) -> float:
    return share * log2(share) if share > 0 else 0.0
