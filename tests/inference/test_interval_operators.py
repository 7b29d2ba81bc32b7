"""The laws of the evidence operators, and the values that the theory predicts."""

from fractions import Fraction
from itertools import combinations, pairwise, permutations
from math import nextafter

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from hilt.inference.interval_operators import (
    CONJUNCTIONS,
    FUSIONS,
    MODUS_PONENS,
    Operators,
    certainty,
    conjunction,
    fuse_cautious,
    fuse_dempster,
    fuse_yager,
    is_affirmed,
    modus_ponens,
    modus_ponens_material,
    modus_ponens_published,
    relative_plausibility,
)
from hilt.kb.interval import EPSILON, VACUOUS, Interval
from hilt.ontology.errors import ConflictError, UnknownNameError

TRUE, FALSE = Interval(1.0, 1.0), Interval(0.0, 0.0)
LEVELS = {"G": 0.95, "O": 0.75, "S": 0.5, "c": 0.25}

unit = st.floats(0, 1, allow_subnormal=False)
intervals = st.tuples(unit, unit).map(lambda pair: Interval(min(pair), max(pair)))
grid = st.integers(0, 10).map(lambda n: n / 10)
grid_intervals = st.tuples(grid, grid).map(lambda pair: Interval(min(pair), max(pair)))


def close(one: Interval, other: Interval) -> bool:
    """Return whether two intervals are equal up to rounding."""
    return (one.lower, one.upper) == pytest.approx((other.lower, other.upper), abs=1e-12)


# --- Conjunction ---------------------------------------------------------------------------


@given(st.permutations([Interval(0.3, 0.7), Interval(0.21, 0.9), Interval(0.77, 0.8)]))
def test_conjunction_is_bit_identical_in_any_order(shuffled: list[Interval]):
    """Factors are multiplied in sorted order."""
    assert conjunction(shuffled) == conjunction(shuffled[::-1])


@given(intervals)
def test_conjunction_with_truth_changes_nothing(interval: Interval):
    """[1, 1] is the neutral element of the conjunction."""
    assert conjunction([interval, TRUE]) == interval


@given(intervals)
def test_conjunction_with_falsehood_is_false(interval: Interval):
    """[0, 0] is the absorbing element of the conjunction."""
    assert conjunction([interval, FALSE]) == FALSE


@given(grid_intervals, grid_intervals)
def test_product_lies_within_the_frechet_bounds(one: Interval, other: Interval):
    """The Fréchet bounds hold for any dependence, so also for independence."""
    anyhow = CONJUNCTIONS["frechet"]([one, other])

    both = conjunction([one, other])

    assert anyhow.lower - 1e-12 <= both.lower
    assert both.upper <= anyhow.upper + 1e-12


# --- Modus ponens --------------------------------------------------------------------------


@pytest.mark.parametrize("name", MODUS_PONENS)
@given(rule=intervals)
def test_certain_antecedent_concludes_the_interval_of_the_rule(name: str, rule: Interval):
    """All readings return [α, β] when the antecedent is certain."""
    assert close(MODUS_PONENS[name](TRUE, rule), rule)


@given(intervals, unit)
def test_all_readings_agree_on_every_rule_that_the_paper_prints(seen: Interval, alpha: float):
    """For β = 1 the conclusion is [a·α, 1], whatever b is."""
    rule = Interval(alpha, 1.0)

    concluded = {name: reading(seen, rule) for name, reading in MODUS_PONENS.items()}

    assert len(set(concluded.values())) == 1
    assert concluded["conditional"].lower == pytest.approx(seen.lower * alpha)


@given(intervals)
def test_absent_antecedent_concludes_nothing_by_the_conditional_reading(rule: Interval):
    """An absent antecedent concludes [0, 1], even with a negative rule."""
    assert modus_ponens(FALSE, rule) == VACUOUS


def test_published_reading_denies_by_an_absent_antecedent():
    """[a·α, β] has this known flaw; it is kept as an option for comparison."""
    assert modus_ponens_published(FALSE, Interval(0.0, 0.1)) == Interval(0.0, 0.1)
    assert modus_ponens_material(FALSE, Interval(0.0, 0.1)) == VACUOUS


