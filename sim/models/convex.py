# SPDX-License-Identifier: Apache-2.0
"""Convex bodies, given by their corners: hulls, volume and inertia, merging, shrinking.

The physics engine feels a body as a union of convex pieces and lays a margin round each of them.
So the pieces are few (neighbours are merged where their common hull adds next to nothing) and
are shrunk by the margin beforehand: every face moves inwards by it, exactly.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

from ..poses import Array
from .meshes import Mesh

MARGIN = 0.001  # [m], what PyBullet lays round a convex mesh from a file
KEPT = 0.1  # share of its inner radius that a piece thinner than the margin keeps


def hull(points: Array) -> Mesh:
    """The convex hull of points (n, 3), faces outwards."""
    found = ConvexHull(points)
    inside = points[found.vertices].mean(axis=0)
    faces = found.simplices.copy()
    a, b, c = (points[faces[:, i]] for i in range(3))
    inwards = np.einsum("ij,ij->i", np.cross(b - a, c - a), a - inside) < 0
    faces[inwards] = faces[inwards][:, ::-1]
    used, index = np.unique(faces, return_inverse=True)
    return Mesh(points[used], index.reshape(-1, 3))


def merge(pieces: Sequence[Array], *, tolerance: float) -> list[Array]:
    """Join pieces as long as their common hull is at most `tolerance` larger than they are.

    Args:
        pieces: corners of each, (n, 3); they do not overlap.
        tolerance: share of the volume of the first pieces that a joint hull may add in all.
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
    """The corners of a hull whose faces are moved inwards by `distance` [m].

    A piece too thin for that keeps a little of its inner radius.
    """
    planes = np.unique(np.round(ConvexHull(points).equations, 9), axis=0)
    centre, radius = _inner_ball(planes)
    offset = min(distance, (1 - KEPT) * radius)
    moved = planes + np.array([0, 0, 0, offset])
    return HalfspaceIntersection(moved, centre).intersections


def _inner_ball(planes: Array) -> tuple[Array, float]:
    """Centre and radius of the largest ball inside planes a x + b <= 0, as (n, 4)."""
    lengths = np.linalg.norm(planes[:, :3], axis=1)
    answer = linprog(
        (0, 0, 0, -1),
        A_ub=np.column_stack([planes[:, :3], lengths]),
        b_ub=-planes[:, 3],
        bounds=[(None, None)] * 3 + [(0, None)],
    )
    return np.asarray(answer.x[:3]), float(answer.x[3])


def mass_properties(pieces: Sequence[Array], mass: float) -> tuple[Array, Array]:
    """Centre of mass (3,) [m] and inertia about it (3, 3) [kg m^2] of pieces of one density."""
    moments = [_moments(hull(piece)) for piece in pieces]
    volume = sum(each[0] for each in moments)
    first = np.sum([each[1] for each in moments], axis=0)
    second = np.sum([each[2] for each in moments], axis=0)
    centre = first / volume
    covariance = mass * (second / volume - np.outer(centre, centre))
    return centre, np.trace(covariance) * np.eye(3) - covariance


def _moments(mesh: Mesh) -> tuple[float, Array, Array]:
    """Integrals of 1, x and x x^T over the inside, summed over tetrahedra from the origin."""
    corners = mesh.vertices[mesh.faces]  # (m, 3 corners, 3)
    volumes = np.linalg.det(corners) / 6
    total = corners.sum(axis=1)
    second = np.einsum("m,mci,mcj->ij", volumes, corners, corners)
    second += np.einsum("m,mi,mj->ij", volumes, total, total)
    return float(volumes.sum()), volumes @ total / 4, second / 20
