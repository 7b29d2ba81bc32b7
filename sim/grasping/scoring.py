# SPDX-License-Identifier: Apache-2.0
"""How well the pads would hold the part: width profiles between them, and what is in the way.

For each pose of the hand the points between the pads are sorted into cells of the pad's face. The
outermost point of each cell on either side is the profile that the pad meets. Where both profiles
are level over the same cells, the pads lie flat on opposite faces and the grasp is antipodal: the
line between the contacts lies inside both friction cones (ten Pas & Platt 2015). A profile that
goes on outwards beyond the tips is a slope that would push the fingers open.
"""

from __future__ import annotations

from dataclasses import dataclass, fields

import numpy as np

from ..poses import Array
from ..robot.models import Gripper
from .nearness import HandPointPairs
from .point_clouds import Label, Surroundings

CELLS_X, CELLS_Z = 5, 6  # of a pad's face
LEVEL = 0.0012  # [m], how far a cell may lie behind the outermost one and still be touched
PART_CLEARANCE = 0.004  # [m] from the pads to any other part of the object
RECESS = 0.003  # [m] that another part between the fingers stands back from the pads
SWEEP_CLEARANCE = 0.002  # [m] from the moving hand to the points of anything
SPARE = 0.008  # [m] the open hand is wider than the part, on each side
SPARE_NEXT_TO = 0.0045  # [m] the same where a neighbour stands close
SPARE_ABOVE = 0.004  # [m] the same for what is between the fingers above the pads
BEYOND = 0.006  # [m] below the tips in which the part must not go on outwards
OUTWARD = 0.003  # [m], more than this is outwards: a slope of 27 degrees
GRAVITY = 9.81  # [m/s^2]
TORQUE_SCALE = 0.3  # [N m], a weight that costs all of `_TORQUE`; more may turn in the hand
REACH_SCALE = 0.5  # [m], the same for the distance to the centre of mass
TABLE_CLEARANCE = 0.0008  # [m] from the hand to the table

ROUNDING = 1e-6  # [m], more than single precision loses
RULED_OUT = 10.0  # taken from the score of a pose that something is in the way of

DEEP_ROWS = 3  # of cells, from the tips; a thing held by less pops out when it is moved
BITE = 0.002  # [m] above the ends of the pads; what they touch lower down is squeezed out of them
HEAVY, TOO_HEAVY = 0.25, 0.65  # [N m]; between them a weight more and more surely turns in the hand

# Weights of the score: 1 is a flat, vertical grasp at the centre of mass.
_BASE, _AREA, _ACROSS, _DEPTH = 0.35, 0.1, 0.3, 0.3
_TORQUE, _REACH, _TILT, _WIDE, _WEDGE, _SQUEEZED = 0.3, 0.3, 0.1, 0.1, 1.0, 0.2
# Shares that a score loses: what holds badly comes last, and is still better than nothing.
_SHALLOW, _TURNING = 0.6, 0.6
LEAST_CELLS = 2.5 / (CELLS_X * CELLS_Z)  # share of cells that both pads must touch


@dataclass(frozen=True)
class GraspScores:
    """What was found for c poses of the hand.

    Attributes:
        world_from_grip: (c, 4, 4), the part centred between the pads.
        width: (c,) of the part between the pads [m].
        between: (c,) of all that is between the fingers [m].
        opening: (c,) of the hand before it closes [m].
        score: (c,), at most 1; what is not above 0 must not be tried.
        obstacle: (c,), index in `OBSTACLES` of what rules a pose out; 0 for nothing.
        slope: (c, 2), how much the part grows wider along x and z of the grip, per side.
        twist: (c,), how far the faces are turned about the approach against the pads [rad].
    """

    world_from_grip: Array
    width: Array
    between: Array
    opening: Array
    score: Array
    obstacle: np.ndarray
    slope: Array
    twist: Array

    def __getitem__(self, index: np.ndarray) -> GraspScores:
        """Some of them."""
        return GraspScores(*(getattr(self, field.name)[index] for field in fields(self)))

    def joined(self, other: GraspScores) -> GraspScores:
        """These and the other ones."""
        return GraspScores(
            *(
                np.concatenate([getattr(self, field.name), getattr(other, field.name)])
                for field in fields(self)
            )
        )


