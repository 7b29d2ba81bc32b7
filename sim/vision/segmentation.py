"""Segmentation of depth images into objects on the table, and descriptors of the segments.

The depths of all cameras become points of the world; the table and what is not on it are removed,
and the rest falls into groups that do not touch when seen from above. Nothing here uses the mask.
Noisy depths are smoothed first: each pixel takes the plane of the flattest square that contains it,
so that edges stay sharp (Kuwahara et al. 1976).

Descriptors are numbers that do not change when an object is turned: they use the segment's own
frame: origin on the table below its middle, x along its longest extent to its heavier end, z up.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product

import numpy as np
from numpy.typing import NDArray

from .. import poses
from ..poses import Array, Integers, principal_direction, voxel_downsample, voxel_keys
from .camera import Camera, CameraImage

TABLE_MARGIN = 0.0012  # [m], what is lower is the table
NOISE_MARGIN = 1.0  # standard deviations of depths that still belong to the table when smoothed
HALVES = (2, 1)  # pixels to each side of a square: the smaller ones fit on a spoon's handle
ROUGHNESS = 0.0025  # [m], from a plane, that is no edge
NOISE_VARIANCE = 1.2  # the same of noise, in its variance: few squares of a plane exceed it
REGION = ((0.19, 0.83), (-0.55, 0.55))  # [m], x and y of where objects can stand
MAX_HEIGHT = 0.30  # [m]; what reaches higher is the arm
MAX_CONSIDERED_HEIGHT = 0.45  # [m], up to where points are kept, to see what reaches higher
SPACING = 0.0012  # [m], voxel size of a segment
CELL = 0.004  # [m], of the plan view in which groups are found
MIN_POINTS_IN_CELL = 3  # in a cell and its neighbours; fewer are errors of depth
MIN_POINTS = 80  # of a segment

SLICES = 12  # along the longest extent
DISTANCE_BINS, HEIGHT_BINS = 8, 8
MAX_DISTANCE, MAX_HEIGHT_BIN = 0.16, 0.2  # [m], where the last bins end
SHADES = 3  # of each of red, green and blue in the colour histogram
SCALE = 10.0  # of lengths, so that all numbers are of about one size


@dataclass(frozen=True, eq=False)
class Segment:
    """The points of one segment."""

    points: Array  #: points on the surface (n, 3), in the world [m]
    colours: Array  #: red, green and blue of the points (n, 3), in [0, 1]
    sources: Integers  #: index of the image and of the pixel that each point comes from (n, 2)

    def __len__(self) -> int:
        return len(self.points)

    def __getitem__(self, chosen: NDArray[np.bool_] | Integers) -> "Segment":
        return Segment(self.points[chosen], self.colours[chosen], self.sources[chosen])


def segment_images(images: Sequence[CameraImage], *, noise: float = 0.0) -> tuple[Segment, ...]:
    """Return the segments of objects at one moment, in a fixed order; depths have `noise` [m]."""
    if noise:
        images = [replace(image, depth=kuwahara_filter(image.depth, noise)) for image in images]
    scene = _above_table(images, TABLE_MARGIN + NOISE_MARGIN * noise)
    scene = scene[voxel_downsample(scene.points, SPACING)]
    groups = _groups(scene.points)
    found = (scene[groups == number] for number in range(1, int(groups.max(initial=0)) + 1))
    large = (each for each in found if len(each) >= MIN_POINTS)
    return tuple(each for each in large if each.points[:, 2].max() < MAX_HEIGHT)


def kuwahara_filter(depth: NDArray[np.float32], noise: float) -> NDArray[np.float32]:
    """Return a depth image (height, width) [m], smoothed; NaN where no square of pixels is flat.

    5 x 5 pixels reduce noise, the standard deviation [m], to a fifth; at an edge to a half. Holes,
    which are NaN, are filled from the nearest pixel first.
    """
    from scipy.ndimage import distance_transform_edt  # here: images without noise save its import

    if (holes := np.isnan(depth)).any():
        nearest = distance_transform_edt(holes, return_distances=False, return_indices=True)
        depth = depth[tuple(np.asarray(nearest))]
    limit = NOISE_VARIANCE * noise**2 + ROUGHNESS**2
    last, result = np.subtract(depth.shape, 1)[:, None], np.full_like(depth, np.nan)
    for half in HALVES:
        middle, down, right, variance = _fit_planes(depth.astype(float), half)
        result = np.where(np.isnan(result) & (variance < limit), middle, result)
        pixels = np.array(np.nonzero(np.isnan(result)))
        best, found = np.full(pixels.shape[1], limit), np.full(pixels.shape[1], np.nan)
        for i, j in product(range(-half, half + 1), repeat=2):
            at = tuple(np.clip(np.add(pixels, [[i], [j]]), 0, last))
            flatter = variance[at] < best
            best = np.where(flatter, variance[at], best)
            found = np.where(flatter, middle[at] - i * down[at] - j * right[at], found)
        result[tuple(pixels)] = found
    return result.astype(np.float32)


def _fit_planes(depth: Array, half: int) -> tuple[Array, Array, Array, Array]:
    """Fit a plane to the square round each pixel: its depth there, slopes and residual variance."""
    from scipy.ndimage import correlate1d

    steps = np.arange(-half, half + 1.0)
    box, ramp = np.ones(len(steps)) / len(steps), steps / (steps @ steps)
    filters = (depth, box, box), (depth, ramp, box), (depth, box, ramp), (depth**2, box, box)
    mean, down, right, square = (
        correlate1d(correlate1d(image, a, axis=0), b, axis=1) for image, a, b in filters
    )
    return mean, down, right, square - mean**2 - (down**2 + right**2) * np.mean(steps**2)


def _above_table(images: Sequence[CameraImage], margin: float) -> Segment:
    low, high = np.array(REGION).T
    pieces = [Segment(np.empty((0, 3)), np.empty((0, 3)), np.empty((0, 2), dtype=np.int64))]
    for number, image in enumerate(images):
        heights = image.camera.eye[2] + image.depth * _height_per_depth(image.camera)
        mask = (heights > margin) & (heights < MAX_CONSIDERED_HEIGHT)
        points = image.points(mask)
        pixels = np.flatnonzero(mask)
        sources = np.column_stack([np.full(len(pixels), number), pixels])
        piece = Segment(points, image.colour[mask] / 255.0, sources)
        pieces.append(piece[((points[:, :2] > low) & (points[:, :2] < high)).all(axis=1)])
    return poses.joined(*pieces)


@lru_cache(maxsize=8)
def _height_per_depth(camera: Camera) -> NDArray[np.float32]:
    """How much higher than the camera a point is, per metre of depth (height, width)."""
    rows, columns = np.indices((camera.height, camera.width))
    across, upwards = camera.slopes(rows, columns)
    right, up, back = camera.world_from_camera[2, :3]
    return (across * right + upwards * up - back).astype(np.float32)


def _groups(points: Array) -> Integers:
    """The group of each point (n,), counted from 1; 0 for none.

    Cells of the plan view belong together when they touch, or nearly: the slots of a spatula are
    narrower than the gap between two objects.
    """
    from scipy import ndimage

    cells = np.floor((points[:, :2] - np.array(REGION)[:, 0]) / CELL).astype(np.int64) + 2
    plan = np.zeros(np.ceil(np.ptp(REGION, axis=1) / CELL).astype(int) + 5)
    np.add.at(plan, tuple(cells.T), 1)
    square = np.ones((3, 3), dtype=bool)
    plan = (plan > 0) & (ndimage.convolve(plan, square.astype(float)) >= MIN_POINTS_IN_CELL)
    labels = np.zeros(plan.shape, dtype=np.int64)
    ndimage.label(ndimage.binary_dilation(plan, square), square, output=labels)
    return np.where(plan, labels, 0)[tuple(cells.T)]


def segment_frame(points: Array) -> Array:
    """`world_from_segment` (4, 4) of points (n, 3).

    >>> segment_frame(np.array([[0.0, 0, 0], [0.0, 1, 0], [0.0, 5, 0]]))[:2, 0] + 0.0
    array([ 0., -1.])
    """
    middle = points[:, :2].mean(axis=0)
    along = principal_direction(points)
    # Seen from the middle, the lighter end reaches farther; x points away from it.
    if (((points[:, :2] - middle) @ along) ** 3).sum() > 0:
        along = -along
    x, y = along
    return poses.pose(np.array([[x, -y, 0.0], [y, x, 0.0], [0.0, 0.0, 1.0]]), (*middle, 0.0))


def describe_segment(segment: Segment) -> Array:
    """Return the descriptor (d,) of a segment: its size, outline, distributions and colours."""
    points = poses.transform(poses.inverse(segment_frame(segment.points)), segment.points)
    quantiles = np.quantile(points, (0.02, 0.5, 0.98), axis=0)
    extent = quantiles[2] - quantiles[0]
    area = len(np.unique(voxel_keys(points[:, :2], CELL))) * CELL**2
    radius = np.linalg.norm(points[:, :2], axis=1)
    shades = np.clip((segment.colours * SHADES).astype(int), 0, SHADES - 1)
    shade = shades @ (SHADES**2, SHADES, 1)  # one number for each of SHADES^3 colours
    numbers = (
        SCALE * quantiles.ravel(),
        SCALE * extent,
        SCALE * np.array([np.sqrt(area), points[:, 2].mean(), points[:, 2].std(), radius.mean()]),
        [area / max(extent[0] * extent[1], CELL**2), extent[1] / max(extent[0], CELL)],
        SCALE * np.hstack(outline(points)),
        _histogram(radius / MAX_DISTANCE, DISTANCE_BINS),
        _histogram(points[:, 2] / MAX_HEIGHT_BIN, HEIGHT_BINS),
        segment.colours.mean(axis=0),
        segment.colours.std(axis=0),
        np.bincount(shade, minlength=SHADES**3) / len(shade),
    )
    return np.concatenate([np.ravel(each) for each in numbers])


def describe_points(segment: Segment) -> Array:
    """Return the descriptors (n, k) of a segment's points: position, surroundings and colour."""
    points = poses.transform(poses.inverse(segment_frame(segment.points)), segment.points)
    place, index = _place_along(points), slice_index(points)
    slices = np.column_stack(outline(points))
    before, after = slices[np.maximum(index - 1, 0)], slices[np.minimum(index + 1, SLICES - 1)]
    mean, deviation = segment.colours.mean(axis=0), segment.colours.std(axis=0) + 0.02
    return np.column_stack(
        [
            SCALE * points,
            SCALE * np.abs(points[:, 1]),
            SCALE * np.linalg.norm(points[:, :2], axis=1),
            np.clip(place, -0.5, 1.5),
            SCALE * slices[index],
            SCALE * before,
            SCALE * after,
            np.tile(SCALE * np.ptp(points, axis=0), (len(points), 1)),
            segment.colours,
            (segment.colours - mean) / deviation,
        ]
    )


