"""Claims about belief intervals."""

from __future__ import annotations

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.kb.interval import CERTAIN, VACUOUS, Interval
from hilt.ontology.errors import IntervalError

chances = st.floats(0, 1)
intervals = st.tuples(chances, chances).map(lambda pair: Interval(min(pair), max(pair)))


@pytest.mark.parametrize(
    ("lower", "upper"),
    [(0.9, 0.1), (-0.1, 0.5), (0.5, 1.1), (math.nan, 1), (0, math.inf), ("x", 1), (None, 1)],
)
def test_wrong_interval_cannot_exist(lower: float, upper: float):
    """Two numbers that are no bounds of a probability raise an error that names both."""
    with pytest.raises(IntervalError) as caught:
        Interval(lower, upper)

    assert str(lower) in str(caught.value)
    assert "expected 0 <= lower <= upper <= 1" in str(caught.value)


def test_interval_shows_itself_shortly():
    """Repr gives a constructor call, str two digits."""
    interval = Interval(0.95, 1)

    assert repr(interval) == "Interval(0.95, 1.0)"
    assert str(interval) == "[0.95, 1.00]"


@given(intervals)
def test_negation_keeps_the_width(interval: Interval):
    """The opposite statement is as open as the statement, and opposite twice is the same."""
    opposite = interval.negated()

    assert opposite.width == pytest.approx(interval.width)
    assert opposite.negated().lower == pytest.approx(interval.lower)


@given(intervals, chances)
def test_discounting_only_widens(interval: Interval, trust: float):
    """Less trust never narrows what is said."""
    discounted = interval.discounted(trust)

    assert discounted.lower <= interval.lower
    assert discounted.upper >= interval.upper - 1e-12


@given(intervals)
def test_full_trust_changes_nothing_and_none_leaves_ignorance(interval: Interval):
    """Trust 1 is neutral, trust 0 gives the vacuous interval."""
    assert interval.discounted(1) == interval
    assert interval.discounted(0) == VACUOUS


def test_trust_outside_the_unit_range_is_refused():
    """Trust is a probability too."""
    with pytest.raises(IntervalError):
        CERTAIN.discounted(1.5)


@given(intervals)
def test_rounding_twice_is_rounding_once(interval: Interval):
    """What is stored is stored again unchanged."""
    rounded = interval.rounded()

    assert rounded.rounded() == rounded
    assert abs(rounded.lower - interval.lower) <= 1e-6


def test_only_the_whole_range_is_vacuous():
    """[0, 1] says nothing; anything narrower says something."""
    assert VACUOUS.is_vacuous
    assert not Interval(0, 0.999999).is_vacuous


def test_negative_zero_is_zero():
    """-0.0 is shown and stored as 0.0."""
    assert repr(Interval(-0.0, 1)) == "Interval(0.0, 1.0)"
