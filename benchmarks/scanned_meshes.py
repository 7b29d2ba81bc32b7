"""Four objects of mesh files, in two parts each, as stand-ins for a set of scans.

The mug and the duck are files of `pybullet_data`: the mug is two surfaces, the duck one with the
seams of its texture, which is cut open at the neck. The drill and the scissors are made here and
spoilt as scans are: each vertex is off by 0.15 mm, the seams of a texture cut the surface into up
to 60 charts that share no vertex, there are two openings in each piece, and 3 % of the faces are
there twice. No part is convex, and none is closed but the mug's.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np
import pybullet_data
import trimesh
from numpy.typing import NDArray
from trimesh import Trimesh

from hilt.ontology.disk_cache import cache_folder
from hilt.ontology.objects import ObjectType, load_household
from hilt.sim.models.meshes import loft

SHIPPED = Path(pybullet_data.getDataPath())
MUG_SCALE = 0.9  # 7.4 cm wide: the hand opens to 7.8 cm
DUCK_SCALE = 0.05  # to 8 cm long
NECK = 0.97  # height in the file of the duck
EDGE = 0.006  # [m], longest edge of a scan
ROUGHNESS = 0.00015  # [m], standard deviation of a vertex
OPENINGS, OPENING_RADIUS = 2, 0.004  # of each piece, [m]
CHARTS = 30  # of each piece
TWICE = 0.03  # share of the faces
DRILL = [
    (0.0, 0.0), (0.023, 0.0), (0.026, 0.008), (0.026, 0.1), (0.02, 0.116), (0.016, 0.12),
    (0.018, 0.126), (0.013, 0.15), (0.004, 0.153), (0.003, 0.19), (0.0, 0.19),
]  # fmt: skip
GRIP = [(0.02, 0.04, 0.034), (0.1, 0.038, 0.032), (0.104, 0.078, 0.05), (0.136, 0.078, 0.05)]
OBJECTS = """
objects:
  cup:
    is_a: vessel
    parts:
      barrel: {role: container, material: ceramic, colour: "#b0483c", mass: 0.25, shape: [{mesh: {file: barrel.obj, scale: 1}}]}
      handle: {role: grip, material: ceramic, colour: "#b0483c", mass: 0.04, shape: [{mesh: {file: cup_handle.obj, scale: 1}}]}
    rests: {upright: {turn_deg: [0, 0, 0]}}
  duck:
    is_a: artifact
    parts:
      body: {role: base, material: plastic, colour: "#e8c22e", mass: 0.06, shape: [{mesh: {file: body.obj, scale: 1}}]}
      head: {role: cover, material: plastic, colour: "#e8c22e", mass: 0.03, shape: [{mesh: {file: head.obj, scale: 1}}]}
    rests: {upright: {turn_deg: [0, 0, 0]}}
  drill:
    is_a: tool
    parts:
      housing: {role: striker, material: plastic, colour: "#2f5f9e", mass: 0.45, shape: [{mesh: {file: housing.obj, scale: 1}}]}
      grip: {role: grip, material: rubber, colour: "#26282b", mass: 0.45, shape: [{mesh: {file: grip.obj, scale: 1}}]}
    rests: {flat: {turn_deg: [0, 0, 0]}}
  scissors:
    is_a: tool
    parts:
      handle: {role: grip, material: plastic, colour: "#d0532e", mass: 0.04, shape: [{mesh: {file: rings.obj, scale: 1}}]}
      blade: {role: edge, material: steel, colour: "#bcc2c8", mass: 0.05, shape: [{mesh: {file: blades.obj, scale: 1}}]}
    rests: {flat: {turn_deg: [0, 0, 0]}}
"""  # noqa: E501 - as a person would write it


def scanned_objects(known: Mapping[str, ObjectType]) -> dict[str, ObjectType]:
    """Return the four objects; their files are written into the user's cache."""
    folder = cache_folder() / "benchmarks" / "scans"
    folder.mkdir(parents=True, exist_ok=True)
    for name, mesh in {**_mug(), **_duck(), **_drill(), **_scissors()}.items():
        (folder / f"{name}.obj").write_text(mesh.export(file_type="obj"), encoding="ascii")
    (folder / "objects.yaml").write_text(OBJECTS, encoding="utf-8")
    found = load_household(folder / "objects.yaml", added_to=load_household()).objects
    return {name: kind for name, kind in found.items() if name not in known}


def _mug() -> dict[str, Trimesh]:
    mesh = trimesh.load_mesh(SHIPPED / "objects" / "mug.obj")
    pieces = Trimesh(MUG_SCALE * mesh.vertices, mesh.faces).split(only_watertight=False)
    barrel, handle = sorted(pieces, key=lambda piece: -piece.extents[0])
    return {"barrel": barrel, "cup_handle": handle}


