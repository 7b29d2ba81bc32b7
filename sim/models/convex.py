# SPDX-License-Identifier: Apache-2.0
"""Convex pieces, given by their corners: hulls, merging, shrinking, mass and inertia.

The physics engine collides a body as a union of convex pieces and adds a margin round each of
them. So the pieces are few (neighbours are merged where their common hull adds next to nothing)
and are shrunk by the margin beforehand: every face moves inwards by it, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import trimesh
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

from ..poses import Array

MARGIN = 0.001  # [m], what PyBullet adds round a convex mesh from a file
MIN_SHARE = 0.1  # of its inner radius, which a piece thinner than the margin keeps


def hull(points: Array) -> trimesh.Trimesh:
    """Return the convex hull of points (n, 3), faces outwards."""
    return trimesh.convex.convex_hull(points)


def merge(pieces: Sequence[Array], *, tolerance: float) -> list[Array]:
    """Return the pieces, merged where their common hull adds at most `tolerance` to their volume.

    Args:
        pieces: corners of each, (n, 3); they do not overlap.
        tolerance: share of the volume of the first pieces that merging may add in all.
    """
    merged: list[tuple[Array, float]] = []
    waiting = [(piece, float(ConvexHull(piece).volume)) for piece in reversed(pieces)]
    while waiting:
        piece, volume = waiting.pop()
        for i, (other, other_volume) in enumerate(merged):
            both = np.vstack([piece, other])
            joint = ConvexHull(both)
            if joint.volume <= (1 + tolerance) * (volume + other_volume):
                # The union may now fit to one that did not fit its halves: try it again.
                waiting.append((both[joint.vertices], volume + other_volume))
                del merged[i]
                break
        else:
            merged.append((piece, volume))
    return [piece for piece, _ in merged]


def shrink(points: Array, distance: float) -> Array:
    """Return the corners of a hull whose faces are moved inwards by `distance` [m].

    A piece too thin for that keeps `MIN_SHARE` of its inner radius.
    """
    planes = np.unique(np.round(ConvexHull(points).equations, 9), axis=0)
    centre, radius = _inner_ball(planes)
    offset = min(distance, (1 - MIN_SHARE) * radius)
    moved = planes + np.array([0, 0, 0, offset])
    return HalfspaceIntersection(moved, centre).intersections


def _inner_ball(planes: Array) -> tuple[Array, float]:
    """Return centre and radius of the largest ball within the half-spaces a x + b <= 0 (n, 4)."""
    lengths = np.linalg.norm(planes[:, :3], axis=1)
    answer = linprog(
        (0, 0, 0, -1),
        A_ub=np.column_stack([planes[:, :3], lengths]),
        b_ub=-planes[:, 3],
        bounds=[(None, None)] * 3 + [(0, None)],
    )
    return np.asarray(answer.x[:3]), float(answer.x[3])


def mass_properties(pieces: Sequence[Array], mass: float) -> tuple[Array, Array]:
    """Return the centre of mass (3,) [m] and the inertia about it (3, 3) [kg m^2].

    Args:
        pieces: corners of each convex piece, (n, 3); all of one density.
        mass: of all together [kg].
    """
    triangles = np.concatenate([hull(piece).triangles for piece in pieces])
    unit: Any = trimesh.triangles.mass_properties(triangles)  # of density 1
    return unit.center_mass, unit.inertia * (mass / unit.volume)
