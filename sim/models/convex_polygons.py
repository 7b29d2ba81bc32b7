# SPDX-License-Identifier: Apache-2.0
"""Convex polygons: the hull of points, its area, and the distance of two polygons.

scipy's `ConvexHull` would add 0.3 s to the start of a scene, for its import, and refuses points on
one line.
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from ..poses import Array


def convex_hull(points: Array) -> Array:
    """Return the corners (k, 2) of the convex hull of points (n, 2), counter-clockwise.

    Andrew's monotone chain (1979). Points on one line have two corners.
    """
    ordered = np.unique(points, axis=0)
    if len(ordered) < 3:
        return ordered
    corners = ordered.tolist()
    return np.array(_half_hull(corners)[:-1] + _half_hull(reversed(corners))[:-1])


def area(polygon: Array) -> float:
    """Return the area of a polygon (k, 2) [m^2]."""
    x, y = polygon.T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def distance(first: Array, second: Array) -> float:
    """Return the distance of two convex polygons (n, 2) and (m, 2) [m]; 0 if they overlap."""
    if not (_separated(first, second) or _separated(second, first)):
        return 0.0
    return min(_corner_distance(first, second), _corner_distance(second, first))


def _half_hull(points: Iterable[list[float]]) -> list[list[float]]:
    chain: list[list[float]] = []
    for point in points:
        while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
            chain.pop()
        chain.append(point)
    return chain


def _turn(a: list[float], b: list[float], c: list[float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def _separated(first: Array, second: Array) -> bool:
    """Return whether a side of the first polygon has all of the second on its outer side."""
    ahead = np.roll(first, -1, axis=0) - first
    offsets = second[None] - first[:, None]  # (sides, corners, 2)
    aside = ahead[:, None, 0] * offsets[..., 1] - ahead[:, None, 1] * offsets[..., 0]
    return bool((aside < 0).all(axis=1).any())


def _corner_distance(corners: Array, polygon: Array) -> float:
    ahead = np.roll(polygon, -1, axis=0) - polygon
    offsets = corners[:, None] - polygon[None]  # (corners, sides, 2)
    along = np.einsum("csd,sd->cs", offsets, ahead) / np.einsum("sd,sd->s", ahead, ahead)
    nearest = offsets - np.clip(along, 0, 1)[..., None] * ahead[None]
    return float(np.linalg.norm(nearest, axis=2).min())
