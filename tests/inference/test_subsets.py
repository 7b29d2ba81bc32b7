"""The sixteen sets of the paper's four levels, fused by every rule, against exact fractions.

The table of the theory gives three digits; here each column is worked out again with fractions and
explicit mass functions, which have no rounding, and the operators must agree to 1e-12.
"""

from fractions import Fraction
from itertools import chain, combinations
from math import prod

import pytest

from hilt.inference.interval_operators import FUSIONS, certainty
from hilt.kb.interval import VACUOUS, Interval

Exact = tuple[Fraction, Fraction]

LEVELS = {"G": "0.95", "O": "0.75", "S": "0.5", "c": "0.25"}
BANDS = {"G": ("0.95", "1"), "O": ("0.75", "0.95"), "S": ("0.5", "0.75"), "c": ("0.25", "0.5")}
SUBSETS = ["".join(s) for s in chain(*(combinations("GOSc", n) for n in range(5)))]

# subset: noisy-or, lambda, max, mean, [p, p] Dempster, [p, p] Yager, band Dempster, band Yager
TABLE = """
c     .25    .0148 .25 .25  .25  .25,.25   .25,.5    .25,.5
S     .5     .0817 .5  .5   .5   .5,.5     .5,.75    .5,.75
Sc    .625   .1546 .5  .375 .25  .125,.625 .455,.545 .313,.688
O     .75    .2781 .75 .75  .75  .75,.75   .75,.95   .75,.95
Oc    .8125  .3708 .75 .5   .5   .188,.813 .694,.776 .425,.863
OS    .875   .4967 .75 .625 .75  .375,.875 .841,.905 .663,.925
OSc   .90625 .5780 .75 .5   .5   .094,.906 .786,.814 .344,.919
G     .95    .7238 .95 .95  .95  .95,.95   .95,1     .95,1
Gc    .9625  .7757 .95 .6   .864 .238,.963 .929,.952 .488,.975
GS    .975   .8346 .95 .725 .95  .475,.975 .967,.984 .738,.988
GSc   .98125 .8676 .95 .567 .864 .119,.981 .952,.960 .372,.984
GO    .9875  .9040 .95 .85  .983 .713,.988 .987,.997 .94,.998
GOc   .99063 .9240 .95 .65  .95  .178,.991 .981,.986 .473,.993
GOS   .99375 .9455 .95 .733 .983 .356,.994 .991,.995 .71,.996
GOSc  .99531 .9572 .95 .613 .95  .089,.995 .987,.989 .356,.996
"""
ROWS = {cells[0]: cells[1:] for cells in (line.split() for line in TABLE.strip().splitlines())}


def supports(subset: str) -> list[Exact]:
    """Return the levels as [p, 1]."""
    return [(Fraction(LEVELS[level]), Fraction(1)) for level in subset]


def points(subset: str) -> list[Exact]:
    """Return the levels as [p, p]."""
    return [(Fraction(LEVELS[level]), Fraction(LEVELS[level])) for level in subset]


def bands(subset: str) -> list[Exact]:
    """Return the levels as adjacent intervals."""
    return [(Fraction(BANDS[level][0]), Fraction(BANDS[level][1])) for level in subset]


def masses(sources: list[Exact]) -> dict[str, Fraction]:
    """Return the conjunctive combination of mass functions on {T, F}; "" is the conflict."""
    found = {"TF": Fraction(1)}
    for lower, upper in sources:
        merged: dict[str, Fraction] = {}
        for focal, mass in found.items():
            for other, share in (("T", lower), ("F", 1 - upper), ("TF", upper - lower)):
                both = "".join(sorted({*focal} & {*other}, reverse=True))
                merged[both] = merged.get(both, Fraction(0)) + mass * share
        found = merged
    return found


def yager(sources: list[Exact]) -> Exact:
    """Return the fusion by Yager's rule: conflict becomes ignorance."""
    found = masses(sources)
    return found.get("T", Fraction(0)), 1 - found.get("F", Fraction(0))


