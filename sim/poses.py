"""Poses and points: 4 x 4 homogeneous matrices, named by frames, and operations on point clouds.

`world_from_part` takes points given in the frame of the part to the frame of the world, so that
in a product equal frames stand side by side: `world_from_hand @ hand_from_grip`. Frames are
right-handed, lengths in [m], angles in [rad]. Most functions work on stacks of poses (..., 4, 4).

scipy's `Rotation` takes two to eight times as long for the few rotations of one step.
"""

from typing import TypeAlias, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array: TypeAlias = NDArray[np.float64]
Integers: TypeAlias = NDArray[np.int64]
T = TypeVar("T")

_SMALL_ANGLE = 1e-9  # [rad], below it a rotation has no axis


def pose(rotation: ArrayLike, position: ArrayLike) -> Array:
    """Return the pose with this rotation (..., 3, 3) and position (..., 3) [m]."""
    rotation, position = np.asarray(rotation, float), np.asarray(position, float)
    result = np.zeros((*np.broadcast_shapes(rotation.shape[:-2], position.shape[:-1]), 4, 4))
    result[..., :3, :3] = rotation
    result[..., :3, 3] = position
    result[..., 3, 3] = 1.0
    return result


def translation(x: float, y: float, z: float) -> Array:
    """Return the pose that translates by x, y, z [m]."""
    return pose(np.eye(3), (x, y, z))


def inverse(a_from_b: Array) -> Array:
    """Return `b_from_a`."""
    b_from_a = np.swapaxes(a_from_b[..., :3, :3], -1, -2)
    return pose(b_from_a, -np.einsum("...ij,...j->...i", b_from_a, a_from_b[..., :3, 3]))


def transform(a_from_b: Array, points: Array) -> Array:
    """Return points (n, 3) of frame b in frame a; (..., n, 3) for a stack of poses."""
    return points @ np.swapaxes(a_from_b[..., :3, :3], -1, -2) + a_from_b[..., None, :3, 3]


def rotation_about(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Return rotations (..., 3, 3) about a unit axis (3,) by angles (...) [rad] (Rodrigues)."""
    cross = np.cross(np.eye(3), np.asarray(axis, float))  # `cross @ v` is the axis times v
    angle = np.asarray(angle, float)[..., None, None]
    return np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * (cross @ cross)


def rotation_from_rpy(roll: float, pitch: float, yaw: float) -> Array:
    """Return the rotation of a URDF's `rpy` [rad]: about the fixed x, then y, then z axis."""
    about_x, about_y, about_z = map(rotation_about, np.eye(3), (roll, pitch, yaw))
    return about_z @ about_y @ about_x


def rotation_vector(rotation: Array) -> Array:
    """Return axis times angle [rad] (..., 3) of rotations (..., 3, 3); the angle is in [0, pi]."""
    entries = ((2, 1), (0, 2), (1, 0))
    skew = np.stack([rotation[..., i, j] - rotation[..., j, i] for i, j in entries], axis=-1)
    sine = 0.5 * np.linalg.norm(skew, axis=-1)
    cosine = 0.5 * (np.trace(rotation, axis1=-2, axis2=-1) - 1.0)
    angle = np.arctan2(sine, cosine)
    scale = np.where(sine > _SMALL_ANGLE, angle / np.maximum(2.0 * sine, _SMALL_ANGLE), 0.5)
    vector = scale[..., None] * skew
    half_turn = (sine <= _SMALL_ANGLE) & (cosine < 0)
    if not half_turn.any():
        return vector
    # At a half turn R + I = 2 a a^T: its longest column is along the axis.
    outer = rotation + np.eye(3)
    best = np.argmax(np.linalg.norm(outer, axis=-2), axis=-1)
    column = np.take_along_axis(outer, best[..., None, None], axis=-1)[..., 0]
    length = np.maximum(np.linalg.norm(column, axis=-1, keepdims=True), _SMALL_ANGLE)
    return np.where(half_turn[..., None], np.pi * column / length, vector)


def angle_between(rotation_a: Array, rotation_b: Array) -> Array:
    """Return the angle [rad] in [0, pi] of the rotation from one to the other."""
    return np.linalg.norm(rotation_vector(np.swapaxes(rotation_a, -1, -2) @ rotation_b), axis=-1)


def interpolate(pose_a: Array, pose_b: Array, fractions: ArrayLike) -> Array:
    """Return poses (n, 4, 4) straight from a to b (turns: slerp), at fractions (n,) in [0, 1]."""
    fractions = np.asarray(fractions, float)
    (rotation_a, start), (rotation_b, end) = ((p[:3, :3], p[:3, 3]) for p in (pose_a, pose_b))
    vector = rotation_vector(rotation_a.T @ rotation_b)
    angle = float(np.linalg.norm(vector))
    rotations = rotation_a @ rotation_about(vector / max(angle, _SMALL_ANGLE), fractions * angle)
    return pose(rotations, start + fractions[:, None] * (end - start))


def quaternion(rotation: Array) -> tuple[float, float, float, float]:
    """Return the unit quaternion x, y, z, w of a rotation (3, 3)."""
    vector = rotation_vector(rotation)
    angle = float(np.linalg.norm(vector))
    # np.sinc(t) is sin(pi t) / (pi t): defined at 0, where the axis is not.
    x, y, z = 0.5 * np.sinc(angle / (2 * np.pi)) * vector
    return float(x), float(y), float(z), float(np.cos(angle / 2))


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


def squared_distances(points: Array, others: Array) -> Array:
    """Squares (..., n, m) [m^2] of the distances of points (..., n, 3) and others (..., m, 3)."""
    # One product of matrices: |a|^2 - 2 a b + |b|^2 without temporary arrays.
    squares = [np.sum(each**2, axis=-1, keepdims=True) for each in (points, others)]
    rows = np.concatenate([-2 * points, squares[0], np.ones_like(squares[0])], axis=-1)
    columns = np.concatenate([others, np.ones_like(squares[1]), squares[1]], axis=-1)
    return np.maximum(rows @ np.swapaxes(columns, -1, -2), 0.0)


def farthest_points(points: Array, count: int, *, first: int) -> Integers:
    """Indices of `count` points far from each other, from `first` on (Gonzalez 1985)."""
    chosen = [first]
    distance = np.full(len(points), np.inf)
    while len(chosen) < min(count, len(points)):
        distance = np.minimum(distance, np.sum((points - points[chosen[-1]]) ** 2, axis=1))
        chosen.append(int(np.argmax(distance)))
    return np.array(chosen)


def joined(*clouds: T) -> T:
    """The rows of several dataclasses of arrays, one after the other, as one of them."""
    arrays = zip(*(vars(each).values() for each in clouds), strict=True)
    return type(clouds[0])(*map(np.concatenate, arrays))


def principal_direction(points: Array) -> Array:
    """The unit vector (2,) along the longest horizontal extent of points (n, 3)."""
    centred = points[:, :2] - points[:, :2].mean(axis=0)
    return np.linalg.eigh(centred.T @ centred)[1][:, -1]
