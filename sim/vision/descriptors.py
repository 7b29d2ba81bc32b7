# SPDX-License-Identifier: Apache-2.0
"""Descriptors: what a segment looks like, in numbers that do not change when it is turned.

A segment is seen in a frame of its own: origin on the table below its middle, x along its longest
extent towards its heavier end, z up. Whole segments are described by their size, their outline
along x, how their points spread over height and distance, and their colours; single points by
where they are in that frame, what is round them, and their colour.
"""

from __future__ import annotations

import numpy as np

from .. import poses
from ..poses import Array
from .segmentation import Segment, cube_numbers

SLICES = 12  # along the longest extent
RINGS = 8  # of distance from the middle
STEPS = 8  # of height
TALLEST, WIDEST = 0.2, 0.16  # [m], height and radius of the last step and ring
SHADES = 3  # of each of red, green and blue in the histogram of colours
CELL = 0.004  # [m], in which the covered area is counted
SCALE = 10.0  # of lengths, so that all numbers are of about one size


def segment_frame(points: Array) -> Array:
    """`world_from_segment` (4, 4) of points (n, 3).

    >>> segment_frame(np.array([[0.0, 0, 0], [0.0, 1, 0], [0.0, 5, 0]]))[:2, 0] + 0.0
    array([ 0., -1.])
    """
    middle = points[:, :2].mean(axis=0)
    flat = points[:, :2] - middle
    along = np.linalg.eigh(flat.T @ flat)[1][:, -1]
    # Seen from the middle, the lighter end reaches farther: that is where x comes from.
    ahead = flat @ along
    if (ahead**3).sum() > 0:
        along = -along
    x, y = along
    rotation = np.array([[x, -y, 0.0], [y, x, 0.0], [0.0, 0.0, 1.0]])
    return poses.pose(rotation, (*middle, 0.0))


def describe(segment: Segment) -> Array:
    """A segment as one row of numbers (d,)."""
    points = poses.transform(poses.inverse(segment_frame(segment.points)), segment.points)
    spread = np.quantile(points, (0.02, 0.5, 0.98), axis=0)
    extent = spread[2] - spread[0]
    area = len(np.unique(cube_numbers(points[:, :2], CELL))) * CELL**2
    radius = np.linalg.norm(points[:, :2], axis=1)
    numbers = (
        SCALE * spread.ravel(),
        SCALE * extent,
        SCALE * np.array([np.sqrt(area), points[:, 2].mean(), points[:, 2].std(), radius.mean()]),
        [area / max(extent[0] * extent[1], CELL**2), extent[1] / max(extent[0], CELL)],
        SCALE * np.hstack(_outline(points)),
        _shares(radius, WIDEST, RINGS),
        _shares(points[:, 2], TALLEST, STEPS),
        segment.colours.mean(axis=0),
        segment.colours.std(axis=0),
        _palette(segment.colours),
    )
    return np.concatenate([np.ravel(each) for each in numbers])


def describe_points(segment: Segment) -> Array:
    """The points of a segment as rows of numbers (n, k)."""
    points = poses.transform(poses.inverse(segment_frame(segment.points)), segment.points)
    low, high = np.quantile(points[:, 0], (0.01, 0.99))
    place = (points[:, 0] - low) / max(high - low, CELL)
    index = np.clip((place * SLICES).astype(int), 0, SLICES - 1)
    outline = np.column_stack(_outline(points))
    before, after = outline[np.maximum(index - 1, 0)], outline[np.minimum(index + 1, SLICES - 1)]
    mean, spread = segment.colours.mean(axis=0), segment.colours.std(axis=0) + 0.02
    return np.column_stack(
        [
            SCALE * points,
            SCALE * np.abs(points[:, 1]),
            SCALE * np.linalg.norm(points[:, :2], axis=1),
            np.clip(place, -0.5, 1.5),
            SCALE * outline[index],
            SCALE * before,
            SCALE * after,
            np.tile(SCALE * np.ptp(points, axis=0), (len(points), 1)),
            segment.colours,
            (segment.colours - mean) / spread,
        ]
    )


def _outline(points: Array) -> tuple[Array, Array, Array]:
    """Width, lowest and highest point of each slice along x, (SLICES,) each [m]."""
    low, high = np.quantile(points[:, 0], (0.01, 0.99))
    index = ((points[:, 0] - low) / max(high - low, CELL) * SLICES).astype(int)
    index = np.clip(index, 0, SLICES - 1)
    lowest, highest = np.full((SLICES, 2), np.inf), np.full((SLICES, 2), -np.inf)
    np.minimum.at(lowest, index, points[:, 1:])
    np.maximum.at(highest, index, points[:, 1:])
    empty = ~np.isfinite(lowest)
    lowest[empty], highest[empty] = 0.0, 0.0
    return highest[:, 0] - lowest[:, 0], lowest[:, 1], highest[:, 1]


def _shares(values: Array, largest: float, count: int) -> Array:
    """Which share of the values lies in each of `count` steps up to the largest."""
    index = np.clip((values / largest * count).astype(int), 0, count - 1)
    return np.bincount(index, minlength=count) / len(values)


def _palette(colours: Array) -> Array:
    """Which share of the points has each of SHADES^3 colours."""
    shade = np.clip((colours * SHADES).astype(int), 0, SHADES - 1)
    index = (shade[:, 0] * SHADES + shade[:, 1]) * SHADES + shade[:, 2]
    return np.bincount(index, minlength=SHADES**3) / len(colours)
