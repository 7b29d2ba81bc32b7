"""Evidence operators on belief intervals: AND, modus ponens, fusion, and the confidence measure.

An interval [a, b] = [Bel, Pl] stands for the Dempster-Shafer masses m(true) = a, m(false) = 1 - b
and m(either) = b - a of one proposition. The paper (section 2) names the steps: AND over the
antecedents, modus ponens with the rule's interval, fusion of equal conclusions, then the measure
lambda of Nunez et al. (2013) against a threshold; it gives no formulas. Those here are derived;
each docstring names the source. Alternatives are registered by name (`CONJUNCTIONS`,
`MODUS_PONENS`, `FUSIONS`, `RANKINGS`, `ACCEPTANCES`); `Operators` selects one of each.

Factors are multiplied in sorted order, so that no bit of a result depends on the order of teaching.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial

from ..kb.interval import EPSILON, VACUOUS, Interval
from ..ontology import evidence_operators
from ..ontology.errors import ConflictError, UnknownNameError
from ..ontology.evidence_operators import certainty, relative_plausibility

Combination = Callable[[Sequence[Interval]], Interval]


def _bounded(lower: float, upper: float) -> Interval:
    return Interval(*evidence_operators.clip(lower, upper))


def _bounds(fold: Callable[[Iterable[float]], float], intervals: Sequence[Interval]) -> Interval:
    return _bounded(fold(i.lower for i in intervals), fold(i.upper for i in intervals))


def conjunction(intervals: Sequence[Interval]) -> Interval:
    """AND of independent propositions: [a1·a2, b1·b2] (Sarathy & Scheutz 2016; product frame)."""
    return _bounds(evidence_operators.product, intervals)


def conjunction_frechet(intervals: Sequence[Interval]) -> Interval:
    """AND when nothing is known of the dependence: [max(0, Σa - (n-1)), min b] (Fréchet)."""
    total = sum(sorted(i.lower for i in intervals)) - (len(intervals) - 1)
    return _bounded(total, min((i.upper for i in intervals), default=1.0))


def modus_ponens(antecedent: Interval, rule: Interval) -> Interval:
    """Conclude by the conditional reading: [a·α, 1 - a·(1-β)] (`ontology.evidence_operators`)."""
    return Interval(*evidence_operators.modus_ponens(antecedent, rule))


def modus_ponens_published(antecedent: Interval, rule: Interval) -> Interval:
    """Conclude [a·α, β], as Sarathy & Scheutz are recalled to have published it.

    Equal to `modus_ponens` whenever β = 1. With β < 1 an absent antecedent still disbelieves.
    """
    return _bounded(antecedent.lower * rule.lower, rule.upper)


def modus_ponens_material(antecedent: Interval, rule: Interval) -> Interval:
    """Conclude [a·α, 1 - b·(1-β)]: the rule read as the material implication (derived)."""
    return _bounded(antecedent.lower * rule.lower, 1 - antecedent.upper * (1 - rule.upper))


def fuse_yager(intervals: Sequence[Interval]) -> Interval:
    """Fuse by Yager's rule (1987) over all sources at once (`ontology.evidence_operators`)."""
    return Interval(*evidence_operators.fuse_yager(intervals))


def fuse_dempster(intervals: Sequence[Interval]) -> Interval:
    """Fuse by Dempster's rule: conflict is divided out; ConflictError where it is full."""
    if len(intervals) == 1:
        return intervals[0]
    true, false, either = evidence_operators.commonalities(intervals)
    if (agreement := true + false - either) <= 0:
        problem = f"The sources {', '.join(map(str, intervals))} contradict each other fully."
        raise ConflictError(f'{problem} Discount one of them, or fuse by "yager".')
    return _bounded((true - either) / agreement, true / agreement)


