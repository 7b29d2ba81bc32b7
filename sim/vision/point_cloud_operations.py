"""Point clouds: voxel downsampling, farthest point sampling, principal direction."""

import numpy as np
from numpy.typing import NDArray

from ..poses import Array

Integers = NDArray[np.int64]


def voxel_keys(points: Array, side: float) -> Integers:
    """One number (n,) for the voxel of `side` [m] that holds each point (n, 2) or (n, 3)."""
    voxels = np.floor(points / side).astype(np.int64)
    voxels -= voxels.min(axis=0)
    keys = voxels[:, 0]
    # Sorting single numbers is ten times faster than sorting rows.
    for column in voxels.T[1:]:
        keys = keys * (column.max() + 1) + column
    return keys


def voxel_downsample(points: Array, side: float) -> Integers:
    """Indices, in order, of the first point (n, 3) in each voxel of `side` [m]."""
    if not len(points):
        return np.zeros(0, dtype=np.int64)
    return np.sort(np.unique(voxel_keys(points, side), return_index=True)[1])


def farthest_points(points: Array, count: int, *, first: int) -> Integers:
    """Indices of `count` points that lie far from each other, starting with `first`.

    Farthest point sampling (Gonzalez 1985): each next point is the one farthest from those chosen.
    """
    chosen = [first]
    distance = np.full(len(points), np.inf)
    while len(chosen) < min(count, len(points)):
        distance = np.minimum(distance, np.sum((points - points[chosen[-1]]) ** 2, axis=1))
        chosen.append(int(np.argmax(distance)))
    return np.array(chosen)


def principal_direction(points: Array) -> Array:
    """The unit vector (2,) along the longest horizontal extent of points (n, 3)."""
    centred = points[:, :2] - points[:, :2].mean(axis=0)
    return np.linalg.eigh(centred.T @ centred)[1][:, -1]
