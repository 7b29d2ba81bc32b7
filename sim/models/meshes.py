# SPDX-License-Identifier: Apache-2.0
"""Triangle meshes: made by lofting rings, shaded by crease angle, written as Wavefront OBJ.

A loft joins rings of equally many points, one after the other, and closes both ends. Lathes,
sweeps and plates are all lofts. Caps of rings that are not convex are cut into triangles by
clipping ears (Meisters 1975).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import cos, radians

import numpy as np
from numpy.typing import NDArray

from ..poses import Array

Faces = NDArray[np.int64]

CREASE = cos(radians(40))  # faces that meet at a sharper angle keep an edge between them
_TINY_AREA = 1e-13  # [m^2]


@dataclass(frozen=True)
class Mesh:
    """A surface of triangles.

    Attributes:
        vertices: (n, 3) [m].
        faces: (m, 3) indices into the vertices, counter-clockwise seen from outside.
    """

    vertices: Array
    faces: Faces

    @property
    def volume(self) -> float:
        """The volume inside a closed surface [m^3]; negative when it is inside out."""
        a, b, c = (self.vertices[self.faces[:, i]] for i in range(3))
        return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def loft(rings: Sequence[Array], *, convex_ends: bool = True) -> Mesh:
    """The closed surface through rings of k points each, every one (k, 3).

    Args:
        rings: at least two; a ring may shrink to a point.
        convex_ends: whether the end rings are convex, so that their caps can be plain fans.
    """
    count = len(rings[0])
    vertices = np.vstack(rings)
    faces = np.vstack([_band(i * count, count) for i in range(len(rings) - 1)])
    ends = [(rings[0], 0), (rings[-1], (len(rings) - 1) * count)]
    first, last = (
        start + (_fan(count) if convex_ends else triangulate(flatten(ring))) for ring, start in ends
    )
    mesh = _cleaned(vertices, np.vstack([faces, first[:, ::-1], last]))
    return mesh if mesh.volume >= 0 else Mesh(mesh.vertices, mesh.faces[:, ::-1])


def _band(start: int, count: int) -> Faces:
    low = start + np.arange(count)
    low_next = start + (np.arange(count) + 1) % count
    high, high_next = low + count, low_next + count
    return np.vstack([np.stack([low, low_next, high_next], 1), np.stack([low, high_next, high], 1)])


def _fan(count: int) -> Faces:
    rest = np.arange(1, count - 1)
    return np.stack([np.zeros_like(rest), rest, rest + 1], 1)


def flatten(ring: Array) -> Array:
    """A ring (k, 3) in coordinates of its own plane (k, 2), counter-clockwise."""
    centred = ring - ring.mean(axis=0)
    normal = np.cross(centred, np.roll(centred, -1, axis=0)).sum(axis=0)
    axis = np.eye(3)[np.argmin(np.abs(normal))]
    first = np.cross(axis, normal)
    second = np.cross(normal, first)
    basis = np.stack([first / np.linalg.norm(first), second / np.linalg.norm(second)], 1)
    return centred @ basis


def triangulate(outline: Array) -> Faces:
    """Cut a simple polygon (k, 2), counter-clockwise, into triangles (k - 2, 3)."""
    rest, faces = list(range(len(outline))), list[tuple[int, int, int]]()
    while len(rest) > 3:
        ear = next((i for i in range(len(rest)) if _is_ear(outline, rest, i)), 0)
        faces.append((rest[ear - 1], rest[ear], rest[(ear + 1) % len(rest)]))
        del rest[ear]
    faces.append((rest[0], rest[1], rest[2]))
    return np.array(faces)


def _is_ear(outline: Array, rest: list[int], i: int) -> bool:
    corners = (rest[i - 1], rest[i], rest[(i + 1) % len(rest)])
    a, b, c = outline[list(corners)]
    if _turn(a, b, c) <= 0:
        return False
    others = outline[[j for j in rest if j not in corners]]
    inside = (_turn(a, b, others) >= 0) & (_turn(b, c, others) >= 0) & (_turn(c, a, others) >= 0)
    return not inside.any()


def _turn(a: Array, b: Array, points: Array) -> Array:
    ahead, aside = b - a, points - a
    return ahead[0] * aside[..., 1] - ahead[1] * aside[..., 0]


def _cleaned(vertices: Array, faces: Faces) -> Mesh:
    """The mesh with equal vertices joined and faces without area left out."""
    _, first, index = np.unique(
        np.round(vertices, 8), axis=0, return_index=True, return_inverse=True
    )
    mesh = Mesh(vertices[first], index.ravel()[faces])
    return Mesh(mesh.vertices, mesh.faces[np.linalg.norm(_face_normals(mesh), axis=1) > _TINY_AREA])


def _face_normals(mesh: Mesh) -> Array:
    """Normals of the faces (m, 3), as long as twice their area."""
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return np.cross(b - a, c - a)


def corner_normals(mesh: Mesh) -> Array:
    """Unit normals for shading, one for each corner of each face (m, 3, 3).

    A corner takes the mean of the faces round it, weighted by area, without those beyond a crease.
    """
    weighted = _face_normals(mesh)
    unit = weighted / np.linalg.norm(weighted, axis=1, keepdims=True)
    round_vertex: list[list[int]] = [[] for _ in mesh.vertices]
    for face, corners in enumerate(mesh.faces):
        for vertex in corners:
            round_vertex[vertex].append(face)
    result = np.empty((len(mesh.faces), 3, 3))
    for face, corners in enumerate(mesh.faces):
        for corner, vertex in enumerate(corners):
            near = np.array(round_vertex[vertex])
            alike = near[unit[near] @ unit[face] > CREASE]
            result[face, corner] = weighted[alike].sum(axis=0)
    return result / np.linalg.norm(result, axis=2, keepdims=True)


def shaded_obj(mesh: Mesh) -> str:
    """The mesh as OBJ text with normals for shading."""
    normals = corner_normals(mesh).reshape(-1, 3)
    unique, index = np.unique(np.round(normals, 4), axis=0, return_inverse=True)
    corners = index.reshape(-1, 3) + 1
    lines = [f"v {x:.6f} {y:.6f} {z:.6f}" for x, y, z in mesh.vertices]
    lines += [f"vn {x:.4f} {y:.4f} {z:.4f}" for x, y, z in unique]
    lines += [
        f"f {a}//{i} {b}//{j} {c}//{k}"
        for (a, b, c), (i, j, k) in zip(mesh.faces + 1, corners, strict=True)
    ]
    return "\n".join(lines) + "\n"


def grouped_obj(meshes: Sequence[Mesh]) -> str:
    """Several meshes as OBJ text, each a group of its own."""
    lines: list[str] = []
    start = 1
    for number, mesh in enumerate(meshes):
        lines.append(f"o piece_{number}")
        lines += [f"v {x:.7f} {y:.7f} {z:.7f}" for x, y, z in mesh.vertices]
        lines += [f"f {a} {b} {c}" for a, b, c in mesh.faces + start]
        start += len(mesh.vertices)
    return "\n".join(lines) + "\n"
