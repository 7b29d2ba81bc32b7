"""Belief intervals [lower, upper].

An `Interval` bounds the probability of one statement: at least `lower` (its belief), at most
`upper` (its plausibility). [1, 1] is certainty, [0, 1] ignorance; the width is the part of the
probability for which there is no evidence. `hilt.inference` combines intervals.

After Shafer, A Mathematical Theory of Evidence (1976), on the frame {true, false}.
"""

from collections.abc import Iterator
from dataclasses import dataclass

from ..ontology.errors import IntervalError

DIGITS = 6  # fractional digits that are stored: every SPARQL engine keeps that many
EPSILON = 1e-9  # below this two beliefs are equal: the 16 levels of the paper differ by .0016


@dataclass(frozen=True, slots=True, repr=False)
class Interval:
    """Bounds of a probability: 0 <= lower <= upper <= 1.

    Iterates over `lower`, the belief, and `upper`, the plausibility. IntervalError for others.

    >>> often = Interval(0.75, 1)
    >>> print(often, often.width, often.negated())
    [0.75, 1.00] 0.25 [0.00, 0.25]
    """

    lower: float
    upper: float

    def __post_init__(self) -> None:
        try:
            lower, upper = float(self.lower), float(self.upper)
        except (TypeError, ValueError, OverflowError) as error:
            raise IntervalError(self.lower, self.upper) from error
        if not 0.0 <= lower <= upper <= 1.0:
            raise IntervalError(self.lower, self.upper)
        object.__setattr__(self, "lower", lower + 0.0)  # -0.0 + 0.0 is 0.0
        object.__setattr__(self, "upper", upper + 0.0)

    def __iter__(self) -> Iterator[float]:
        return iter((self.lower, self.upper))

    @property
    def width(self) -> float:
        """The ignorance; 0 for a point, 1 for [0, 1]."""
        return self.upper - self.lower

    @property
    def is_vacuous(self) -> bool:
        """Whether this is [0, 1], which says nothing."""
        return self.lower == 0.0 and self.upper == 1.0

    def negated(self) -> "Interval":
        """The interval of the opposite statement."""
        return Interval(1.0 - self.upper, 1.0 - self.lower)

    def discounted(self, trust: float) -> "Interval":
        """Shafer's discounting, for a source reliable with probability `trust` in [0, 1]."""
        if not 0.0 <= trust <= 1.0:
            raise IntervalError(trust, 1)
        if trust == 1.0:
            return self  # exactly: 1 - (1 - b) need not be b in floating point
        return Interval(trust * self.lower, 1.0 - trust * (1.0 - self.upper))

    def conflict(self, other: "Interval") -> float:
        """The mass in [0, 1] of the contradiction to another one, K = a1·(1-b2) + (1-b1)·a2."""
        return self.lower * (1.0 - other.upper) + (1.0 - self.upper) * other.lower

    def rounded(self) -> "Interval":
        """This interval as it is stored, with at most `DIGITS` fractional digits."""
        lower, upper = round(self.lower, DIGITS), round(self.upper, DIGITS)
        return self if (lower, upper) == (self.lower, self.upper) else Interval(lower, upper)

    def __repr__(self) -> str:
        return f"Interval({self.lower!r}, {self.upper!r})"

    def __str__(self) -> str:
        return f"[{self.lower:.2f}, {self.upper:.2f}]"


VACUOUS = Interval(0.0, 1.0)
CERTAIN = Interval(1.0, 1.0)