def fuse_cautious(intervals: Sequence[Interval]) -> Interval:
    """Fuse sources that may repeat each other by Denœux's cautious rule (2008): idempotent.

    With t = min (b-a)/b and f = min (b-a)/(1-a), the weights of the masses that are not committed
    to true and to false, the result is [f·(1-t), f] / (t + f·(1-t)). No digits cancel in this form,
    so that it is exact up to rounding for intervals of any width. ConflictError if a source is
    certain (a = b), for which the rule is not defined.
    """
    for interval in intervals:
        if interval.upper - interval.lower <= 0:
            raise ConflictError(f"The cautious rule needs lower < upper; {interval} has none.")
    true = min(((i.upper - i.lower) / i.upper for i in intervals), default=1.0)
    false = min(((i.upper - i.lower) / (1 - i.lower) for i in intervals), default=1.0)
    lower = false * (1 - true)
    return _bounded(lower / (true + lower), false / (true + lower))


def fuse_mean(intervals: Sequence[Interval]) -> Interval:
    """Fuse by the average of the bounds; [0, 1] when there is nothing to average."""
    count = len(intervals)
    return _bounds(lambda bounds: sum(sorted(bounds)) / count, intervals) if count else VACUOUS


def is_affirmed(interval: Interval, threshold: float) -> bool:
    """Whether an interval is more true than false and its lambda exceeds the threshold."""
    return interval.lower + interval.upper > 1 + EPSILON and certainty(interval) > threshold


CONJUNCTIONS: Mapping[str, Combination] = {
    "product": conjunction,
    "frechet": conjunction_frechet,
    # When one proposition implies the other: [min a, min b].
    "min": partial(_bounds, partial(min, default=1.0)),
}
MODUS_PONENS: Mapping[str, Callable[[Interval, Interval], Interval]] = {
    "conditional": modus_ponens,
    "published": modus_ponens_published,
    "material": modus_ponens_material,
}
FUSIONS: Mapping[str, Combination] = {
    "yager": fuse_yager,
    "dempster": fuse_dempster,
    "cautious": fuse_cautious,
    "mean": fuse_mean,
    "latest": lambda intervals: intervals[-1] if intervals else VACUOUS,  # the one taught last
}
RANKINGS: Mapping[str, Callable[[Interval], float]] = {
    "plausibility": relative_plausibility,
    "belief": lambda interval: interval.lower,
    "pignistic": lambda interval: (interval.lower + interval.upper) / 2,
    "lambda": certainty,
}
ACCEPTANCES: Mapping[str, Callable[[Interval, float], bool]] = {
    "directed": is_affirmed,
    "lambda": lambda interval, threshold: certainty(interval) > threshold,  # as in the paper
}
_TABLES: Mapping[str, Mapping[str, object]] = {
    "conjunction": CONJUNCTIONS, "modus_ponens": MODUS_PONENS, "fusion": FUSIONS,
    "ranking": RANKINGS, "acceptance": ACCEPTANCES,
}  # fmt: skip


@dataclass(frozen=True)
class Operators:
    """The selected operators, by name; UnknownNameError if there is none of that name."""

    conjunction: str = "product"
    modus_ponens: str = "conditional"
    fusion: str = "yager"
    ranking: str = "plausibility"
    acceptance: str = "directed"

    def __post_init__(self) -> None:
        for kind, table in _TABLES.items():
            if (name := getattr(self, kind)) not in table:
                raise UnknownNameError(kind.replace("_", " "), name, table)

    def all_of(self, intervals: Sequence[Interval]) -> Interval:
        """Return the conjunction of the intervals; [1, 1] of none."""
        return CONJUNCTIONS[self.conjunction](intervals)

    def conclude(self, antecedent: Interval, rule: Interval) -> Interval:
        """Return the conclusion of a rule by modus ponens."""
        return MODUS_PONENS[self.modus_ponens](antecedent, rule)

    def fuse(self, intervals: Sequence[Interval]) -> Interval:
        """Fuse several intervals for the same proposition."""
        return FUSIONS[self.fusion](intervals)

    def rank(self, interval: Interval) -> float:
        """Return the score by which candidates are ranked; higher is better."""
        return RANKINGS[self.ranking](interval)

    def accepts(self, interval: Interval, threshold: float) -> bool:
        """Whether a conclusion may be acted on."""
        return ACCEPTANCES[self.acceptance](interval, threshold)

    def denies(self, interval: Interval, threshold: float) -> bool:
        """Whether the negation of a conclusion is affirmed."""
        return is_affirmed(interval.negated(), threshold)
