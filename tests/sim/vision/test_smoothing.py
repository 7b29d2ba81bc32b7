# SPDX-License-Identifier: Apache-2.0
"""Planes fitted to noisy depths."""

from __future__ import annotations

import numpy as np
import pytest

from hilt.sim.vision.smoothing import smoothed

ROWS, COLUMNS = np.mgrid[0:30, 0:40]
ASKEW = (0.8 + 0.002 * ROWS - 0.003 * COLUMNS).astype(np.float32)  # [m], a face seen askew
LEFT = np.where(COLUMNS < 20, 1, 2).astype(np.int32)


def test_plane_stays_what_it_is():
    """Also at its rim, where a mean would bend it."""
    result = smoothed(ASKEW, LEFT, [1, 2], noise=0.002)

    assert result == pytest.approx(ASKEW, abs=1e-3)
    assert result[5:25, 5:15] == pytest.approx(ASKEW[5:25, 5:15], abs=1e-4)


def test_noise_becomes_a_quarter():
    """Noise of 2 mm is below 0.6 mm in the mean over a whole face."""
    noise = np.random.default_rng(3).normal(0.0, 0.002, ASKEW.shape)

    result = smoothed((ASKEW + noise).astype(np.float32), LEFT, [1, 2], noise=0.002)

    assert float(np.std(result - ASKEW)) < 0.0006


def test_step_between_two_parts_stays_sharp():
    """What is a centimetre behind is not pulled forwards by what is before it."""
    step = np.where(LEFT == 1, 0.80, 0.81).astype(np.float32)

    result = smoothed(step, LEFT, [1, 2], noise=0.002)

    assert result == pytest.approx(step, abs=1e-6)


def test_part_that_hides_more_of_itself_keeps_its_edge():
    """Behind the rim of a mug its far wall is seen: one part, but two faces."""
    mug = np.where(COLUMNS < 20, 0.80, 0.86).astype(np.float32)

    result = smoothed(mug, np.ones_like(LEFT), [1], noise=0.002)

    assert result == pytest.approx(mug, abs=1e-5)


def test_all_else_stays_as_it_was():
    """Pixels of other labels keep their noise."""
    noisy = np.random.default_rng(4).normal(0.8, 0.01, ASKEW.shape).astype(np.float32)

    result = smoothed(noisy, LEFT, [1], noise=0.01)

    assert np.array_equal(result[LEFT == 2], noisy[LEFT == 2])
    assert not np.array_equal(result[LEFT == 1], noisy[LEFT == 1])
