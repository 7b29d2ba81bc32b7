# SPDX-License-Identifier: Apache-2.0
"""Paths: they keep their ends and their speed limits."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.sim.robot.paths import passed, timed

STEP = 1 / 240
LIMITS = np.array([2.0, 1.0])
postures = st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2)), min_size=2, max_size=6)


@given(postures, st.floats(0.1, 1.0))
def test_timed_ends_at_rest_where_the_path_ends(points, pace):
    """The last position is the path's end, and it stands still there."""
    positions, speeds = timed(np.array(points), LIMITS, step=STEP, pace=pace)

    assert np.allclose(positions[-1], points[-1])
    assert not speeds[-1].any()


@given(postures, st.floats(0.1, 1.0))
def test_timed_keeps_to_the_speed_limits(points, pace):
    """No joint is asked for more than its share of its limit."""
    _, speeds = timed(np.array(points), LIMITS, step=STEP, pace=pace)

    assert np.all(np.abs(speeds) <= LIMITS * pace * 1.02 + 1e-9)


@given(postures, st.floats(0.05, 0.5))
def test_passed_leaves_no_gap(points, apart):
    """Of a run are kept its ends, and so much that a joint turns little between two positions."""
    positions, _ = timed(np.array(points), LIMITS, step=STEP, pace=0.9)

    kept = passed(positions, apart)

    assert np.allclose(kept[[0, -1]], positions[[0, -1]])
    longest_step = np.abs(np.diff(positions, axis=0)).max(initial=0.0)
    assert np.abs(np.diff(kept, axis=0)).max(initial=0.0) <= apart + longest_step + 1e-9


def test_timed_takes_longer_at_a_slower_pace():
    """Half the pace takes twice as long."""
    path = np.array([[0.0, 0.0], [1.0, 0.5]])

    fast, slow = (len(timed(path, LIMITS, step=STEP, pace=pace)[0]) for pace in (0.8, 0.4))

    assert slow == pytest.approx(2 * fast, abs=2)
