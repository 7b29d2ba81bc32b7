"""Poses: composition, inversion and the way between two of them; and operations on points."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.sim import poses

angles = st.floats(-np.pi, np.pi)
vectors = st.tuples(*[st.floats(-1, 1)] * 3)


@st.composite
def any_pose(draw: st.DrawFn) -> poses.Array:
    """A pose within a metre of the origin."""
    rotation = poses.rotation_from_rpy(draw(angles), draw(angles), draw(angles))
    return poses.pose(rotation, draw(vectors))


@given(any_pose())
def test_pose_times_its_inverse_is_the_identity(a_from_b):
    """A pose and its inverse cancel."""
    both = a_from_b @ poses.inverse(a_from_b)

    assert np.allclose(both, np.eye(4), atol=1e-12)


@given(any_pose(), any_pose(), vectors)
def test_transform_composes_as_the_product_does(a_from_b, b_from_c, point):
    """Transforming twice is transforming by the product."""
    points = np.array([point])

    twice = poses.transform(a_from_b, poses.transform(b_from_c, points))

    assert np.allclose(twice, poses.transform(a_from_b @ b_from_c, points))


@given(vectors.filter(lambda v: np.linalg.norm(v) > 1e-3), st.floats(0.0, np.pi))
def test_rotation_vector_gives_back_axis_and_angle(axis, angle):
    """Taking the rotation vector undoes turning about an axis."""
    unit = np.array(axis) / np.linalg.norm(axis)

    rotation = poses.rotation_about(unit, angle)
    again = poses.rotation_vector(rotation)
    length = np.linalg.norm(again)

    assert length == pytest.approx(angle, abs=1e-6)
    assert np.allclose(
        poses.rotation_about(again / max(length, 1e-12), length), rotation, atol=1e-6
    )


@given(any_pose(), any_pose())
def test_interpolate_starts_and_ends_at_the_poses(start, end):
    """The way between two poses leads from the one to the other."""
    way = poses.interpolate(start, end, [0.0, 0.5, 1.0])

    assert np.allclose(way[0], start, atol=1e-6)
    assert np.allclose(way[-1], end, atol=1e-6)


def test_rpy_turns_about_the_fixed_axes_in_turn():
    """A URDF's rpy turns first about x, then about the fixed y and z."""
    rotation = poses.rotation_from_rpy(np.pi / 2, 0.0, np.pi / 2)

    assert np.allclose(rotation @ [0, 1, 0], [0, 0, 1])
    assert np.allclose(rotation @ [1, 0, 0], [0, 1, 0])


def test_downsampling_keeps_one_point_of_each_voxel():
    """No voxel keeps two points, and none that held any is left empty."""
    points = np.random.default_rng(1).uniform(0, 0.05, (800, 3))

    kept = np.floor(points[poses.voxel_downsample(points, 0.01)] / 0.01)

    assert len(np.unique(kept, axis=0)) == len(kept)
    assert len(kept) == len(np.unique(np.floor(points / 0.01), axis=0))


def test_farthest_points_start_with_the_ends():
    """From a row of points the ends come before the middle."""
    row = np.column_stack([np.linspace(0, 1, 11), np.zeros(11), np.zeros(11)])

    assert list(poses.farthest_points(row, 3, first=0)) == [0, 10, 5]
