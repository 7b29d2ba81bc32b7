"""Sampling of grasp candidates: hand poses with room for a finger on both sides of the part.

From points spread over the part and a fixed set of orientations, each pose is judged by one row of
bins along the closing direction, which hold the first point that a finger would meet. There must be
room for a finger on either side, and the part between them must be narrower than the gripper opens
and alone. Orientations are enumerated because thin plates have no reliable surface normals.
"""

from collections import Counter
from dataclasses import dataclass

import numpy as np

from .. import poses
from ..poses import Array, farthest_points, principal_direction
from ..robot.models import Gripper
from ..robot.path_planner import grasp_orientations
from .context import LabelledPointCloud, PointLabel

BIN = 0.002  # [m] along the closing direction
HALF_BINS = 52  # a section may lie wholly on one side of its sample: 104 mm
TIP_DEPTHS = (0.003, 0.008, 0.014)  # [m] of the finger tips below the sample
TABLE_CLEARANCE = 0.001  # [m] between the tips and the table
SIDE_CLEARANCE = 0.0035  # [m] between a finger and the part as the hand comes down


def sample_grasps(
    cloud: LabelledPointCloud,
    gripper: Gripper,
    *,
    rng: np.random.Generator,
    count: int,
    turn: float = 0.0,
) -> tuple[Array, Array, Counter[str]]:
    """Return grasp candidates round `count` points of the target; `rng` chooses the first point.

    These are poses (c, 4, 4) of the grip frame of the open gripper, and the width of what is
    between its fingers (c,) [m]. The numbers of samples that were rejected come with their reasons:
    "too_wide" for the gripper, "part", without room for the fingers, or "below_table". All
    orientations are turned by `turn` [rad] about the vertical, to try those between the usual ones.
    """
    target = cloud.target
    samples = target[farthest_points(target, count, first=int(rng.integers(len(target))))]
    places, widths, rejected = [np.zeros((0, 4, 4))], [np.zeros(0)], Counter[str]()
    x, y = principal_direction(target)
    rotations = grasp_orientations(float(np.arctan2(y, x)) + turn)
    depths = _tip_depths(rotations, samples, cloud.table, gripper)
    rejected["below_table"] = int(np.count_nonzero(depths[..., 0] <= 0))
    for rotation, tips in zip(rotations, depths, strict=True):
        possible = tips[:, 0] > 0
        if possible.any():
            found = _candidates(rotation, samples[possible], tips[possible], cloud, gripper)
            places.append(found[0])
            widths.append(found[1])
            rejected += found[2]
    return np.concatenate(places), np.concatenate(widths), rejected


def _candidates(
    rotation: Array, samples: Array, tips: Array, cloud: LabelledPointCloud, gripper: Gripper
) -> tuple[Array, Array, Counter[str]]:
    points, starts = rotation.T @ cloud.points.T, samples @ rotation
    starts[:, :2] = np.rint(starts[:, :2] / BIN) * BIN  # bins begin where samples are
    heights = _HeightMap.of(points, cloud.labels, starts, gripper.finger_width / 2)
    room = round((gripper.finger_thickness + 2 * SIDE_CLEARANCE) / BIN)
    below = starts[:, 2, None] + np.maximum.accumulate(tips, axis=1)  # (s, t)
    (left, right), alone = heights.ends(below, room)
    width = (left + right - 1) * BIN
    # There is room beyond the ends, so only what lies at an end can be in the way.
    clear = ~(heights.is_other(1 - left, below) | heights.is_other(right - 1, below))
    narrow = width + 2 * SIDE_CLEARANCE <= gripper.opening
    beside = heights.y[:, None] + np.arange(-HALF_BINS, HALF_BINS + 1)
    nearest = heights.first[0, heights.x[:, None], beside].min(axis=1)
    nearest = np.minimum(nearest - starts[:, 2], 0.0)
    possible = clear & narrow & (tips <= (nearest + gripper.tip - gripper.palm)[:, None])
    row, depth = np.nonzero(possible & (tips > 0) & (left < HALF_BINS) & (right < HALF_BINS))
    shift = (right - left)[row, depth] * BIN / 2
    # Of the grip frame, along the axes of the hand (c, 3) [m].
    centres = starts[row] + np.column_stack([0 * shift, shift, tips[row, depth] - gripper.tip])
    alone_width = (alone.sum(axis=0) - 1) * BIN + 2 * SIDE_CLEARANCE
    too_wide = int(np.count_nonzero(alone_width > gripper.opening))
    blocked = max(0, int(np.count_nonzero(~possible)) - too_wide)
    at = poses.pose(rotation, centres @ rotation.T)
    return at, width[row, depth], Counter(too_wide=too_wide, part=blocked)


