"""Scoring of grasp candidates by the contact profiles of the pads and by obstacles.

For each pose of the hand the points between the pads are sorted into cells of the pad's face. The
outermost point of each cell on either side is the profile that the pad meets. Where both profiles
are level over the same cells, the pads lie flat on opposite faces and the grasp is antipodal: the
line between the contacts lies inside both friction cones (ten Pas & Platt 2015). A profile that
continues outwards beyond the tips is a slope that would push the fingers open.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from .. import poses
from ..physics.engine import GRAVITY
from ..poses import Array
from ..robot.models import Gripper
from .context import LabelledPointCloud, PointLabel

CELLS_X, CELLS_Z = 5, 6  # of a pad's face
LEVEL = 0.0012  # [m] that a touched cell may lie behind the outermost one
PART_CLEARANCE = 0.004  # [m] from the pads to any other part of the object
RECESS = 0.003  # [m] that another part between the fingers stands back from the pads
SWEEP_CLEARANCE = 0.002  # [m] from the moving hand to any point
SPARE = 0.008  # [m] that the open gripper is wider than the part, on each side
SPARE_TIGHT = 0.0045  # [m], the same where a neighbour is close
SPARE_ABOVE = 0.004  # [m], the same for what is between the fingers above the pads
BEYOND = 0.006  # [m] below the tips in which the part must not widen
OUTWARD = 0.003  # [m], more is a slope: 27 degrees
TABLE_CLEARANCE = 0.0008  # [m] from the hand to the table
ROUNDING = 1e-6  # [m], more than the error of single precision
REJECTION_PENALTY = 10.0  # taken from the score of a rejected pose

MIN_CELLS = 2.5 / (CELLS_X * CELLS_Z)  # share of cells that both pads must touch
DEEP_ROWS = 3  # of cells, from the tips; objects held by less slip out when moved
PALM_ROOM = 0.012  # [m] before the palm, for what closes rides up between the fingers
MIN_CONTACT_HEIGHT = 0.002  # [m] above the ends of the pads; lower contacts are squeezed out
HEAVY, TOO_HEAVY = 0.25, 0.65  # [N m]; between them an object turns in the hand more and more

# Weights of the score: 1 is a flat, vertical grasp at the centre of mass.
_BASE, _AREA, _ACROSS, _DEPTH = 0.35, 0.1, 0.3, 0.3
_TORQUE, _DISTANCE, _TILT, _WIDE, _WEDGE, _SQUEEZED = 0.3, 0.3, 0.1, 0.1, 1.0, 0.2
TORQUE_SCALE = 0.3  # [N m] of gravity that costs all of `_TORQUE`
DISTANCE_SCALE = 0.5  # [m] to the centre of mass that cost all of `_DISTANCE`
# Shares that a score loses: weak grasps come last, and are still better than none.
_SHALLOW, _TURNING, _PALM = 0.6, 0.6, 0.6

REJECTIONS = ("", "too_wide", "slope", "uneven", "part", "neighbour", "table")
_NONE, _TOO_WIDE, _SLOPE, _UNEVEN, _PART, _NEIGHBOUR, _TABLE = range(len(REJECTIONS))


@dataclass(frozen=True)
class GraspScores:
    """The scores of c poses of the hand."""

    world_from_grip: Array  #: poses (c, 4, 4) of the grip frame, the part amid the pads
    width: Array  #: width of the part between the pads (c,) [m]
    section_width: Array  #: width of everything between the fingers (c,) [m]
    opening: Array  #: opening of the gripper before it closes (c,) [m]
    score: Array  #: scores (c,), at most 1; a pose whose score is not above 0 is rejected
    rejection: np.ndarray  #: index (c,) into `REJECTIONS`; 0 for accepted poses
    slope: Array  #: by how much the part widens along x and z of the grip frame, per side (c, 2)
    twist: Array  #: angle between the faces of the part and the pads, about the approach (c,) [rad]

    def __getitem__(self, index: np.ndarray) -> "GraspScores":
        return GraspScores(*(each[index] for each in vars(self).values()))


def score_grasps(
    world_from_grip: Array, section_width: Array, cloud: LabelledPointCloud, gripper: Gripper
) -> GraspScores:
    """Score poses (c, 4, 4) of the hand round the target of a cloud.

    The width of a section (c,) is that of everything between the fingers, not only the pads [m].
    """
    near = HandPointPairs.find(
        world_from_grip,
        cloud,
        aside=max(gripper.palm_size[0] / 2, gripper.finger_width / 2 + PART_CLEARANCE),
        ahead=gripper.tip + max(BEYOND, PART_CLEARANCE),
    )
    shift, width = _centre(near, gripper)
    near = replace(near, y=near.y - shift[near.hand])
    centred = world_from_grip @ poses.pose(np.eye(3), np.outer(shift, (0, 1, 0)))
    least = section_width + 2 * (np.abs(shift) + SPARE_ABOVE)
    spares = np.array([[SPARE], [SPARE_TIGHT]])
    wide, narrow = np.minimum(np.maximum(width + 2 * spares, least), gripper.opening)
    heights = _contact_profiles(near, width, gripper)
    touched = heights >= (width / 2 - LEVEL)[:, None, None, None]
    first_pad, second_pad = np.moveaxis(_filled(touched), 1, 0)
    both = first_pad & second_pad  # (c, CELLS_X, CELLS_Z)
    overlap = both.mean(axis=(1, 2))
    rejection = _rejection(near, width, wide, gripper)
    squeezed = rejection == _NEIGHBOUR  # a less open gripper may fit in between
    opening = np.where(squeezed, narrow, wide)
    if squeezed.any():
        rejection = _rejection(near, width, opening, gripper)
    rejection[(rejection == _NONE) & (overlap < MIN_CELLS)] = _UNEVEN
    rejection[hits_table(centred, opening, cloud.table, gripper)] = _TABLE
    rejection[width > gripper.opening - 2 * SWEEP_CLEARANCE] = _TOO_WIDE
    slope, twist = _slope_and_twist(heights, gripper)
    rows = (both.max(axis=1) * (CELLS_Z - np.arange(CELLS_Z))).max(axis=1)  # from the tips
    arm = cloud.centre_of_mass - centred[:, :3, 3]
    torque = cloud.mass * GRAVITY * gravity_lever(centred, arm)
    score = (
        _BASE
        + _AREA * overlap
        + _ACROSS * both.max(axis=2).mean(axis=1)
        + _DEPTH * np.minimum(rows / DEEP_ROWS, 1.0)
        - _TORQUE * torque / TORQUE_SCALE
        - _DISTANCE * np.linalg.norm(arm, axis=1) / DISTANCE_SCALE
        - _TILT * (1 + centred[:, 2, 2])
        - _WEDGE * np.abs(slope).max(axis=1)
        - _WIDE * width / gripper.opening
        - _SQUEEZED * squeezed
    )
    shallow = np.clip(1 - _contact_height(near, width, gripper) / MIN_CONTACT_HEIGHT, 0.0, 1.0)
    turning = np.clip((torque - HEAVY) / (TOO_HEAVY - HEAVY), 0.0, 1.0)
    near_palm = np.clip(1 - _palm_gap(near, gripper) / PALM_ROOM, 0.0, 1.0)
    score *= (1 - _SHALLOW * shallow) * (1 - _TURNING * turning) * (1 - _PALM * near_palm)
    score = np.where(rejection == _NONE, score, score - REJECTION_PENALTY)
    return GraspScores(centred, width, section_width, opening, score, rejection, slope, twist)


@dataclass(frozen=True)
class HandPointPairs:
    """The p pairs of a hand and a point near it. Most points are far from most hands."""

    hands: int  #: number of hands
    hand: np.ndarray  #: index of the hand of each pair (p,), in ascending order
    x: Array  #: x, like y and z, of the point in the grip frame of that hand (p,) [m]
    y: Array
    z: Array
    label: np.ndarray  #: label of the point (p,)

    @classmethod
    def find(
        cls, world_from_grip: Array, cloud: LabelledPointCloud, *, aside: float, ahead: float
    ) -> "HandPointPairs":
        """Pair hands (c, 4, 4) with the points within `aside` along x and `ahead` along z [m]."""
        # Single precision, a tenth of a micrometre here, takes half the time.
        middle = cloud.points.mean(axis=0)
        points = (cloud.points - middle).astype(np.float32).T
        axes = np.swapaxes(world_from_grip[:, :3, :3], 1, 2)
        origins = axes @ (world_from_grip[:, :3, 3] - middle)[..., None]
        hands = zip(axes.astype(np.float32), origins.astype(np.float32), strict=True)
        found: list[tuple[np.ndarray, NDArray[np.float32]]] = []
        for rotation, origin in hands:
            local = rotation @ points
            local -= origin
            index = np.flatnonzero((np.abs(local[0]) <= aside) & (local[2] <= ahead))
            found.append((index, local[:, index]))
        point = np.concatenate([np.zeros(0, dtype=int), *(index for index, _ in found)])
        x, y, z = np.hstack([np.zeros((3, 0), np.float32), *(local for _, local in found)])
        hand = np.repeat(np.arange(len(found)), [len(index) for index, _ in found])
        return cls(len(found), hand, x, y, z, cloud.labels[point])

    def hands_with(self, chosen: np.ndarray) -> np.ndarray:
        """Whether each hand (c,) has any of the chosen pairs (p,)."""
        result = np.zeros(self.hands, dtype=bool)
        result[self.hand[chosen]] = True
        return result

    def between_pads(self, gripper: Gripper) -> np.ndarray:
        """Whether each pair (p,) has a point of the target between the pads."""
        across = np.abs(self.x) <= gripper.pad_width / 2
        along = np.abs(self.z) <= gripper.pad_length / 2
        return across & along & (self.label == PointLabel.TARGET)


def _centre(near: HandPointPairs, gripper: Gripper) -> tuple[Array, Array]:
    """Middle and width (c,) of the target between the pads [m]."""
    band = near.between_pads(gripper) & (np.abs(near.y) <= gripper.opening / 2)
    far = gripper.opening  # nothing between the pads counts as twice as wide as the gripper
    high, low = np.full(near.hands, -far), np.full(near.hands, far)
    np.maximum.at(high, near.hand[band], near.y[band])
    np.minimum.at(low, near.hand[band], near.y[band])
    return (high + low) / 2, np.abs(high - low)


def _contact_profiles(near: HandPointPairs, width: Array, gripper: Gripper) -> Array:
    """How far out each pad meets points (c, 2, CELLS_X, CELLS_Z) [m]; -inf in empty cells."""
    band = near.between_pads(gripper) & (np.abs(near.y) <= (width / 2 + ROUNDING)[near.hand])
    x, y, z = (each[band] for each in (near.x, near.y, near.z))
    cell_x = np.clip((x / gripper.pad_width + 0.5) * CELLS_X, 0, CELLS_X - 1).astype(int)
    cell_z = np.clip((z / gripper.pad_length + 0.5) * CELLS_Z, 0, CELLS_Z - 1).astype(int)
    heights = np.full(near.hands * 2 * CELLS_X * CELLS_Z, -np.inf)
    for side, outwards in enumerate((y, -y)):
        cell = ((near.hand[band] * 2 + side) * CELLS_X + cell_x) * CELLS_Z + cell_z
        np.maximum.at(heights, cell, outwards)
    # A cell whose points all lie on the other side is empty on this one.
    heights[heights < 0] = -np.inf
    return heights.reshape(near.hands, 2, CELLS_X, CELLS_Z)


def _slope_and_twist(heights: Array, gripper: Gripper) -> tuple[Array, Array]:
    """The `slope` (c, 2) and `twist` (c,) of `GraspScores`, from contact profiles.

    A slope is the mean of both sides: of a wedge, which is squeezed out of the hand; a round bar
    has none. A twist is their difference: of parallel faces that the hand is not turned to.
    """
    across = _fit_slopes(heights.max(axis=3), gripper.pad_width / CELLS_X)
    along = _fit_slopes(heights.max(axis=2), gripper.pad_length / CELLS_Z)
    slope = np.column_stack([across.mean(axis=1), along.mean(axis=1)])
    return slope, np.arctan((across[:, 0] - across[:, 1]) / 2)


def _fit_slopes(edges: Array, spacing: float) -> Array:
    """Least squares slopes (c, 2) of edges (c, 2, n), over the cells filled on both sides."""
    filled = np.isfinite(edges[:, 0]) & np.isfinite(edges[:, 1])
    place = np.arange(edges.shape[-1]) * spacing
    middle = (filled * place).sum(axis=1) / np.maximum(filled.sum(axis=1), 1)
    centred = np.where(filled, place - middle[:, None], 0.0)
    spread = np.maximum((centred**2).sum(axis=1), spacing**2 / 2)
    return np.einsum("cn,csn->cs", centred, np.where(filled[:, None], edges, 0.0)) / spread[:, None]


def _contact_height(near: HandPointPairs, width: Array, gripper: Gripper) -> Array:
    """The mean height (c,) of the contact above the ends of the pads, the lower of both [m]."""
    # Cells are too coarse for it: a plate that the pads just reach fills a whole row of them.
    touched = near.between_pads(gripper) & (np.abs(near.y) >= (width / 2 - LEVEL)[near.hand])
    sides = []
    for side in (near.y > 0, near.y <= 0):
        hand = near.hand[touched & side]
        up = gripper.pad_length / 2 - near.z[touched & side]
        count = np.bincount(hand, minlength=near.hands)
        sides.append(np.bincount(hand, up, near.hands) / np.maximum(count, 1))
    return np.minimum(*sides)


def _palm_gap(near: HandPointPairs, gripper: Gripper) -> Array:
    """How far the nearest point below the palm is from it (c,) [m]; inf without one."""
    along_x, along_y = gripper.palm_size
    below = (np.abs(near.x) <= along_x / 2) & (np.abs(near.y) <= along_y / 2)
    nearest = np.full(near.hands, np.inf)
    np.minimum.at(nearest, near.hand[below], near.z[below])
    return nearest - gripper.palm


def _filled(touched: np.ndarray) -> np.ndarray:
    for axis in (2, 3):
        before = np.logical_or.accumulate(touched, axis=axis)
        after = np.flip(np.logical_or.accumulate(np.flip(touched, axis), axis=axis), axis)
        touched = before & after
    return touched


def _rejection(near: HandPointPairs, width: Array, opening: Array, gripper: Gripper) -> np.ndarray:
    """Why each hand (c,) is rejected for the points near it, as an index in `REJECTIONS`."""
    x, y, z = np.abs(near.x), np.abs(near.y), near.z
    half, half_open = (width / 2)[near.hand], (opening / 2)[near.hand]
    on_finger = x <= gripper.finger_width / 2
    beyond = (z > gripper.tip) & (z <= gripper.tip + BEYOND)
    slope = on_finger & beyond & (y > half + OUTWARD) & (y < half + gripper.finger_thickness)
    hit = slope | _is_swept(x, y, z, half_open, gripper)
    # Other parts may be between the fingers where they are clear of the pads; neighbours may not.
    close = (x <= gripper.finger_width / 2 + PART_CLEARANCE) & (z <= gripper.tip + PART_CLEARANCE)
    close &= y <= half_open + gripper.finger_thickness
    beside = close & (y >= half - RECESS)
    result = np.full(near.hands, _NONE)
    result[near.hands_with(hit & (near.label == PointLabel.TARGET))] = _SLOPE
    result[near.hands_with((hit | beside) & (near.label == PointLabel.OTHER_PART))] = _PART
    result[near.hands_with((hit | close) & (near.label == PointLabel.NEIGHBOUR))] = _NEIGHBOUR
    return result


def _is_swept(x: Array, y: Array, z: Array, half_open: Array, gripper: Gripper) -> np.ndarray:
    """Whether the fingers or the palm of the open gripper would hit each point (p,)."""
    in_width = x <= gripper.finger_width / 2 + SWEEP_CLEARANCE
    outside = y >= half_open - SWEEP_CLEARANCE
    finger = outside & (y <= half_open + gripper.finger_thickness + SWEEP_CLEARANCE)
    finger &= z <= gripper.tip + SWEEP_CLEARANCE
    root = outside & (y <= half_open + gripper.root_thickness) & (z <= gripper.root)
    along_x, along_y = gripper.palm_size
    palm = (x <= along_x / 2) & (y <= along_y / 2) & (z <= gripper.palm + SWEEP_CLEARANCE)
    return (in_width & (finger | root)) | palm


def hits_table(grips: Array, opening: Array, table: float, gripper: Gripper) -> np.ndarray:
    """Whether each hand (c,), open by `opening` [m], would hit the table."""
    half_x, tip = gripper.finger_width / 2, gripper.tip
    outer = opening / 2 + gripper.finger_thickness
    root = opening / 2 + gripper.root_thickness
    palm_x, palm_y = (size / 2 for size in gripper.palm_size)
    boxes = (half_x, outer, tip), (half_x, root, gripper.root), (palm_x, palm_y, gripper.palm)
    up_x, up_y, up_z, height = np.moveaxis(grips[:, 2], -1, 0)
    # Of each box the lowest of the corners (+-x, +-y, z).
    corners = [height + z * up_z - x * np.abs(up_x) - y * np.abs(up_y) for x, y, z in boxes]
    return np.minimum.reduce(corners) < table + TABLE_CLEARANCE


def gravity_lever(world_from_grip: Array, arm: Array) -> Array:
    """The lever (c,) of gravity about the line between the pads, by arms (c, 3) to the mass [m]."""
    # Gravity turns along arm x down; the share along the closing direction turns the object.
    return np.abs(np.cross(arm, world_from_grip[:, :3, 1])[:, 2])
