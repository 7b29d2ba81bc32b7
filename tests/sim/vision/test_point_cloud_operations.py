"""Operations on point clouds."""

import numpy as np

from hilt.sim.vision.point_cloud_operations import farthest_points, voxel_downsample


def test_downsampling_keeps_one_point_of_each_voxel():
    """No voxel keeps two points, and none that held any is left empty."""
    points = np.random.default_rng(1).uniform(0, 0.05, (800, 3))

    kept = np.floor(points[voxel_downsample(points, 0.01)] / 0.01)

    assert len(np.unique(kept, axis=0)) == len(kept)
    assert len(kept) == len(np.unique(np.floor(points / 0.01), axis=0))


def test_farthest_points_start_with_the_ends():
    """From a row of points the ends come before the middle."""
    row = np.column_stack([np.linspace(0, 1, 11), np.zeros(11), np.zeros(11)])

    assert list(farthest_points(row, 3, first=0)) == [0, 10, 5]
