# SPDX-License-Identifier: Apache-2.0
"""How well the pads would hold the part: width profiles between them, and what is in the way.

For each pose of the hand the points between the pads are sorted into cells of the pad's face. The
outermost point of each cell on either side is the profile that the pad meets. Where both profiles
are level over the same cells, the pads lie flat on opposite faces and the grasp is antipodal: the
line between the contacts lies inside both friction cones (ten Pas & Platt 2015). A profile that
goes on outwards beyond the tips is a slope that would push the fingers open.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from . import poses
from .clouds import Label, Surroundings
from .poses import Array
from .robots import Gripper

CELLS_X, CELLS_Z = 5, 3  # of a pad's face
LEVEL = 0.0012  # [m], how far a cell may lie behind the outermost one and still be touched
PART_CLEARANCE = 0.004  # [m] from the pads to any other part of the object
SWEEP_CLEARANCE = 0.002  # [m] from the moving hand to the points of anything
SPARE = 0.008  # [m] the open hand is wider than the part, on each side
BEYOND = 0.006  # [m] below the tips in which the part must not go on outwards
OUTWARD = 0.0015  # [m], more than this is outwards
LEVER_SCALE = 0.15  # [m], a lever arm that costs as much as the worst support
TABLE_CLEARANCE = 0.0008  # [m] from the hand to the table

# Weights of the score: 1 is a flat, vertical grasp at the centre of mass.
_BASE, _SUPPORT, _OVERLAP, _LEVER, _TILT, _WIDE = 0.25, 0.35, 0.4, 0.45, 0.12, 0.1
LEAST_CELLS = 1.5 / (CELLS_X * CELLS_Z)  # share of cells that both pads must touch


@dataclass(frozen=True)
class Holds:
    """What was found for c poses of the hand.

    Attributes:
        world_from_grip: (c, 4, 4), the part centred between the pads.
        width: (c,) of the part between the pads [m].
        opening: (c,) of the hand before it closes [m].
        score: (c,), at most 1; what is not above 0 must not be tried.
        obstacle: (c,) of `Obstacle`, why a pose is ruled out.
    """

    world_from_grip: Array
    width: Array
    opening: Array
    score: Array
    obstacle: np.ndarray

    def __getitem__(self, index: np.ndarray) -> Holds:
        """Some of them."""
        return Holds(
            self.world_from_grip[index],
            self.width[index],
            self.opening[index],
            self.score[index],
            self.obstacle[index],
        )

    def joined(self, other: Holds) -> Holds:
        """These and the other ones."""
        return Holds(
            np.concatenate([self.world_from_grip, other.world_from_grip]),
            np.concatenate([self.width, other.width]),
            np.concatenate([self.opening, other.opening]),
            np.concatenate([self.score, other.score]),
            np.concatenate([self.obstacle, other.obstacle]),
        )


OBSTACLES = ("", "too_wide", "slope", "uneven", "part", "neighbour", "table")
_NONE, _TOO_WIDE, _SLOPE, _UNEVEN, _PART, _NEIGHBOUR, _TABLE = range(len(OBSTACLES))


def judge(world_from_grip: Array, surroundings: Surroundings, gripper: Gripper) -> Holds:
    """Judge poses of the hand (c, 4, 4) round the wanted part."""
    if not len(world_from_grip):
        empty = np.zeros(0)
        return Holds(np.zeros((0, 4, 4)), empty, empty, empty, np.zeros(0, dtype=int))
    grip_from_world = poses.inverse(world_from_grip)
    local = poses.transform(grip_from_world, surroundings.points)  # (c, n, 3)
    wanted = surroundings.labels == Label.WANTED
    shift, width = _centre(local, wanted, gripper)
    local[..., 1] -= shift[:, None]
    centred = world_from_grip @ _sideways(shift)
    opening = np.minimum(width + 2 * SPARE, gripper.opening)
    support, overlap = _profile(local, wanted, width, gripper)
    obstacle = _obstacle(local, surroundings.labels, width, opening, gripper)
    obstacle[(obstacle == _NONE) & (overlap < LEAST_CELLS)] = _UNEVEN
    obstacle[_hits_table(centred, opening, surroundings.table, gripper)] = _TABLE
    obstacle[width > gripper.opening - 2 * SWEEP_CLEARANCE] = _TOO_WIDE
    score = (
        _BASE
        + _SUPPORT * support
        + _OVERLAP * overlap
        - _LEVER * _lever(centred, surroundings.balance) / LEVER_SCALE
        - _TILT * (1 + centred[:, 2, 2])
        - _WIDE * width / gripper.opening
    )
    return Holds(centred, width, opening, np.where(obstacle == _NONE, score, -1.0), obstacle)


def _sideways(shift: Array) -> Array:
    move = np.tile(np.eye(4), (len(shift), 1, 1))
    move[:, 1, 3] = shift
    return move


def _band(local: Array, gripper: Gripper) -> np.ndarray:
    """Which points (c, n) lie between the pads."""
    return (np.abs(local[..., 0]) <= gripper.pad_width / 2) & (
        np.abs(local[..., 2]) <= gripper.pad_length / 2
    )


def _centre(local: Array, wanted: np.ndarray, gripper: Gripper) -> tuple[Array, Array]:
    """Middle and width (c,) [m] of the part between the pads."""
    band = _band(local, gripper) & wanted & (np.abs(local[..., 1]) <= gripper.opening / 2)
    high = np.max(np.where(band, local[..., 1], -np.inf), axis=1)
    low = np.min(np.where(band, local[..., 1], np.inf), axis=1)
    some = band.any(axis=1)
    width = np.where(some, high - low, np.inf)
    return np.where(some, (high + low) / 2, 0.0), width


def _profile(
    local: Array, wanted: np.ndarray, width: Array, gripper: Gripper
) -> tuple[Array, Array]:
    """Share of the pad's cells touched: the worse side's, and both sides' over the same cells."""
    band = _band(local, gripper) & wanted & (np.abs(local[..., 1]) <= width[:, None] / 2 + 1e-9)
    row, point = np.nonzero(band)
    x, y, z = local[row, point].T
    cell_x = np.clip((x / gripper.pad_width + 0.5) * CELLS_X, 0, CELLS_X - 1).astype(int)
    cell_z = np.clip((z / gripper.pad_length + 0.5) * CELLS_Z, 0, CELLS_Z - 1).astype(int)
    cell = row * CELLS_X * CELLS_Z + cell_x * CELLS_Z + cell_z
    level = width[row] / 2 - LEVEL
    count = len(local) * CELLS_X * CELLS_Z
    right = np.bincount(cell[y >= level], minlength=count).reshape(len(local), -1) > 0
    left = np.bincount(cell[y <= -level], minlength=count).reshape(len(local), -1) > 0
    worse = np.minimum(right.mean(axis=1), left.mean(axis=1))
    return worse, (right & left).mean(axis=1)


