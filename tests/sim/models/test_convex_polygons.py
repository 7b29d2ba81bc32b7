# SPDX-License-Identifier: Apache-2.0
"""Convex polygons: hull, area and distance."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.sim.models.convex_polygons import area, convex_hull, distance

coordinates = st.floats(-1, 1).map(lambda x: round(x, 3))
clouds = st.lists(st.tuples(coordinates, coordinates), min_size=5, max_size=12, unique=True)

SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


def test_hull_of_a_square_and_its_middle_is_the_square():
    """Points within the hull, on its sides and repeated ones are no corners."""
    others = np.array([(0.5, 0.5), (0.5, 0.0), (1.0, 1.0)])

    hull = convex_hull(np.vstack([others, SQUARE]))

    assert hull.tolist() == SQUARE.tolist()
    assert area(hull) == 1.0


@pytest.mark.parametrize("points", [[(1, 2)], [(1, 2), (3, 4)], [(0, 0), (1, 1), (2, 2)]])
def test_hull_of_points_on_a_line_has_no_area(points: list[tuple[float, float]]):
    """A point and a line have a hull too."""
    assert area(convex_hull(np.array(points, float))) == 0


@settings(max_examples=50)
@given(clouds)
def test_all_points_lie_within_their_hull(cloud: list[tuple[float, float]]):
    """No point is to the right of a side, so the hull turns left at every corner."""
    hull = convex_hull(np.array(cloud))

    ahead = np.roll(hull, -1, axis=0) - hull
    offsets = np.array(cloud)[None] - hull[:, None]
    assert (ahead[:, None, 0] * offsets[..., 1] - ahead[:, None, 1] * offsets[..., 0] > -1e-9).all()


@settings(max_examples=50)
@given(clouds, clouds)
def test_distance_is_symmetric(first, second):
    """It does not matter from which polygon one measures."""
    a, b = (
        convex_hull(np.array(cloud) + np.arange(len(cloud))[:, None] * 1e-4)
        for cloud in (first, second)
    )

    assert distance(a, b) == pytest.approx(distance(b, a))


@pytest.mark.parametrize(
    ("shift", "expected"),
    [((3, 0), 2.0), ((0.5, 0.5), 0.0), ((4, 5), 5.0), ((0, 0), 0.0), ((0.2, 1.5), 0.5)],
)
def test_distance_of_squares(shift: tuple[float, float], expected: float):
    """Unit squares apart by a shift are as far apart as geometry says; overlapping ones are not."""
    assert distance(SQUARE, SQUARE + shift) == pytest.approx(expected)