@given(intervals, intervals)
def test_belief_in_the_conclusion_is_at_most_that_in_the_antecedent(seen: Interval, rule: Interval):
    """The lower bound of the conclusion is at most that of the antecedent."""
    assert modus_ponens(seen, rule).lower <= seen.lower


@given(intervals, intervals, grid, grid)
def test_conclusion_contains_every_probability(
    seen: Interval, rule: Interval, at: float, given_not: float
):
    """It contains P(C) for all P(A) and P(C|A) in their intervals and any P(C|not A)."""
    p_a = seen.lower + at * (seen.upper - seen.lower)
    for p_c in (rule.lower, rule.upper):
        probability = p_a * p_c + (1 - p_a) * given_not

        concluded = modus_ponens(seen, rule)

        assert concluded.lower - 1e-9 <= probability <= concluded.upper + 1e-9


# --- Fusion --------------------------------------------------------------------------------


@pytest.mark.parametrize("name", ["yager", "dempster", "mean"])
@given(taught=st.lists(st.tuples(st.integers(1, 8), st.integers(1, 8)), min_size=1, max_size=5))
def test_fusion_is_bit_identical_in_any_order(name: str, taught: list[tuple[int, int]]):
    """The result of fusion does not depend on the order of the sources."""
    sources = [Interval(min(a, b) / 9, max(a, b) / 9) for a, b in taught]

    fused = {FUSIONS[name](list(order)) for order in permutations(sources)}

    assert len(fused) == 1


@pytest.mark.parametrize("name", ["yager", "dempster"])
@given(interval=intervals)
def test_ignorance_is_neutral_for_fusion(name: str, interval: Interval):
    """[0, 1] is the neutral element of fusion."""
    assume(interval.upper > 0)
    assert close(FUSIONS[name]([interval, VACUOUS]), interval)


def test_yager_turns_full_conflict_into_ignorance():
    """[1, 1] with [0, 0] gives [0, 1] and no error."""
    assert fuse_yager([TRUE, FALSE]) == VACUOUS


def test_dempster_refuses_full_conflict():
    """Dempster's rule is not defined for full conflict and raises an error."""
    with pytest.raises(ConflictError, match="contradict each other fully"):
        fuse_dempster([TRUE, FALSE])


def test_yager_over_three_sources_is_not_the_pairwise_fold():
    """The n-ary rule has no order; the pairwise rule gives [1, 1] or [0, 1] depending on it."""
    fold_one = fuse_yager([fuse_yager([TRUE, FALSE]), TRUE])
    fold_other = fuse_yager([fuse_yager([TRUE, TRUE]), FALSE])

    assert (fold_one, fold_other) == (TRUE, VACUOUS)
    assert fuse_yager([TRUE, FALSE, TRUE]) == VACUOUS


def test_conflict_lowers_belief_by_yager_less_by_dempster():
    """The worked example of conflicting sources has its computed values."""
    sources = [Interval(0.9, 1.0), Interval(0.0, 0.5)]

    assert close(fuse_yager(sources), Interval(0.45, 0.95))
    assert close(fuse_dempster(sources), Interval(0.9 * 0.5 / 0.55, 0.5 / 0.55))


@given(st.lists(unit, min_size=1, max_size=6))
def test_fusion_of_supporting_sources_is_noisy_or(degrees: list[float]):
    """Intervals [p, 1] do not conflict, so both rules give 1 - Π(1-p)."""
    sources = [Interval(p, 1.0) for p in degrees]
    miss = 1.0
    for p in degrees:
        miss *= 1 - p

    assert close(fuse_yager(sources), Interval(min(1 - miss, 1.0), 1.0))
    assert close(fuse_yager(sources), fuse_dempster(sources))


def exact_cautious(intervals: list[Interval]) -> tuple[Fraction, Fraction]:
    """Return the fusion by the cautious rule in exact arithmetic, by its definition."""
    pairs = [(Fraction(each.lower), Fraction(each.upper)) for each in intervals]
    true = min((b - a) / b for a, b in pairs)
    false = min((b - a) / (1 - a) for a, b in pairs)
    conflict = (1 - true) * (1 - false)
    return (1 - true) * false / (1 - conflict), false / (1 - conflict)


exponents = st.floats(-15, 0)
narrow = st.tuples(st.floats(0, 1 - 1e-14), exponents).map(
    lambda pair: Interval(pair[0], min(1.0, pair[0] + 10 ** pair[1] + 2e-16))
)


