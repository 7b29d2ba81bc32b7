# SPDX-License-Identifier: Apache-2.0
"""The vectorised operators give what the scalar ones give."""

import numpy as np
import pytest

from hilt.inference import evidence, evidence_batch
from hilt.kb.interval import Interval

ROWS = 500


@pytest.fixture
def rng() -> np.random.Generator:
    """The same random numbers every time."""
    return np.random.default_rng(7)


def random_intervals(rng: np.random.Generator, *shape: int) -> np.ndarray:
    """Intervals of which some are certain, vacuous, or have a bound at an end."""
    pairs = np.sort(rng.random((*shape, 2)), axis=-1)
    pairs[rng.random(shape) < 0.1] = (0.0, 1.0)
    pairs[rng.random(shape) < 0.1] = (1.0, 1.0)
    pairs[rng.random(shape) < 0.1, 1] = 1.0
    return pairs


def scalars(rows: np.ndarray) -> list[Interval]:
    """The rows as intervals."""
    return [Interval(float(lower), float(upper)) for lower, upper in rows]


def bounds(intervals: list[Interval]) -> np.ndarray:
    """Intervals as rows."""
    return np.array([(each.lower, each.upper) for each in intervals])


@pytest.mark.parametrize("name", evidence_batch.CONJUNCTIONS)
def test_conjunction_agrees_with_the_scalar_one(name: str, rng: np.random.Generator):
    """AND of four intervals, row by row."""
    rows = random_intervals(rng, ROWS, 4)

    expected = bounds([evidence.CONJUNCTIONS[name](scalars(row)) for row in rows])

    assert evidence_batch.CONJUNCTIONS[name](rows) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("name", evidence_batch.MODUS_PONENS)
def test_modus_ponens_agrees_with_the_scalar_one(name: str, rng: np.random.Generator):
    """Every reading, row by row."""
    antecedents, rules = random_intervals(rng, ROWS), random_intervals(rng, ROWS)
    pairs = zip(scalars(antecedents), scalars(rules), strict=True)

    expected = bounds([evidence.MODUS_PONENS[name](*pair) for pair in pairs])

    found = evidence_batch.MODUS_PONENS[name](antecedents, rules)
    assert found == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("name", evidence_batch.FUSIONS)
def test_fusion_agrees_with_the_scalar_one(name: str, rng: np.random.Generator):
    """Runs of one to five rows are fused each on their own."""
    lengths = rng.integers(1, 6, ROWS)
    starts = np.concatenate(([0], np.cumsum(lengths)[:-1]))
    rows = np.sort(rng.random((lengths.sum(), 2)), axis=-1)

    runs = [scalars(run) for run in np.split(rows, starts[1:])]
    expected = bounds([evidence.FUSIONS[name](run) for run in runs])

    assert evidence_batch.FUSIONS[name](rows, starts) == pytest.approx(expected, abs=1e-12)


def test_full_conflict_is_told_by_nan():
    """Dempster's rule is not defined there; a row cannot raise."""
    fused = evidence_batch.fuse_dempster(np.array([[1.0, 1.0], [0.0, 0.0]]), np.array([0]))

    assert np.isnan(fused).all()


@pytest.mark.parametrize("name", evidence_batch.RANKINGS)
def test_ranking_agrees_with_the_scalar_one(name: str, rng: np.random.Generator):
    """Every ranking, row by row."""
    rows = random_intervals(rng, ROWS)

    expected = [evidence.RANKINGS[name](each) for each in scalars(rows)]

    assert evidence_batch.RANKINGS[name](rows) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("name", evidence_batch.ACCEPTANCES)
def test_acceptance_agrees_with_the_scalar_one(name: str, rng: np.random.Generator):
    """Both acceptances, row by row."""
    rows = random_intervals(rng, ROWS)

    expected = [evidence.ACCEPTANCES[name](each, 0.1) for each in scalars(rows)]

    assert evidence_batch.ACCEPTANCES[name](rows, 0.1).tolist() == expected


@pytest.mark.parametrize(
    "table", ["CONJUNCTIONS", "MODUS_PONENS", "FUSIONS", "RANKINGS", "ACCEPTANCES"]
)
def test_every_scalar_choice_has_its_vectorised_one(table: str):
    """No name of a table is missing in the other."""
    assert set(getattr(evidence_batch, table)) == set(getattr(evidence, table))


def test_logical_operators_agree_with_the_scalar_ones(rng: np.random.Generator):
    """OR and NOT, row by row."""
    rows = random_intervals(rng, ROWS, 3)

    expected = bounds([evidence.disjunction(scalars(row)) for row in rows])

    assert evidence_batch.disjunction(rows) == pytest.approx(expected, abs=1e-12)
    assert evidence_batch.negation(rows[:, 0]) == pytest.approx(
        bounds([evidence.negation(each) for each in scalars(rows[:, 0])]), abs=1e-12
    )
