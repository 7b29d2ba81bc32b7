# SPDX-License-Identifier: Apache-2.0
"""Hand poses worth a closer look: where two fingers find room on both sides of the wanted part.

From points spread over the part and a fixed set of hand directions, each pose is judged by one
row of bins along the closing direction: the first point that a finger would meet is kept in each,
and beside the part there must be room for a finger on either side, with the part narrower than
the hand and nothing else between the fingers. Thin plates rule out surface normals (a plate of
2 mm has none that can be trusted), so the direction is tried, not derived.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from .. import poses
from ..poses import Array
from ..robot.models import Gripper
from .point_clouds import Label, Surroundings, level_direction, spread

BIN = 0.002  # [m] along the closing direction
HALF_BINS = 52  # a section may lie wholly on one side of its sample: 104 mm
PART_BINS = 1  # at either end of the section, where nothing but the wanted part may be
TIP_DEPTHS = (0.003, 0.008, 0.014)  # [m] of the finger tips below the sample
TABLE_CLEARANCE = 0.001  # [m] between the tips and the table
SIDE_CLEARANCE = 0.0035  # [m] between a finger and the part as the hand comes down
TILTS_DEG = ((25.0, 8, 6), (50.0, 8, 6), (75.0, 12, 6))  # tilt, headings, rolls
LEVEL_ROLLS = 24  # for the hand that looks straight down


@dataclass(frozen=True)
class HandPoses:
    """Poses of the open hand.

    Attributes:
        world_from_grip: (c, 4, 4).
        width: (c,) of what is between the fingers [m].
        too_wide: how many places were wider than the hand.
        blocked: how many had no room for the fingers.
    """

    world_from_grip: Array
    width: Array
    too_wide: int
    blocked: int


def hand_directions(heading: float) -> Array:
    """Rotations `world_from_grip` (d, 3, 3) that are tried, turned by `heading` [rad]."""
    down = poses.rotation_about((1.0, 0.0, 0.0), np.pi)
    rolls = poses.rotation_about((0, 0, 1), heading + np.arange(LEVEL_ROLLS) * np.pi / LEVEL_ROLLS)
    result = [rolls @ down]
    for tilt_deg, headings, roll_count in TILTS_DEG:
        tilt = poses.rotation_about((0, 1, 0), np.radians(tilt_deg))
        around = poses.rotation_about(
            (0, 0, 1), heading + np.arange(headings) * 2 * np.pi / headings
        )
        roll = poses.rotation_about((0, 0, 1), np.arange(roll_count) * np.pi / roll_count)
        tilted = around[:, None] @ tilt @ down @ roll[None]
        result.append(tilted.reshape(-1, 3, 3))
    return np.concatenate(result)


def propose(
    surroundings: Surroundings,
    gripper: Gripper,
    *,
    rng: np.random.Generator,
    count: int,
    turn: float = 0.0,
) -> HandPoses:
    """Poses of the open hand round points of the wanted part.

    Args:
        surroundings: the part, and what is near it.
        gripper: the hand.
        rng: at which point to begin.
        count: of points.
        turn: of all directions about the vertical, for a look from between those of turn 0 [rad].
    """
    wanted = surroundings.wanted
    samples = wanted[spread(wanted, count, first=int(rng.integers(len(wanted))))]
    found, widths = [np.zeros((0, 4, 4))], [np.zeros(0)]
    too_wide = blocked = 0
    rotations = hand_directions(level_direction(wanted) + turn)
    depths = _tip_depths(rotations, samples, surroundings.table, gripper)
    for rotation, tips in zip(rotations, depths, strict=True):
        possible = tips[:, 0] > 0
        if not possible.any():
            continue
        sections = _Sections.along(
            rotation, samples[possible], tips[possible], surroundings, gripper
        )
        too_wide += sections.too_wide
        blocked += sections.blocked
        found.append(poses.pose(rotation, sections.centres @ rotation.T))
        widths.append(sections.width)
    return HandPoses(np.concatenate(found), np.concatenate(widths), too_wide, blocked)


@dataclass(frozen=True)
class _Sections:
    """Cuts through the part that fit between the fingers, for one direction of the hand."""

    centres: Array  # (c, 3) of the grip frame, in the directions of the hand [m]
    width: Array  # (c,) [m]
    too_wide: int
    blocked: int

    @classmethod
    def along(
        cls,
        rotation: Array,
        samples: Array,
        tips: Array,
        surroundings: Surroundings,
        gripper: Gripper,
    ) -> _Sections:
        points, starts = rotation.T @ surroundings.points.T, samples @ rotation
        starts[:, :2] = np.rint(starts[:, :2] / BIN) * BIN  # bins begin where samples are
        ahead = _Ahead.of(points, surroundings.labels, starts, gripper.finger_width / 2)
        room = round((gripper.finger_thickness + 2 * SIDE_CLEARANCE) / BIN)
        below = starts[:, 2, None] + np.maximum.accumulate(tips, axis=1)  # (s, t)
        (left, right), alone = ahead.ends(below, room)
        width = (left + right - 1) * BIN
        # Beyond its ends there is room, so that all that could be in the way is what ends there.
        clear = ~(ahead.is_other(1 - left, below) | ahead.is_other(right - 1, below))
        narrow = width + 2 * SIDE_CLEARANCE <= gripper.opening
        nearest = np.minimum(ahead.nearest() - starts[:, 2], 0.0)
        shallow = tips <= (nearest + gripper.tip - gripper.palm)[:, None]
        possible = clear & narrow & shallow
        ok = possible & (tips > 0) & (left < HALF_BINS) & (right < HALF_BINS)
        row, depth = np.nonzero(ok)
        shift = (right - left)[row, depth] * BIN / 2
        centres = starts[row] + np.column_stack([0 * shift, shift, tips[row, depth] - gripper.tip])
        alone_width = (alone.sum(axis=0) - 1) * BIN + 2 * SIDE_CLEARANCE
        too_wide = int(np.count_nonzero(alone_width > gripper.opening))
        blocked = int(np.count_nonzero(~possible)) - too_wide
        return cls(centres, width[row, depth], too_wide, max(0, blocked))


def _tip_depths(rotations: Array, samples: Array, table: float, gripper: Gripper) -> Array:
    """How far the tips go below each sample (d, s, t) [m]; -1 where the table is in the way."""
    x, y, z = np.abs(rotations[:, 2, 0]), np.abs(rotations[:, 2, 1]), -rotations[:, 2, 2]
    finger = gripper.finger_width / 2 * x + gripper.finger_thickness * y
    along_x, along_y = gripper.palm_size
    palm = along_x / 2 * x + along_y / 2 * y + (gripper.palm - gripper.tip) * z
    lowest = np.maximum(finger, palm)[:, None]  # of the hand below its tips
    room = (samples[:, 2] - table - TABLE_CLEARANCE - lowest) / np.maximum(z, 1e-6)[:, None]
    depths = np.minimum(np.array(TIP_DEPTHS), room[..., None])
    fresh = np.diff(depths, prepend=0.0, axis=2) > 0.25 * TIP_DEPTHS[0]
    return np.where(fresh, depths, -1.0)


@dataclass(frozen=True)
class _Ahead:
    """Where the first point lies that a finger would meet in each bin, the way the hand comes.

    Attributes:
        first: (2, columns, rows), of all points and of those of the part [m]; inf where there are
            none.
        other: (columns, rows), of the rest [m].
        x, y: (s,), the bins of the samples.
    """

    first: Array
    other: Array
    x: np.ndarray
    y: np.ndarray

    @classmethod
    def of(cls, points: Array, labels: np.ndarray, starts: Array, half: float) -> _Ahead:
        """What is ahead of samples.

        Args:
            points: (3, n), z the way the hand comes, y the way the fingers close [m].
            labels: (n,) of `Label`.
            starts: the samples (s, 3), x and y whole multiples of `BIN` [m].
            half: of the width of a finger along x [m].
        """
        margin = np.array([round(half / BIN), HALF_BINS])
        corner = starts[:, :2].min(axis=0) - margin * BIN
        x, y = (
            np.rint((each - low) / BIN).astype(int)
            for each, low in zip(points[:2], corner, strict=True)
        )
        middles = np.rint((starts[:, :2] - corner) / BIN).astype(int)
        columns, rows = middles.max(axis=0) + margin + 1
        inside = np.flatnonzero((x >= 0) & (x < columns) & (y >= 0) & (y < rows))
        place = (labels[inside] != Label.WANTED) * columns + x[inside]
        first = np.full(2 * columns * rows, np.inf)
        np.minimum.at(first, place * rows + y[inside], points[2, inside])
        wanted, other = _least_of(first.reshape(2, columns, rows), 2 * int(margin[0]) + 1)
        at = middles - (margin[0], 0)
        return cls(np.stack([np.minimum(wanted, other), wanted]), other, at[:, 0], at[:, 1])

    def nearest(self) -> Array:
        """The first of all points beside each sample (s,) [m]."""
        beside = np.arange(-HALF_BINS, HALF_BINS + 1)
        return self.first[0, self.x[:, None], self.y[:, None] + beside].min(axis=1)

    def is_other(self, bins: np.ndarray, below: Array) -> np.ndarray:
        """Whether what is not wanted is met above `below` (s, t) [m], so many bins aside."""
        return self.other[self.x[:, None], self.y[:, None] + bins] <= below

    def ends(self, below: Array, room: int) -> np.ndarray:
        """Bins to the first `room` empty ones, to the left and to the right (2, 2, s, t).

        First among all points, then among those of the part; `HALF_BINS` where there is no room.

        Args:
            below: down to where (s, t) [m].
            room: how many bins a finger needs.
        """
        met = np.swapaxes(_least_of(np.swapaxes(self.first, 1, 2), room), 1, 2)
        steps = np.arange(1, HALF_BINS - room + 2)
        aside = np.stack([1 - room - steps, steps])[:, None]  # (2, 1, n)
        free = met[:, self.x[:, None], self.y[:, None] + aside][..., None, :] > below[..., None]
        found = np.argmax(free, axis=-1)  # 0 also where there is none, which `any` finds out slowly
        return np.where((found > 0) | free[..., 0], found + 1, HALF_BINS)


def _least_of(grid: Array, count: int) -> Array:
    """The least of each `count` rows of a grid (k, rows, columns) that follow each other."""
    size = 1
    while size < count:
        step = min(size, count - size)
        grid = np.minimum(grid[:, :-step], grid[:, step:])
        size += step
    return grid
