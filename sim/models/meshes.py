"""Triangle meshes: lofts through rings of points, convex pieces, shading, Wavefront OBJ text.

A loft joins rings of equally many points, one after the other, and closes both ends: lathes, sweeps
and plates. Caps that are not convex are cut into triangles by clipping ears (Meisters 1975).

The physics engine collides a body as a union of convex pieces and adds a margin round each of
them. So the pieces are few (neighbours are merged where their common hull adds next to nothing)
and are shrunk by the margin beforehand: every face moves inwards by it, exactly.
"""

from collections.abc import Sequence
from math import radians
from typing import Any

import numpy as np
import shapely
import trimesh
from numpy.typing import NDArray
from scipy.spatial import ConvexHull, HalfspaceIntersection
from trimesh import Trimesh
from trimesh.convex import convex_hull

from ..poses import Array

Faces = NDArray[np.int64]

CREASE = radians(40)  # faces that meet at a sharper angle keep an edge between them
_TINY_AREA = 5e-14  # [m^2]
MARGIN = 0.001  # [m], what PyBullet adds round a convex mesh from a file
MIN_SHARE = 0.1  # of its depth, which a piece thinner than the margin keeps


def loft(rings: Sequence[Array], *, caps: Faces | None = None) -> Trimesh:
    """Return the closed surface through rings of k points each, every one (k, 3), faces outwards.

    There are at least two rings; one may shrink to a point. `caps` are the triangles that close the
    end rings; fans when None, for convex rings.
    """
    count = len(rings[0])
    here = np.arange(len(rings) * count).reshape(-1, count)
    after = np.roll(here, -1, axis=1)
    quads = np.stack([here[:-1], after[:-1], after[1:], here[1:]], axis=-1).reshape(-1, 4)
    fan = [(0, i, i + 1) for i in range(1, count - 1)]
    first = np.array(fan) if caps is None else caps
    last = first + here[-1, 0]
    faces = [trimesh.geometry.triangulate_quads(quads), first[:, ::-1], last]
    mesh = Trimesh(np.vstack(rings), np.vstack(faces), process=False)
    mesh.merge_vertices(digits_vertex=8)
    mesh.update_faces(mesh.area_faces > _TINY_AREA)
    if mesh.volume < 0:
        mesh.invert()
    return mesh


def triangulate(outline: Array) -> Faces:
    """Return triangles (k - 2, 3) that fill a simple polygon (k, 2), counter-clockwise."""
    rest, faces = np.arange(len(outline)), list[Faces]()
    while len(rest) > 3:
        corners = np.column_stack([np.roll(rest, 1), rest, np.roll(rest, -1)])
        triangles = shapely.polygons(outline[corners])
        inside = shapely.covers(shapely.Polygon(outline[rest]), triangles)
        ear = int(np.argmax(inside & (shapely.area(triangles) > 0)))
        faces.append(corners[ear])
        rest = np.delete(rest, ear)
    return np.vstack([*faces, rest])


def shaded_obj(mesh: Trimesh) -> str:
    """Return the mesh as OBJ text with normals for shading: no faces beyond a crease share one."""
    smooth = trimesh.graph.smooth_shade(mesh, angle=CREASE, facet_minarea=None)
    return str(smooth.export(file_type="obj", include_normals=True, digits=6, header=None))


def merge(pieces: Sequence[Array], *, tolerance: float) -> list[Array]:
    """Return pieces (n, 3), merged where that adds at most a share `tolerance` of their volume."""
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

    A piece too thin for that keeps `MIN_SHARE` of the distance from its centre to its nearest face.
    """
    planes = np.unique(np.round(ConvexHull(points).equations, 9), axis=0)
    centre = convex_hull(points).center_mass
    depth = -float((planes[:, :3] @ centre + planes[:, 3]).max())
    moved = planes + np.array([0, 0, 0, min(distance, (1 - MIN_SHARE) * depth)])
    return HalfspaceIntersection(moved, centre).intersections


def mass_properties(pieces: Sequence[Array], mass: float) -> tuple[Array, Array]:
    """Return centre of mass (3,) [m] and inertia (3, 3) [kg m^2] of pieces of one density."""
    triangles = np.concatenate([convex_hull(piece).triangles for piece in pieces])
    unit: Any = trimesh.triangles.mass_properties(triangles)  # of density 1
    return unit.center_mass, unit.inertia * (mass / unit.volume)
