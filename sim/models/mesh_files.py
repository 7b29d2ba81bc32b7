"""Meshes from files: the surface that is seen, and the convex pieces that are felt.

Scanned and exported meshes keep the vertices on both sides of a texture's seam apart, and have
faces twice or openings. What is connected after the repair is one body; where that is not convex it
is decomposed (CoACD, Wei et al. 2022), which takes seconds, once.
"""

from typing import Any

import numpy as np
import trimesh
from trimesh import Trimesh

from ...ontology.errors import DataError, extra_required
from ...ontology.part_shapes import MAX_LENGTH, MeshFile
from ..poses import Array

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
        raise DataError(
            f"is {largest:g} m long with the scale {form.scale:g}; expected {MIN_SIZE:g} to "
            f"{MAX_LENGTH:g} m. Many files are in millimetres: their scale is 0.001.",
            source=source,
        )
    return mesh


def convex_pieces(form: MeshFile) -> list[Array]:
    """Return corners (n, 3) of convex pieces of a mesh file [m]; `DataError` where it is flat."""
    bodies = read_mesh(form).split(only_watertight=False)
    for number, body in enumerate(bodies, start=1):
        if _thickness(body.vertices) < MIN_THICKNESS:
            at = ", ".join(f"{value:.4g}" for value in body.vertices.mean(axis=0))
            raise DataError(
                f"piece {number} of {len(bodies)}, round ({at}) m, is flat: expected pieces "
                f"{MIN_THICKNESS * 1e3:g} mm thick or more. Give it a thickness, or remove it.",
                source=str(form.path),
            )
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
    axes = np.linalg.svd(centred, full_matrices=False)[2]
    return float(np.ptp(centred @ axes.T, axis=0).min())
