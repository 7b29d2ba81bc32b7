# SPDX-License-Identifier: Apache-2.0
"""Paths of an arm through joint space, and how they are run through in time.

A path is a list of postures. `timed` runs through it with a speed that starts and ends at zero
(s = 3 t^2 - 2 t^3) and never asks a joint for more than its share of its speed limit; corners are
rounded off by a running mean.
"""

from __future__ import annotations

import numpy as np

from ..poses import Array

PEAK = 1.5  # the highest speed of s = 3 t^2 - 2 t^3, in units of the mean one
SHORTEST = 0.12  # [s], also for a path of no length
ROUNDING = 0.1  # [s] over which corners are rounded off


def timed(points: Array, limits: Array, *, step: float, pace: float) -> tuple[Array, Array]:
    """Run through a path.

    Args:
        points: postures (n, k) [rad].
        limits: of the joints' speeds (k,) [rad/s].
        step: time between two answers [s].
        pace: share of the limits that is used, in (0, 1].

    Returns:
        Positions (t, k) [rad] and speeds (t, k) [rad/s] at the steps; the last one stands still.
    """
    lengths = np.max(np.abs(np.diff(points, axis=0)) / limits, axis=1)
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    duration = max(SHORTEST, PEAK * along[-1] / pace)
    t = np.linspace(0.0, 1.0, max(2, int(np.ceil(duration / step))) + 1)[1:]
    where = along[-1] * t * t * (3 - 2 * t)
    positions = np.column_stack([np.interp(where, along, column) for column in points.T])
    if len(points) > 2:
        positions = _rounded(positions, points[0], max(1, round(ROUNDING / step / 2)))
    before = np.vstack([points[:1], positions[:-1]])
    speeds = (positions - before) / step
    speeds[-1] = 0.0
    return positions, speeds


def passed(positions: Array, apart: float) -> Array:
    """Some of the positions (t, k) of a run, the first and the last among them.

    Args:
        positions: at the steps of the run [rad].
        apart: how far a joint turns from one chosen position to the next, rounded up to a step
            of the run [rad].
    """
    turned = np.append(0.0, np.cumsum(np.abs(np.diff(positions, axis=0)).max(axis=1)))
    chosen = np.searchsorted(turned, np.arange(0.0, turned[-1], apart))
    return positions[[*chosen, -1]]


def _rounded(positions: Array, start: Array, half: int) -> Array:
    """The running mean over 2 half + 1 positions, from a standing start to a standing end."""
    before, after = (np.repeat(end[None], 2 * half, axis=0) for end in (start, positions[-1]))
    total = np.cumsum(np.vstack([0 * start[None], before, positions, after]), axis=0)
    window = 2 * half + 1
    return np.vstack([(total[window:] - total[:-window]) / window, positions[-1:]])