def _duck() -> dict[str, Trimesh]:
    mesh = trimesh.load(SHIPPED / "duck.obj", process=False, force="mesh")
    x, y, z = mesh.vertices.T
    whole = Trimesh(np.column_stack([x, -z, y]), mesh.faces, process=False)
    sides = {"body": (0, 0, -1), "head": (0, 0, 1)}
    cut = {name: whole.slice_plane((0, 0, NECK), side) for name, side in sides.items()}
    return {name: part.apply_scale(DUCK_SCALE) for name, part in cut.items()}


def _drill() -> dict[str, Trimesh]:
    lying = trimesh.transformations.rotation_matrix(np.pi / 2, (0, 1, 0), (0, 0, 0))
    housing = trimesh.creation.revolve(DRILL, sections=32).apply_transform(lying)
    housing.apply_translation((-0.05, 0.0, 0.026))
    angles = np.arange(24) * 2 * np.pi / 24
    rounded = np.sign(np.cos(angles)) * np.abs(np.cos(angles)) ** 0.5, np.sin(angles)
    rounded = rounded[0], np.sign(rounded[1]) * np.abs(rounded[1]) ** 0.5
    rings = [
        np.column_stack([wide / 2 * rounded[0], np.full(24, -y), high / 2 * rounded[1] + 0.026])
        for y, wide, high in GRIP
    ]
    return {"housing": _scanned([housing], 1), "grip": _scanned([loft(rings)], 2)}


def _scissors() -> dict[str, Trimesh]:
    rings, blades = list[Trimesh](), list[Trimesh]()
    for side in (-1, 1):
        ring = trimesh.creation.torus(0.018, 0.0045, major_sections=32, minor_sections=16)
        ring.apply_scale((1.4, 1.0, 1.0)).apply_translation((-0.075, side * 0.021, 0.0045))
        shank = _bar((-0.055, side * 0.012), (0.0, -side * 0.002), (0.009, 0.007), 0.008, 0.0045)
        rings += [ring, shank]
        blade = _bar((0.0, -side * 0.002), (0.1, -side * 0.004), (0.014, 0.003), 0.003, 0.0045)
        blades.append(blade.apply_translation((0, 0, side * 0.0016)))
    return {"rings": _scanned(rings, 3), "blades": _scanned(blades, 4)}


def _bar(
    start: tuple[float, float],
    end: tuple[float, float],
    widths: tuple[float, float],
    thickness: float,
    height: float,
) -> Trimesh:
    """Return a level bar that changes its width, from one point (x, y) to another [m]."""
    square = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)]) / 2
    rings = [
        np.column_stack(
            [np.full(4, x), y + width * square[:, 0], height + thickness * square[:, 1]]
        )
        for (x, y), width in zip((start, end), widths, strict=True)
    ]
    return loft(rings)


def _scanned(pieces: Sequence[Trimesh], seed: int) -> Trimesh:
    rng = np.random.default_rng(seed)
    return trimesh.util.concatenate([_spoilt(piece, rng) for piece in pieces])


def _spoilt(piece: Trimesh, rng: np.random.Generator) -> Trimesh:
    """Return a surface as a scanner would give it."""
    corners, faces = trimesh.remesh.subdivide_to_size(piece.vertices, piece.faces, EDGE)
    fine = Trimesh(corners, faces)
    corners = fine.vertices + rng.normal(0.0, ROUGHNESS, fine.vertices.shape)
    middles = fine.triangles_center
    missed = middles[rng.choice(len(middles), OPENINGS, replace=False)]
    seen = np.flatnonzero((_distances(middles, missed) > OPENING_RADIUS).all(axis=1))
    again = seen[rng.random(len(seen)) < TWICE]
    chart = _distances(middles, middles[rng.choice(seen, CHARTS)]).argmin(axis=1)
    charts = [fine.faces[index] for index in _grouped(np.append(seen, again), chart)]
    meshes = [Trimesh(corners, each, process=False) for each in charts]
    for mesh in meshes:
        mesh.remove_unreferenced_vertices()
    return trimesh.util.concatenate(meshes)


def _grouped(faces: NDArray[np.int64], chart: NDArray[np.int64]) -> list[NDArray[np.int64]]:
    groups = (faces[chart[faces] == number] for number in range(CHARTS))
    return [group for group in groups if len(group)]


def _distances(points: NDArray[np.float64], others: NDArray[np.float64]) -> NDArray[np.float64]:
    return np.linalg.norm(points[:, None] - others[None], axis=-1)