OBSTACLES = ("", "too_wide", "slope", "uneven", "part", "neighbour", "table")
_NONE, _TOO_WIDE, _SLOPE, _UNEVEN, _PART, _NEIGHBOUR, _TABLE = range(len(OBSTACLES))


def judge(
    world_from_grip: Array, between: Array, surroundings: Surroundings, gripper: Gripper
) -> GraspScores:
    """Judge poses of the hand round the wanted part.

    Args:
        world_from_grip: (c, 4, 4).
        between: (c,), width of all that will be between the fingers, not only the pads [m].
        surroundings: the part, and what is near it.
        gripper: the hand.
    """
    near = HandPointPairs.to(
        world_from_grip,
        surroundings,
        aside=max(gripper.palm_size[0] / 2, gripper.finger_width / 2 + PART_CLEARANCE),
        ahead=gripper.tip + max(BEYOND, PART_CLEARANCE),
    )
    shift, width = _centre(near, gripper)
    near = near.moved(shift)
    centred = world_from_grip @ _sideways(shift)
    wide, narrow = _openings(width, between + 2 * (np.abs(shift) + SPARE_ABOVE), gripper)
    profile = _Profile.between(near, width, gripper)
    touched = profile.touched(width)  # (c, 2, CELLS_X, CELLS_Z)
    both = np.logical_and(
        *np.moveaxis(_between(touched), 1, 0)
    )  # (c, CELLS_X, CELLS_Z), cells that both pads rest on
    overlap = both.mean(axis=(1, 2))
    obstacle = _obstacle(near, width, wide, gripper)
    squeezed = obstacle == _NEIGHBOUR  # a hand that is less open may fit in between
    opening = np.where(squeezed, narrow, wide)
    if squeezed.any():
        obstacle = _obstacle(near, width, opening, gripper)
    obstacle[(obstacle == _NONE) & (overlap < LEAST_CELLS)] = _UNEVEN
    obstacle[hits_table(centred, opening, surroundings.table, gripper)] = _TABLE
    obstacle[width > gripper.opening - 2 * SWEEP_CLEARANCE] = _TOO_WIDE
    slope, twist = profile.slopes(gripper)
    arm = surroundings.balance - centred[:, :3, 3]
    torque = surroundings.mass * GRAVITY * turning_arm(centred, arm)
    score = (
        _BASE
        + _AREA * overlap
        + _ACROSS * both.max(axis=2).mean(axis=1)
        + _DEPTH * np.minimum(_rows_from_tip(both) / DEEP_ROWS, 1.0)
        - _TORQUE * torque / TORQUE_SCALE
        - _REACH * np.linalg.norm(arm, axis=1) / REACH_SCALE
        - _TILT * (1 + centred[:, 2, 2])
        - _WEDGE * np.abs(slope).max(axis=1)
        - _WIDE * width / gripper.opening
        - _SQUEEZED * squeezed
    )
    shallow = np.clip(1 - _bite(near, width, gripper) / BITE, 0.0, 1.0)
    turning = np.clip((torque - HEAVY) / (TOO_HEAVY - HEAVY), 0.0, 1.0)
    score *= (1 - _SHALLOW * shallow) * (1 - _TURNING * turning)
    score = np.where(obstacle == _NONE, score, score - RULED_OUT)
    return GraspScores(centred, width, between, opening, score, obstacle, slope, twist)


def _openings(width: Array, least: Array, gripper: Gripper) -> tuple[Array, Array]:
    """How far the hand is opened (c,) for a part, with much and with little to spare [m]."""
    wide, narrow = (
        np.minimum(np.maximum(width + 2 * spare, least), gripper.opening)
        for spare in (SPARE, SPARE_NEXT_TO)
    )
    return wide, narrow


