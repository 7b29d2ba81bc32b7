"""Triangle meshes: lofts through rings of points, files, convex pieces, shading, OBJ text.

A loft joins rings of equally many points, one after the other, and closes both ends: lathes, sweeps
and plates. Caps that are not convex are cut into triangles by clipping ears (Meisters 1975).

The physics engine collides a body as a union of convex pieces and adds a margin round each of
them. So the pieces are few (neighbours are merged where their common hull adds next to nothing)
and are shrunk by the margin beforehand: every face moves inwards by it, exactly.

Scanned and exported meshes keep the vertices on both sides of a texture's seam apart, and have
faces twice or openings. What is connected after the repair is one body; where that is not convex it
is decomposed (CoACD, Wei et al. 2022), which takes seconds, once.
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

from ...ontology.errors import DataError, extra_required
from ...ontology.part_shapes import MAX_LENGTH, MeshFile
from ..poses import Array

Faces = NDArray[np.int64]

CREASE = radians(40)  # faces that meet at a sharper angle keep an edge between them
_TINY_AREA = 5e-14  # [m^2]
MARGIN = 0.001  # [m], what PyBullet adds round a convex mesh from a file
MIN_SHARE = 0.1  # of its depth, which a piece thinner than the margin keeps

MIN_SIZE = 0.002  # [m], a smaller mesh could not be seen
MIN_THICKNESS = 1e-4  # [m], a thinner body has no inside
CONCAVITY = 0.05  # that a piece may have by CoACD's measure: a few per cent of the body's volume
# A third of CoACD's usual effort: as many pieces of a mug or a toy, in 3 to 10 s instead of 30.
EFFORT: dict[str, Any] = {
    "mcts_iterations": 40,
    "mcts_nodes": 10,
    "mcts_max_depth": 2,
    "resolution": 1000,
}
MAX_PIECES = 24  # of one body: more slow down every step


def loft(rings: Sequence[Array], *, caps: Faces | None = None) -> Trimesh:
    """Return the closed surface through rings of k points each, every one (k, 3), faces outwards.

    There are at least two rings; one may shrink to a point. `caps` are the triangles that close the
    end rings; fans when None, for convex rings.
    """
    count = len(rings[0])
    here = np.arange(len(rings) * count).reshape(-1, count)
    after = np.roll(here, -1, axis=1)
    quads = np.stack([here[:-1], after[:-1], after[1:], here[1:]], axis=-1).reshape(-1, 4)
    first = np.array([(0, i, i + 1) for i in range(1, count - 1)]) if caps is None else caps
    faces = [trimesh.geometry.triangulate_quads(quads), first[:, ::-1], first + here[-1, 0]]
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
            if (joint := ConvexHull(both)).volume <= (1 + tolerance) * (volume + other_volume):
                # The union may now fit to one that did not fit its halves: try it again.
                waiting.append((both[joint.vertices], volume + other_volume))
                del merged[i]
                break
        else:
            merged.append((piece, volume))
    return [piece for piece, _ in merged]


def shrink(points: Array, distance: float) -> Array:
    """Return the corners of a hull whose faces are moved inwards by `distance` [m]."""
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


def read_mesh(form: MeshFile) -> Trimesh:
    """Return the mesh of a file, its vertices merged and no face twice; a `DataError` for none."""
    source = str(form.path)
    try:
        loaded: Any = trimesh.load_mesh(form.path)
    except Exception as error:  # each of its readers has errors of its own
        raise DataError(f"is no mesh that can be read: {error}.", source=source) from error
    faces = getattr(loaded, "faces", None)
    with np.errstate(divide="ignore", invalid="ignore"):  # trimesh divides by volumes, also of 0
        whole = Trimesh(loaded.vertices * form.scale, faces).process(validate=True)
    mesh: Any = trimesh.util.concatenate([_cut(whole, np.array(each)) for each in form.regions])
    if not len(mesh.faces):
        raise DataError("has no faces.", source=source)
    largest = float(np.ptp(mesh.vertices, axis=0).max())
    if not MIN_SIZE <= largest <= MAX_LENGTH:
        problem = f"is {largest:g} m long with the scale {form.scale:g};"
        advice = "Many files are in millimetres: their scale is 0.001."
        expected = f"expected {MIN_SIZE:g} to {MAX_LENGTH:g} m."
        raise DataError(f"{problem} {expected} {advice}", source=source)
    return mesh


def convex_pieces(form: MeshFile) -> list[Array]:
    """Return corners (n, 3) of convex pieces of a mesh file [m]; `DataError` where it is flat."""
    bodies = read_mesh(form).split(only_watertight=False)
    for number, body in enumerate(bodies, start=1):
        if _thickness(body.vertices) < MIN_THICKNESS:
            at = ", ".join(f"{value:.4g}" for value in body.vertices.mean(axis=0))
            problem = f"piece {number} of {len(bodies)}, round ({at}) m, is flat:"
            expected = f"expected pieces {MIN_THICKNESS * 1e3:g} mm thick or more."
            advice = "Give it a thickness, or remove it."
            raise DataError(f"{problem} {expected} {advice}", source=str(form.path))
    return [piece for body in bodies for piece in _decomposed(body)]


def _cut(mesh: Trimesh, planes: Array) -> Trimesh:
    """Return what lies on the side n x > d of each of the planes (n, d) (k, 4)."""
    for *normal, distance in planes.reshape(-1, 4):
        origin = np.array(normal) * distance / np.dot(normal, normal)
        mesh = mesh.slice_plane(origin, normal, cap=mesh.is_watertight)
    return mesh


def _decomposed(body: Trimesh) -> list[Array]:
    trimesh.repair.fill_holes(body, use_fan=True)
    if body.is_convex:
        return [np.asarray(body.vertices)]
    with extra_required("sim", "coacd"):
        import coacd
    coacd.set_log_level("error")
    mesh = coacd.Mesh(body.vertices, body.faces)
    found = coacd.run_coacd(mesh, threshold=CONCAVITY, max_convex_hull=MAX_PIECES, **EFFORT)
    return [corners for corners, _ in found if _thickness(corners) >= MIN_THICKNESS]


def _thickness(points: Array) -> float:
    """Return the least extent of points (n, 3) along their principal axes [m]."""
    centred = points - points.mean(axis=0)
    return float(np.ptp(centred @ np.linalg.svd(centred, full_matrices=False)[2].T, axis=0).min())