def _place_along(points: Array) -> Array:
    """Where points (n, 3) lie along the longest extent (n,): 0 at its start, 1 at its end."""
    low, high = np.quantile(points[:, 0], (0.01, 0.99))
    return (points[:, 0] - low) / max(high - low, CELL)


def slice_index(points: Array, count: int = SLICES) -> Integers:
    """The slice along x of each of some points (n, 3), in the frame of their segment, (n,)."""
    return np.clip((_place_along(points) * count).astype(int), 0, count - 1)


def outline(points: Array, count: int = SLICES) -> tuple[Array, Array, Array]:
    """Width, lowest and highest point of each slice along x, (count,) each [m]."""
    index = slice_index(points, count)
    lowest, highest = np.full((count, 2), np.inf), np.full((count, 2), -np.inf)
    np.minimum.at(lowest, index, points[:, 1:])
    np.maximum.at(highest, index, points[:, 1:])
    empty = ~np.isfinite(lowest)
    lowest[empty], highest[empty] = 0.0, 0.0
    return highest[:, 0] - lowest[:, 0], lowest[:, 1], highest[:, 1]


def _histogram(values: Array, bins: int) -> Array:
    """The share of values in each of `bins` bins over [0, 1]; those beyond go to the last ones."""
    return np.histogram(np.clip(values, 0, 1), bins, (0, 1))[0] / len(values)