def _sideways(shift: Array) -> Array:
    move = np.tile(np.eye(4), (len(shift), 1, 1))
    move[:, 1, 3] = shift
    return move


def _centre(near: HandPointPairs, gripper: Gripper) -> tuple[Array, Array]:
    """Middle and width (c,) [m] of the part between the pads."""
    band = near.in_band(gripper) & (np.abs(near.y) <= gripper.opening / 2)
    far = gripper.opening  # an empty band counts as twice as wide as the hand
    high, low = np.full(near.hands, -far), np.full(near.hands, far)
    np.maximum.at(high, near.hand[band], near.y[band])
    np.minimum.at(low, near.hand[band], near.y[band])
    width = np.where(high >= low, high - low, 2 * far)
    return np.where(high >= low, (high + low) / 2, 0.0), width


@dataclass(frozen=True)
class _Profile:
    """What the pads meet, told outwards from the middle: heights (c, 2, CELLS_X, CELLS_Z) [m].

    Cells that hold no point have the height -inf.
    """

    heights: Array

    @classmethod
    def between(cls, near: HandPointPairs, width: Array, gripper: Gripper) -> _Profile:
        inside = np.abs(near.y) <= (width / 2 + ROUNDING)[near.hand]
        band = near.in_band(gripper) & inside
        hand = near.hand[band]
        x, y, z = (each[band] for each in (near.x, near.y, near.z))
        cell_x = np.clip((x / gripper.pad_width + 0.5) * CELLS_X, 0, CELLS_X - 1).astype(int)
        cell_z = np.clip((z / gripper.pad_length + 0.5) * CELLS_Z, 0, CELLS_Z - 1).astype(int)
        cell = (hand * CELLS_X + cell_x) * CELLS_Z + cell_z
        heights = np.full((2, near.hands * CELLS_X * CELLS_Z), -np.inf)
        for side, outwards in enumerate((y, -y)):
            np.maximum.at(heights[side], cell, outwards)
        # A cell whose points all lie on the other side is empty on this one.
        heights[heights < 0] = -np.inf
        shaped = heights.reshape(2, near.hands, CELLS_X, CELLS_Z)
        return cls(np.ascontiguousarray(np.swapaxes(shaped, 0, 1)))

    def touched(self, width: Array) -> np.ndarray:
        """Which cells (c, 2, CELLS_X, CELLS_Z) the pads touch."""
        return self.heights >= (width / 2 - LEVEL)[:, None, None, None]

    def slopes(self, gripper: Gripper) -> tuple[Array, Array]:
        """How the faces lie against the pads: the `slope` (c, 2) and `twist` (c,) of `GraspScores`.

        A slope is the mean of both sides: a wedge, that is squeezed out of the hand. A round bar
        has none. A twist is their difference: parallel faces that the hand could be turned along.
        """
        across = _slopes(self.heights.max(axis=3), gripper.pad_width / CELLS_X)
        along = _slopes(self.heights.max(axis=2), gripper.pad_length / CELLS_Z)
        slope = np.column_stack([across.mean(axis=1), along.mean(axis=1)])
        return slope, np.arctan((across[:, 0] - across[:, 1]) / 2)


def _bite(near: HandPointPairs, width: Array, gripper: Gripper) -> Array:
    """How far up from the ends of the pads they touch the part in the mean (c,) [m].

    Of the two pads, the one that has less of it counts. Cells tell it too coarsely: a plate that
    the pads just reach fills a whole row of them.
    """
    beyond_level = np.abs(near.y) >= (width / 2 - LEVEL)[near.hand]
    touched = near.in_band(gripper) & beyond_level
    sides = []
    for side in (near.y > 0, near.y <= 0):
        hand = near.hand[touched & side]
        up = gripper.pad_length / 2 - near.z[touched & side]
        count = np.bincount(hand, minlength=near.hands)
        sides.append(np.bincount(hand, up, near.hands) / np.maximum(count, 1))
    return np.minimum(*sides)