def _tip_depths(rotations: Array, samples: Array, table: float, gripper: Gripper) -> Array:
    """How far the tips go below each sample (d, s, t) [m]; -1 where the table is in the way."""
    x, y, z = np.abs(rotations[:, 2, 0]), np.abs(rotations[:, 2, 1]), -rotations[:, 2, 2]
    finger = gripper.finger_width / 2 * x + gripper.finger_thickness * y
    along_x, along_y = gripper.palm_size
    palm = along_x / 2 * x + along_y / 2 * y + (gripper.palm - gripper.tip) * z
    lowest = np.maximum(finger, palm)[:, None]  # of the hand below its tips
    room = (samples[:, 2] - table - TABLE_CLEARANCE - lowest) / np.maximum(z, 1e-6)[:, None]
    depths = np.minimum(np.array(TIP_DEPTHS), room[..., None])
    return np.where(np.diff(depths, prepend=0.0, axis=2) > 0.25 * TIP_DEPTHS[0], depths, -1.0)


@dataclass(frozen=True)
class _HeightMap:
    """The first point that a finger would meet in each bin, along the approach direction."""

    first: Array  # (2, columns, rows), of all points and of those of the target [m]; inf if none
    other: Array  # (columns, rows), of the rest [m]
    x: np.ndarray  # (s,), the bins of the samples
    y: np.ndarray  # (s,), the same

    @classmethod
    def of(cls, points: Array, labels: np.ndarray, starts: Array, half: float) -> "_HeightMap":
        """The map round the samples `starts` (s, 3), x and y whole multiples of `BIN` [m].

        Of the points (3, n), z lies along the approach and y along the closing direction [m]; their
        labels are (n,) of `PointLabel`, and `half` is half the width of a finger along x [m].
        """
        margin = np.array([round(half / BIN), HALF_BINS])
        corner = starts[:, :2].min(axis=0) - margin * BIN
        x, y = np.rint((points[:2] - corner[:, None]) / BIN).astype(int)
        middles = np.rint((starts[:, :2] - corner) / BIN).astype(int)
        columns, rows = middles.max(axis=0) + margin + 1
        inside = np.flatnonzero((x >= 0) & (x < columns) & (y >= 0) & (y < rows))
        place = (labels[inside] != PointLabel.TARGET) * columns + x[inside]
        first = np.full(2 * columns * rows, np.inf)
        np.minimum.at(first, place * rows + y[inside], points[2, inside])
        target, other = _running_min(first.reshape(2, columns, rows), 2 * int(margin[0]) + 1)
        at = middles - (margin[0], 0)
        return cls(np.stack([np.minimum(target, other), target]), other, at[:, 0], at[:, 1])

    def is_other(self, bins: np.ndarray, below: Array) -> np.ndarray:
        """Whether a point not of the target lies above `below` (s, t) [m], `bins` aside."""
        return self.other[self.x[:, None], self.y[:, None] + bins] <= below

    def ends(self, below: Array, room: int) -> np.ndarray:
        """Bins to the first `room` empty ones, to the left and to the right (2, 2, s, t).

        A finger needs `room` bins, down to `below` (s, t) [m]. First among all points, then among
        those of the target; `HALF_BINS` where there is no room.
        """
        met = np.swapaxes(_running_min(np.swapaxes(self.first, 1, 2), room), 1, 2)
        steps = np.arange(1, HALF_BINS - room + 2)
        aside = np.stack([1 - room - steps, steps])[:, None]  # (2, 1, n)
        free = met[:, self.x[:, None], self.y[:, None] + aside][..., None, :] > below[..., None]
        found = np.argmax(free, axis=-1)  # 0 also where none is free, for which `any` is slower
        return np.where((found > 0) | free[..., 0], found + 1, HALF_BINS)


def _running_min(grid: Array, count: int) -> Array:
    """The least of each `count` consecutive rows of a grid (k, rows, columns)."""
    size = 1
    while size < count:
        step = min(size, count - size)
        grid = np.minimum(grid[:, :-step], grid[:, step:])
        size += step
    return grid
