"""Depths with noise are smoothed where they are flat, and stay sharp at edges."""

import numpy as np
import pytest

from hilt.sim.vision.segmentation import kuwahara_filter

SIZE = 60  # pixels
LEFT = np.arange(SIZE) < SIZE // 2
TABLE = np.tile(0.9 + 0.0025 * np.arange(SIZE, dtype=np.float32)[:, None], SIZE)  # [m]
STEP = TABLE - np.where(LEFT, np.float32(0.03), np.float32(0))  # [m], something lies on its left
NOISE = np.random.default_rng(0).normal(0, 1, TABLE.shape)


@pytest.mark.parametrize("noise", [0.002, 0.005])
def test_noise_of_a_plane_falls_to_a_fifth(noise: float):
    """The mean of 25 pixels has a fifth of their deviation."""
    smooth = kuwahara_filter((TABLE + noise * NOISE).astype(np.float32), noise)

    assert np.std(smooth - TABLE) < 0.3 * noise


@pytest.mark.parametrize("noise", [0.002, 0.005])
def test_edge_stays_sharp(noise: float):
    """Hardly any pixel takes the depth of the other side."""
    smooth = kuwahara_filter((STEP + noise * NOISE).astype(np.float32), noise)

    assert (np.abs(smooth - STEP)[2:-2, 2:-2] < 3 * noise).mean() > 0.99


def test_narrow_thing_is_kept():
    """Three pixels across are too few for the large squares, but fill the small ones."""
    narrow = TABLE.copy()
    narrow[:, 20:23] -= 0.03

    smooth = kuwahara_filter((narrow + 0.002 * NOISE).astype(np.float32), 0.002)

    assert np.nanmax(np.abs(smooth - narrow)[2:-2, 20:23]) < 0.01


def test_depths_without_a_plane_are_left_out():
    """Where each pixel is somewhere else, nothing is known."""
    rough = (TABLE + 0.1 * NOISE).astype(np.float32)

    assert np.isnan(kuwahara_filter(rough, 0.002)).mean() > 0.9