def _between(touched: np.ndarray) -> np.ndarray:
    """The cells touched, and those between them: a pad on a hollow rests on its edges."""
    for axis in (2, 3):
        before = np.logical_or.accumulate(touched, axis=axis)
        after = np.flip(np.logical_or.accumulate(np.flip(touched, axis), axis=axis), axis)
        touched = before & after
    return touched


def _rows_from_tip(cells: np.ndarray) -> np.ndarray:
    """How many rows (c,) up from the tips the pads rest on the part, the rows below included."""
    rows = cells.max(axis=1)  # (c, CELLS_Z)
    return np.max(rows * (CELLS_Z - np.arange(CELLS_Z)), axis=1)


def _slopes(edges: Array, spacing: float) -> Array:
    """Slopes (c, 2) of edges (c, 2, n) by least squares, over the cells filled on both sides."""
    filled = np.isfinite(edges[:, 0]) & np.isfinite(edges[:, 1])
    place = np.arange(edges.shape[-1]) * spacing
    middle = (filled * place).sum(axis=1) / np.maximum(filled.sum(axis=1), 1)
    centred = np.where(filled, place - middle[:, None], 0.0)
    spread = np.maximum((centred**2).sum(axis=1), spacing**2 / 2)
    heights = np.where(filled[:, None], edges, 0.0)
    return np.einsum("cn,csn->cs", centred, heights) / spread[:, None]


def _obstacle(near: HandPointPairs, width: Array, opening: Array, gripper: Gripper) -> np.ndarray:
    x, y, z = np.abs(near.x), np.abs(near.y), near.z
    half, half_open = (width / 2)[near.hand], (opening / 2)[near.hand]
    on_finger = x <= gripper.finger_width / 2
    beyond = (z > gripper.tip) & (z <= gripper.tip + BEYOND)
    slope = on_finger & beyond & (y > half + OUTWARD) & (y < half + gripper.finger_thickness)
    hit = slope | _swept(x, y, z, half_open, gripper)
    # Between the fingers may be more of the thing that stands back from the pads; no neighbour.
    close = (
        (x <= gripper.finger_width / 2 + PART_CLEARANCE)
        & (z <= gripper.tip + PART_CLEARANCE)
        & (y <= half_open + gripper.finger_thickness)
    )
    beside = close & (y >= half - RECESS)
    result = np.full(near.hands, _NONE)
    result[near.any(hit & (near.label == Label.WANTED))] = _SLOPE
    result[near.any((hit | beside) & (near.label == Label.OTHER_PART))] = _PART
    result[near.any((hit | close) & (near.label == Label.NEIGHBOUR))] = _NEIGHBOUR
    return result


def _swept(x: Array, y: Array, z: Array, half_open: Array, gripper: Gripper) -> np.ndarray:
    """Which points (p,) the fingers and the palm of the open hand would run into."""
    in_width = x <= gripper.finger_width / 2 + SWEEP_CLEARANCE
    outside = y >= half_open - SWEEP_CLEARANCE
    finger = outside & (y <= half_open + gripper.finger_thickness + SWEEP_CLEARANCE)
    finger &= z <= gripper.tip + SWEEP_CLEARANCE
    root = outside & (y <= half_open + gripper.root_thickness) & (z <= gripper.root)
    along_x, along_y = gripper.palm_size
    palm = (x <= along_x / 2) & (y <= along_y / 2) & (z <= gripper.palm + SWEEP_CLEARANCE)
    return (in_width & (finger | root)) | palm


def hits_table(
    world_from_grip: Array, opening: Array, table: float, gripper: Gripper
) -> np.ndarray:
    """Which of the hands (c,), open by `opening` [m], would run into the table."""
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


def turning_arm(world_from_grip: Array, arm: Array) -> Array:
    """Lever (c,) [m] on which the weight turns a thing about the line between the pads.

    Args:
        world_from_grip: (c, 4, 4).
        arm: from there to the centre of mass (c, 3) [m].
    """
    # Weight pulls straight down: of arm x down, the share along the closing direction turns.
    return np.abs(np.cross(arm, world_from_grip[:, :3, 1])[:, 2])
