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
from numpy.lib.stride_tricks import sliding_window_view

from . import poses
from .clouds import Label, Surroundings, level_direction, spread
from .poses import Array
from .robots import Gripper

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
    found: list[Array] = []
    widths: list[Array] = []
    too_wide = blocked = 0
    for rotation in hand_directions(level_direction(wanted) + turn):
        sections = _Sections.along(rotation, samples, surroundings, gripper)
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
        cls, rotation: Array, samples: Array, surroundings: Surroundings, gripper: Gripper
    ) -> _Sections:
        points, starts = surroundings.points @ rotation, samples @ rotation
        tips = _tip_depths(rotation, samples, surroundings.table, gripper)  # (s, t)
        possible = tips[:, 0] > 0
        if not possible.any():
            return cls(np.zeros((0, 3)), np.zeros(0), 0, 0)
        starts, tips = starts[possible], tips[possible]
        starts[:, :2] = np.rint(starts[:, :2] / BIN) * BIN  # bins begin where samples are
        ahead = _ahead(points, surroundings.labels, starts, gripper.finger_width / 2)
        nearest = ahead.min(axis=(0, 2))
        wanted, other = ahead[:, :, None] <= np.maximum.accumulate(tips, axis=1)[..., None]
        room = round((gripper.finger_thickness + 2 * SIDE_CLEARANCE) / BIN)
        left, right = _ends(wanted | other, room)
        width = (left + right - 1) * BIN
        reach = np.arange(-HALF_BINS, HALF_BINS + 1)
        left_end, right_end = -left[..., None], right[..., None]
        at_left = (reach > left_end - room) & (reach <= left_end + PART_BINS)
        at_right = (reach < right_end + room) & (reach >= right_end - PART_BINS)
        clear = ~np.any(other & (at_left | at_right), axis=-1)
        narrow = width + 2 * SIDE_CLEARANCE <= gripper.opening
        shallow = tips <= (np.minimum(nearest, 0.0) + gripper.tip - gripper.palm)[:, None]
        ok = clear & narrow & shallow & (tips > 0) & (left < HALF_BINS) & (right < HALF_BINS)
        row, depth = np.nonzero(ok)
        shift = (right - left)[row, depth] * BIN / 2
        centres = starts[row] + np.column_stack([0 * shift, shift, tips[row, depth] - gripper.tip])
        alone = (sum(_ends(wanted, room)) - 1) * BIN + 2 * SIDE_CLEARANCE
        too_wide = int(np.sum(alone > gripper.opening))
        blocked = int(np.sum(~(clear & narrow & shallow))) - too_wide
        return cls(centres, width[row, depth], too_wide, max(0, blocked))


def _tip_depths(rotation: Array, samples: Array, table: float, gripper: Gripper) -> Array:
    """How far the tips go below each sample (s, t) [m]; -1 where the table is in the way."""
    down = -rotation[2, 2]
    finger = gripper.finger_width / 2 * abs(rotation[2, 0])
    finger += gripper.finger_thickness * abs(rotation[2, 1])
    along_x, along_y = gripper.palm_size
    palm = along_x / 2 * abs(rotation[2, 0]) + along_y / 2 * abs(rotation[2, 1])
    palm += (gripper.palm - gripper.tip) * down
    lowest = max(finger, palm)  # of the hand below its tips
    room = (samples[:, 2] - table - TABLE_CLEARANCE - lowest) / max(down, 1e-6)
    depths = np.minimum(np.array(TIP_DEPTHS), room[:, None])
    fresh = np.diff(depths, prepend=0.0, axis=1) > 0.25 * TIP_DEPTHS[0]
    return np.where(fresh, depths, -1.0)


def _ahead(points: Array, labels: np.ndarray, starts: Array, half: float) -> Array:
    """How far below each sample the first point lies that a finger would meet (2, s, bins) [m].

    For the wanted part and for all else, in each bin beside the sample; inf where there is none.

    Args:
        points: (n, 3), z the way the hand comes, y the way the fingers close [m].
        labels: (n,) of `Label`.
        starts: the samples (s, 3), x and y whole multiples of `BIN` [m].
        half: of the width of a finger along x [m].
    """
    margin = np.array([round(half / BIN), HALF_BINS])
    corner = starts[:, :2].min(axis=0) - margin * BIN
    cells = np.rint((points[:, :2] - corner) / BIN).astype(int)
    middles = np.rint((starts[:, :2] - corner) / BIN).astype(int)
    size = middles.max(axis=0) + margin + 1
    inside = np.all((cells >= 0) & (cells < size), axis=1)
    place = (labels[inside] != Label.WANTED) * size[0] + cells[inside, 0]
    first = np.full(2 * size[0] * size[1], np.inf)
    np.minimum.at(first, place * size[1] + cells[inside, 1], points[inside, 2])
    swept = _least_of(first.reshape(2, *size), 2 * int(margin[0]) + 1)
    beside = sliding_window_view(swept, 2 * HALF_BINS + 1, axis=2)
    x, y = (middles - margin).T
    return beside[:, x, y] - starts[:, 2, None]


def _least_of(grid: Array, count: int) -> Array:
    """The least of each `count` rows of a grid (k, rows, columns) that follow each other."""
    size = 1
    while size < count:
        step = min(size, count - size)
        grid = np.minimum(grid[:, :-step], grid[:, step:])
        size += step
    return grid


def _ends(full: np.ndarray, room: int) -> tuple[np.ndarray, np.ndarray]:
    """Bins from the middle to the first room for a finger, to the left and to the right."""
    return _first_room(full[..., ::-1], room), _first_room(full, room)


def _first_room(full: np.ndarray, room: int) -> np.ndarray:
    """Bins from the middle to the first run of `room` empty ones; half of them if there is none."""
    middle = full.shape[-1] // 2
    total = np.cumsum(full[..., middle:], axis=-1, dtype=np.int16)
    empty = total[..., room:] == total[..., :-room]  # bins i+1 .. i+room are empty
    first = np.argmax(empty, axis=-1) + 1
    return np.where(empty.any(axis=-1), first, middle)