@given(st.lists(narrow, min_size=1, max_size=4))
def test_cautious_rule_is_exact_for_intervals_of_any_width(sources: list[Interval]):
    """Exact fractions give the same result, also where the bounds differ by 1e-15."""
    lower, upper = exact_cautious(sources)

    fused = fuse_cautious(sources)

    assert abs(Fraction(fused.lower) - lower) < 1e-14
    assert abs(Fraction(fused.upper) - upper) < 1e-14


@given(st.floats(0.01, 0.99), st.integers(1, 5))
def test_cautious_rule_counts_repetition_once(degree: float, times: int):
    """Sources that repeat each other do not raise the belief."""
    assert close(fuse_cautious([Interval(degree, 1.0)] * times), Interval(degree, 1.0))


def masses(interval: Interval) -> dict[frozenset[str], float]:
    """Return the mass function of an interval on the frame {T, F}."""
    return {
        frozenset("T"): interval.lower,
        frozenset("F"): 1 - interval.upper,
        frozenset("TF"): interval.upper - interval.lower,
    }


@given(st.lists(grid_intervals, min_size=1, max_size=4))
def test_yager_agrees_with_explicit_mass_functions(sources: list[Interval]):
    """The fused masses are those of intersecting all focal elements, with conflict on the frame."""
    focal = {frozenset("TF"): 1.0}
    for source in sources:
        merged: dict[frozenset[str], float] = {}
        for (left, m), (right, n) in (
            (a, b) for a in focal.items() for b in masses(source).items()
        ):
            merged[left & right] = merged.get(left & right, 0.0) + m * n
        focal = merged

    fused = fuse_yager(sources)

    assert fused.lower == pytest.approx(focal.get(frozenset("T"), 0.0), abs=1e-12)
    assert 1 - fused.upper == pytest.approx(focal.get(frozenset("F"), 0.0), abs=1e-12)


SUBSETS = {
    "c": (0.25, 0.0148), "S": (0.5, 0.0817), "Sc": (0.625, 0.1546), "O": (0.75, 0.2781),
    "Oc": (0.8125, 0.3708), "OS": (0.875, 0.4967), "OSc": (0.90625, 0.5780), "G": (0.95, 0.7238),
    "Gc": (0.9625, 0.7757), "GS": (0.975, 0.8346), "GSc": (0.98125, 0.8676),
    "GO": (0.9875, 0.9040), "GOc": (0.990625, 0.9240), "GOS": (0.99375, 0.9455),
    "GOSc": (0.9953125, 0.9572), "": (0.0, 0.0),
}  # fmt: skip


@pytest.mark.parametrize(("subset", "expected"), SUBSETS.items())
def test_sixteen_fused_subsets_have_their_table_values(subset: str, expected: tuple[float, float]):
    """Belief and lambda of every set of the paper's four levels."""
    fused = fuse_yager([Interval(LEVELS[letter], 1.0) for letter in subset])

    assert fused.lower == pytest.approx(expected[0], abs=1e-12)
    assert certainty(fused) == pytest.approx(expected[1], abs=5e-5)


def test_sixteen_subsets_are_ranked_in_binary_order():
    """More or stronger evidence is always ranked higher, by the weights G=8, O=4, S=2, c=1."""
    subsets = [set(s) for n in range(5) for s in combinations("GOSc", n)]
    subsets.sort(key=lambda s: sum({"G": 8, "O": 4, "S": 2, "c": 1}[x] for x in s))

    ranks = [
        relative_plausibility(fuse_yager([Interval(LEVELS[x], 1.0) for x in s])) for s in subsets
    ]

    assert all(low < high for low, high in pairwise(ranks))


# --- Lambda and acceptance -----------------------------------------------------------------


@given(intervals)
def test_lambda_is_in_the_unit_interval_and_the_same_for_the_negation(interval: Interval):
    """Lambda lies in [0, 1] and is the same for a statement and its negation."""
    assert 0 <= certainty(interval) <= 1
    assert certainty(interval) == pytest.approx(certainty(interval.negated()), abs=1e-9)