def _obstacle(
    local: Array, labels: np.ndarray, width: Array, opening: Array, gripper: Gripper
) -> np.ndarray:
    x, y, z = np.abs(local[..., 0]), np.abs(local[..., 1]), local[..., 2]
    half = (width / 2)[:, None]
    on_finger = x <= gripper.finger_width / 2
    beyond = (z > gripper.tip) & (z <= gripper.tip + BEYOND)
    slope = on_finger & beyond & (y > half + OUTWARD) & (y < half + gripper.finger_thickness)
    swept = _swept(x, y, z, (opening / 2)[:, None], gripper)
    near = (
        (x <= gripper.finger_width / 2 + PART_CLEARANCE)
        & (z <= gripper.tip + PART_CLEARANCE)
        & (y <= (opening / 2)[:, None] + gripper.finger_thickness)
    )
    own, other = labels == Label.WANTED, labels == Label.OTHER_PART
    result = np.full(len(local), _NONE)
    result[np.any((slope | swept) & own, axis=1)] = _SLOPE
    result[np.any((slope | swept | near) & other, axis=1)] = _PART
    result[np.any((slope | swept | near) & (labels == Label.NEIGHBOUR), axis=1)] = _NEIGHBOUR
    return result


def _swept(x: Array, y: Array, z: Array, half_open: Array, gripper: Gripper) -> np.ndarray:
    """Which points (c, n) the fingers and the palm of the open hand would run into."""
    in_width = x <= gripper.finger_width / 2 + SWEEP_CLEARANCE
    outside = y >= half_open - SWEEP_CLEARANCE
    finger = outside & (y <= half_open + gripper.finger_thickness + SWEEP_CLEARANCE)
    finger &= z <= gripper.tip + SWEEP_CLEARANCE
    root = outside & (y <= half_open + gripper.root_thickness) & (z <= gripper.root)
    along_x, along_y = gripper.palm_size
    palm = (x <= along_x / 2) & (y <= along_y / 2) & (z <= gripper.palm + SWEEP_CLEARANCE)
    return (in_width & (finger | root)) | palm


def _hits_table(
    world_from_grip: Array, opening: Array, table: float, gripper: Gripper
) -> np.ndarray:
    half_x, tip = gripper.finger_width / 2, gripper.tip
    outer = opening / 2 + gripper.finger_thickness
    root = opening / 2 + gripper.root_thickness
    palm_x, palm_y = (size / 2 for size in gripper.palm_size)
    lowest = np.minimum.reduce(
        [
            _lowest(world_from_grip, half_x, outer, tip),
            _lowest(world_from_grip, half_x, root, gripper.root),
            _lowest(world_from_grip, palm_x, np.full_like(opening, palm_y), gripper.palm),
        ]
    )
    return lowest < table + TABLE_CLEARANCE


def _lowest(world_from_grip: Array, x: float, y: Array, z: float) -> Array:
    """Height of the lowest of the corners (+-x, +-y, z) of the hand (c,) [m]."""
    up = world_from_grip[:, 2]
    return up[:, 3] + z * up[:, 2] - x * np.abs(up[:, 0]) - y * np.abs(up[:, 1])


def _lever(world_from_grip: Array, balance: Array) -> Array:
    """Arm (c,) [m] on which the weight turns the part about the line between the pads."""
    arm = balance - world_from_grip[:, :3, 3]
    across = np.cross(arm, world_from_grip[:, :3, 1])
    # Weight pulls down: of the moment arm x down, the share about the closing direction turns.
    level = np.abs(across[:, 2])
    return level + 0.3 * np.linalg.norm(arm, axis=1)