def dempster(sources: list[Exact]) -> Exact:
    """Return the fusion by Dempster's rule: conflict is divided out."""
    found = masses(sources)
    agreement = 1 - found.get("", Fraction(0))
    return found.get("T", Fraction(0)) / agreement, 1 - found.get("F", Fraction(0)) / agreement


def mean(sources: list[Exact]) -> Exact:
    """Return the average of the bounds."""
    count = len(sources)
    return sum((low for low, _ in sources), Fraction(0)) / count, sum(
        (high for _, high in sources), Fraction(0)
    ) / count


def strongest(sources: list[Exact]) -> Exact:
    """Return the fusion by the cautious rule, which on [p, 1] is the largest p."""
    return max(sources)


def fused(fusion: str, sources: list[Exact]) -> Interval:
    """Return the fusion of the same sources in floating point."""
    return FUSIONS[fusion]([Interval(float(low), float(high)) for low, high in sources])


COLUMNS = {
    "noisy-or by yager": ("yager", supports, yager, 0),
    "noisy-or by dempster": ("dempster", supports, dempster, 0),
    "max by cautious": ("cautious", supports, strongest, 2),
    "mean": ("mean", supports, mean, 3),
    "points by dempster": ("dempster", points, dempster, 4),
    "points by yager": ("yager", points, yager, 5),
    "bands by dempster": ("dempster", bands, dempster, 6),
    "bands by yager": ("yager", bands, yager, 7),
}


@pytest.mark.parametrize("subset", ROWS)
@pytest.mark.parametrize("name", COLUMNS)
def test_every_column_agrees_with_exact_fractions(name: str, subset: str):
    """Both bounds agree to 1e-12, and the fractions agree with the printed table."""
    fusion, levels, exactly, column = COLUMNS[name]

    lower, upper = exactly(levels(subset))
    found = fused(fusion, levels(subset))

    assert abs(found.lower - float(lower)) < 1e-12
    assert abs(found.upper - float(upper)) < 1e-12
    printed = [float(number) for number in ROWS[subset][column].split(",")]
    assert [float(lower), float(upper)][: len(printed)] == pytest.approx(printed, abs=5.1e-4)


@pytest.mark.parametrize("subset", ROWS)
def test_yager_of_supporting_levels_is_noisy_or(subset: str):
    """The belief is 1 - Π(1 - p) to 1e-12, and lambda is as printed."""
    missed = prod((1 - low for low, _ in supports(subset)), start=Fraction(1))

    found = fused("yager", supports(subset))

    assert abs(found.lower - float(1 - missed)) < 1e-12
    assert certainty(found) == pytest.approx(float(ROWS[subset][1]), abs=5.1e-5)


@pytest.mark.parametrize("fusion", ["yager", "dempster", "cautious", "mean", "latest"])
def test_empty_set_of_levels_is_ignorance(fusion: str):
    """The empty set of levels gives [0, 1] by every rule."""
    assert len(SUBSETS) == len(ROWS) + 1
    assert FUSIONS[fusion]([]) == VACUOUS


DETECTIONS = {
    1.0: (0.7238, 0.2781, 0.0817, 0.01477),
    0.9: (0.4519, 0.1963, 0.0617, 0.01162),
    0.8: (0.2912, 0.1369, 0.0456, 0.00892),
    0.7: (0.1872, 0.0934, 0.0327, 0.00664),
}


@pytest.mark.parametrize(("detection", "row"), DETECTIONS.items())
def test_lambda_of_each_level_at_each_detection(detection: float, row: tuple[float, ...]):
    """Lambda has the values of the first table on lambda in the theory."""
    found = [certainty(Interval(detection * float(level), 1.0)) for level in LEVELS.values()]

    assert found == pytest.approx(row, abs=6e-5)