def test_certain_falsehood_is_not_accepted():
    """Lambda of [0, 0] is 1; acceptance also needs an interval that is more true than false."""
    assert certainty(FALSE) == 1
    assert not is_affirmed(FALSE, 0.005)


@pytest.mark.parametrize("percent", range(0, 101, 5))
def test_interval_that_favours_neither_side_is_never_accepted(percent: int):
    """With a + b = 1 nothing is accepted, though rounding may leave lambda above zero."""
    a = min(percent, 100 - percent) / 100

    assert not is_affirmed(Interval(a, 1 - a), 0.0)


THRESHOLDS = {
    0.0025: (0.111, 0.117, 0.148, 0.222, 0.445),
    0.005: (0.154, 0.162, 0.205, 0.307, 0.615),
    0.01: (0.211, 0.222, 0.281, 0.421, 0.842),
    0.1: (0.538, 0.566, 0.717, None, None),
}


@pytest.mark.parametrize(("threshold", "row"), THRESHOLDS.items())
def test_least_detection_for_each_level_and_threshold(threshold: float, row: tuple[float | None]):
    """Each level is accepted from this detection confidence on."""
    for level, least in zip((1.0, *LEVELS.values()), row, strict=True):
        rule = Interval(level, 1.0)
        feasible = [
            d / 1000
            for d in range(1, 1001)
            if is_affirmed(modus_ponens(Interval(d / 1000, 1.0), rule), threshold)
        ]

        assert (min(feasible) if feasible else None) == pytest.approx(least, abs=1.01e-3)


# --- Named choices -------------------------------------------------------------------------


@pytest.mark.parametrize("field", ["conjunction", "modus_ponens", "fusion", "ranking"])
def test_unknown_operator_is_refused_with_the_known_names(field: str):
    """A misspelt name is refused when the operators are made, not when they are used."""
    with pytest.raises(UnknownNameError, match="Known: "):
        Operators(**{field: "nonsense"})


@pytest.mark.parametrize("acceptance", ["directed", "lambda"])
@pytest.mark.parametrize("degree", sorted(LEVELS.values()))
def test_conclusion_is_accepted_only_above_the_threshold(acceptance: str, degree: float):
    """A lambda that equals the threshold does not exceed it."""
    operators, interval = Operators(acceptance=acceptance), Interval(degree, 1.0)
    sure = certainty(interval)

    assert not operators.accepts(interval, sure)
    assert operators.accepts(interval, nextafter(sure, 0.0))
    assert not operators.accepts(interval, nextafter(sure, 1.0))


# --- Single values ---------------------------------------------------------------------------


@given(intervals)
@pytest.mark.parametrize("name", ["yager", "dempster", "latest"])
def test_fusion_of_one_source_is_that_source_to_the_last_bit(name: str, interval: Interval):
    """Nothing is computed where there is nothing to fuse."""
    assert FUSIONS[name]([interval]) == interval


def test_latest_source_is_the_last_one():
    """Whatever was said before; nothing said is ignorance."""
    assert FUSIONS["latest"]([TRUE, FALSE]) == FALSE
    assert FUSIONS["latest"]([]) == VACUOUS


def test_frechet_bound_is_what_the_sources_must_have_in_common():
    """Of 90 and 80 percent at least 70 are both."""
    assert close(
        CONJUNCTIONS["frechet"]([Interval(0.9, 1.0), Interval(0.8, 0.95)]), Interval(0.7, 0.95)
    )


@pytest.mark.parametrize("share", [0.0, 0.5, 1.0])
def test_cautious_rule_refuses_what_is_certain(share: float):
    """A point has no weights."""
    with pytest.raises(ConflictError, match=r"needs lower < upper"):
        fuse_cautious([Interval(share, share)])


def test_rankings_are_in_the_unit_interval():
    """Each is the share of the name."""
    interval, ranks = Interval(0.2, 0.6), {"belief": 0.2, "pignistic": 0.4}

    for name, rank in ranks.items():
        assert Operators(ranking=name).rank(interval) == pytest.approx(rank)


def test_what_is_true_by_a_rounding_error_is_not_affirmed():
    """The sum of the bounds must exceed 1 by more than the tolerance."""
    assert not is_affirmed(Interval(EPSILON, 1.0), -1.0)
    assert is_affirmed(Interval(3 * EPSILON, 1.0), -1.0)
