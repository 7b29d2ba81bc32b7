# SPDX-License-Identifier: Apache-2.0
"""Segmentation without a mask: what stands on the table, one cloud of coloured points a thing.

All cameras' depths become points of the world; those of the table and of what is not on it are
taken away, and what is left falls into groups that are clear of each other when seen from above.
Nothing here asks the simulator what a pixel shows.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from ..grasping.point_clouds import thin
from ..poses import Array
from .camera import SAMPLE, Camera, CameraImage

Integers = NDArray[np.int64]

TABLE_MARGIN = 0.0012  # [m], what is lower is the table
REGION = ((0.19, 0.83), (-0.55, 0.55))  # [m], x and y of where things can stand
CEILING = 0.30  # [m]; what reaches higher is the arm and no thing on the table
LOOKED_AT = 0.45  # [m], so far up it is found out whether something goes on
SPACING = 0.0012  # [m], one point is kept of each cube of this size
CELL = 0.004  # [m], of the plan in which groups are found
LEAST_IN_CELL = 3  # points in a cell and those round it; fewer are errors of depth
_HALF = 2**20  # more cubes than there are in any direction of a room
LEAST_POINTS = 80  # fewer are not taken for anything


@dataclass(frozen=True, eq=False)
class Segment:
    """One thing, as its points.

    Attributes:
        points: on its surface (n, 3), in the world [m].
        colours: of the points (n, 3), red, green and blue in [0, 1].
        sources: number of the view and of the pixel that each point comes from (n, 2).
    """

    points: Array
    colours: Array
    sources: Integers

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, chosen: NDArray[np.bool_] | Integers) -> Segment:
        return Segment(self.points[chosen], self.colours[chosen], self.sources[chosen])


def segments(views: Sequence[CameraImage], *, margin: float = TABLE_MARGIN) -> tuple[Segment, ...]:
    """The things on the table that some views show, in a fixed order.

    Args:
        views: of all cameras at one moment.
        margin: up to where points are taken for the table [m]; more where depths are noisy.
    """
    scene = _above_table(views, margin)
    scene = scene[thin(scene.points, SPACING)]
    groups = _groups(scene.points)
    found = (scene[groups == number] for number in range(1, int(groups.max(initial=0)) + 1))
    return tuple(
        each for each in found if len(each) >= LEAST_POINTS and each.points[:, 2].max() < CEILING
    )


def _above_table(views: Sequence[CameraImage], margin: float) -> Segment:
    pieces: list[Segment] = []
    for number, view in enumerate(views):
        heights = view.camera.eye[2] + view.depth * _rise(view.camera)
        mask = (heights > margin) & (heights < LOOKED_AT)
        points = view.points(mask)
        pixels = np.flatnonzero(mask)
        sources = np.column_stack([np.full(len(pixels), number), pixels])
        piece = Segment(points, view.colour[mask] / 255.0, sources)
        pieces.append(piece[_is_on_table(points)])
    return Segment(
        np.vstack([np.empty((0, 3)), *(piece.points for piece in pieces)]),
        np.vstack([np.empty((0, 3)), *(piece.colours for piece in pieces)]),
        np.vstack([np.empty((0, 2), dtype=np.int64), *(piece.sources for piece in pieces)]),
    )


@lru_cache(maxsize=8)
def _rise(camera: Camera) -> NDArray[np.float32]:
    """How much higher a point is than the eye for each metre of depth, (height, width)."""
    columns, rows = np.meshgrid(np.arange(camera.width), np.arange(camera.height))
    across = (columns + SAMPLE[0] - camera.width / 2) / camera.focal
    upwards = (camera.height / 2 - rows - SAMPLE[1]) / camera.focal
    right, up, back = camera.world_from_camera[2, :3]
    return (across * right + upwards * up - back).astype(np.float32)


def _is_on_table(points: Array) -> NDArray[np.bool_]:
    low, high = np.array(REGION).T
    return ((points[:, :2] > low) & (points[:, :2] < high)).all(axis=1)


def _groups(points: Array) -> Integers:
    """To which group each point belongs (n,), counted from 1.

    Cells of the plan are one group when they touch, or nearly: the slots of a spatula are
    narrower than the space between two things.
    """
    from scipy import ndimage

    cells = np.floor((points[:, :2] - np.array(REGION)[:, 0]) / CELL).astype(np.int64) + 2
    plan = np.zeros(np.ceil(np.ptp(REGION, axis=1) / CELL).astype(int) + 5)
    np.add.at(plan, tuple(cells.T), 1)
    square = np.ones((3, 3), dtype=bool)
    plan = (plan > 0) & (ndimage.convolve(plan, square.astype(float)) >= LEAST_IN_CELL)
    labels = np.zeros(plan.shape, dtype=np.int64)
    ndimage.label(ndimage.binary_dilation(plan, square), square, output=labels)
    return np.where(plan, labels, 0)[tuple(cells.T)]


def cube_numbers(points: Array, side: float) -> Integers:
    """One number (n,) for the cube of `side` [m] in which each point (n, 3) or (n, 2) lies."""
    cubes = np.floor(points / side).astype(np.int64) + _HALF
    numbers = cubes[:, 0]
    for column in cubes.T[1:]:
        numbers = numbers * 2 * _HALF + column
    return numbers
