"""Solids as geometry: for each form a visual surface and convex pieces for collisions.

The surface is fine and shaded; the pieces are few. Both come from the same rings of points (see
`meshes`), so that what a camera sees and what a finger touches differ by little: some tenths of a
millimetre on tools, at most 1.5 mm in the hollows of a shoe's sole. Thin-walled solids are cut into
convex pieces: a vessel into staves and a floor, a bent rod into segments, a plate into prisms.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
import trimesh
from scipy.interpolate import Akima1DInterpolator, CubicSpline

from ...ontology import part_shapes as forms
from .. import poses
from ..poses import Array
from . import meshes
from .meshes import convex_pieces, loft, read_mesh, triangulate

VISUAL_SIDES, COLLISION_SIDES = 48, 24  # corners of a circle
STAVES = 20  # of a vessel: few enough to be fast, and 0.5 mm flat on a mug
VISUAL_SECTION, COLLISION_SECTION = 28, 16  # corners of a swept section
VISUAL_STEPS, COLLISION_STEPS = 4, 2  # pieces between two points of a smooth curve
MERGE_TOLERANCE = 0.01  # share of volume that merging two convex pieces may add
STAVE_TOLERANCE = 0.06  # the same for the staves of a thin wall: 0.1 mm on 2 mm


@dataclass(frozen=True)
class SolidGeometry:
    """The geometry of one solid in the frame of its object."""

    visual: trimesh.Trimesh | None  #: the surface that cameras see; None when it is invisible
    collision: tuple[Array, ...]  #: corners (n, 3) of each of the convex pieces that collide [m]


def build_solid(solid: forms.PlacedSolid) -> SolidGeometry:
    """Return the geometry of a solid at its place."""
    object_from_solid = poses.pose(poses.rotation_from_rpy(*solid.turn), solid.at)
    visual = None
    if solid.visible:
        visual = _surface(solid.form)
        visual.vertices = poses.transform(object_from_solid, visual.vertices)
    pieces = _pieces(solid.form) if solid.collides else ()
    moved = tuple(poses.transform(object_from_solid, piece) for piece in pieces)
    return SolidGeometry(visual, moved)


def _surface(form: forms.Form) -> trimesh.Trimesh:
    match form:
        case forms.Box():
            return trimesh.convex.convex_hull(_box_corners(form))
        case forms.Lathe():
            return loft(_lathe_rings(form, form.sides or VISUAL_SIDES, VISUAL_STEPS))
        case forms.Extrusion():
            rings = _plate_rings(form, VISUAL_STEPS)
            return loft(rings, caps=triangulate(rings[0][:, :2]))
        case forms.Sweep():
            return loft(_sweep_rings(form, VISUAL_SECTION, VISUAL_STEPS))
        case forms.MeshFile():
            return read_mesh(form)


def _pieces(form: forms.Form) -> Sequence[Array]:
    match form:
        case forms.Box():
            return [_box_corners(form)]
        case forms.Lathe() if form.wall:
            return _vessel_pieces(form)
        case forms.Lathe():
            return _segments(_lathe_rings(form, form.sides or COLLISION_SIDES, COLLISION_STEPS))
        case forms.Extrusion():
            rings = _plate_rings(form, COLLISION_STEPS)
            rim = rings[len(rings) // 2][:, :2]  # which is not bevelled
            prisms = [np.vstack([ring[each] for ring in rings]) for each in triangulate(rim)]
            return meshes.merge(prisms, tolerance=MERGE_TOLERANCE)
        case forms.Sweep():
            return _segments(_sweep_rings(form, COLLISION_SECTION, COLLISION_STEPS))
        case forms.MeshFile():
            return convex_pieces(form)


def _segments(rings: Sequence[Array], *, tolerance: float = MERGE_TOLERANCE) -> list[Array]:
    return meshes.merge([np.vstack(pair) for pair in pairwise(rings)], tolerance=tolerance)


def _curve(points: Array, steps: int, *, closed: bool = False) -> Array:
    through = np.vstack([points, points[:1]]) if closed else points
    lengths = np.linalg.norm(np.diff(through, axis=0), axis=1)
    knots = np.concatenate([[0.0], np.cumsum(lengths)])
    fine = np.interp(np.arange(steps * len(lengths) + 1) / steps, np.arange(len(knots)), knots)
    if closed:
        return CubicSpline(knots, through, bc_type="periodic")(fine)[:-1]
    # Akima's curve does not overshoot where a profile bends sharply.
    return Akima1DInterpolator(knots, through)(fine)


def _box_corners(box: forms.Box) -> Array:
    half, bevel = np.array(box.size) / 2, box.bevel
    signs = np.array(list(product((-1, 1), repeat=3)))
    if not bevel:
        return signs * half
    return np.vstack([signs * (half - bevel * (1 - np.eye(3)[axis])) for axis in range(3)])


def _lathe_rings(lathe: forms.Lathe, sides: int, steps: int) -> list[Array]:
    outer = np.array(lathe.profile)
    if lathe.smooth:
        outer = _curve(outer, steps)
    rings = [_ring(lathe, sides, r, z) for r, z in outer]
    if lathe.wall:
        rings += [_ring(lathe, sides, r, z, shift) for r, z, shift in _inner_side(outer, lathe)]
    return rings


def _ring(lathe: forms.Lathe, sides: int, radius: float, height: float, shift: float = 0) -> Array:
    # Half a step of turn puts a flat side, not an edge, underneath.
    angles = (np.arange(sides) + 0.5) * 2 * np.pi / sides
    wide, deep = (max(radius * factor + shift, 0.0) for factor in lathe.stretch)
    return np.column_stack([wide * np.cos(angles), deep * np.sin(angles), np.full(sides, height)])


def _inner_side(outer: Array, lathe: forms.Lathe) -> Array:
    floor_first = np.vstack([[0.0, outer[0, 1]], outer])
    mitre = _mitres(np.diff(floor_first, axis=0), [*range(1, len(outer)), -1])
    heights = outer[:, 1] + lathe.wall * mitre[:, 1]
    heights[-1] = outer[-1, 1]
    return np.column_stack([outer[:, 0], heights, lathe.wall * mitre[:, 0]])[::-1]


def _vessel_pieces(lathe: forms.Lathe) -> list[Array]:
    sides = lathe.sides or STAVES
    rings = _lathe_rings(lathe, sides, 1)
    count = len(rings) // 2
    outer, inner = rings[:count], rings[count:][::-1]
    pieces = [np.vstack([outer[0], inner[0]])]
    for side in range(sides):
        pair = [side, (side + 1) % sides]
        edges = [np.vstack([out[pair], into[pair]]) for out, into in zip(outer, inner, strict=True)]
        pieces += _segments(edges, tolerance=STAVE_TOLERANCE)
    return pieces


def _plate_rings(plate: forms.Extrusion, steps: int) -> list[Array]:
    corners = np.column_stack([plate.outline, np.array(plate.thickness) / 2])
    rim = _curve(corners, steps, closed=True) if plate.smooth else corners
    half, levels = rim[:, 2], [(rim, -rim[:, 2]), (rim, rim[:, 2])]
    if plate.bevel:
        ahead = np.roll(rim[:, :2], -1, axis=0) - rim[:, :2]
        face = rim[:, :2] + plate.bevel * _mitres(ahead, range(-1, len(rim) - 1))
        side = half - plate.bevel
        levels = [(face, -half), (rim, -side), (rim, side), (face, half)]
    return [np.column_stack([outline[:, :2], height]) for outline, height in levels]


def _mitres(ahead: Array, neighbours: Sequence[int]) -> Array:
    """Return the steps (n, 2) to a line 1 m to the left of sides `ahead` and their neighbours."""
    normals = np.column_stack([-ahead[:, 1], ahead[:, 0]])
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    both = normals + normals[list(neighbours)]
    return both / np.einsum("ij,ij->i", normals, both)[:, None]


def _sweep_rings(sweep: forms.Sweep, corners: int, steps: int) -> list[Array]:
    line = np.column_stack([sweep.path, sweep.sections])  # x, y, z, width, height
    if sweep.smooth:
        line = _curve(line, steps)
    ahead = np.gradient(line[:, :3], axis=0)
    ahead /= np.linalg.norm(ahead, axis=1, keepdims=True)
    rows = list(zip(line[:, :3], line[:, 3:], ahead, strict=True))
    if sweep.rounded:
        domes = np.linspace(0, np.pi / 2, steps + 1)[1:]
        start = [_dome(rows[0], -angle) for angle in domes[::-1]]
        rows = start + rows + [_dome(rows[-1], angle) for angle in domes]
    return [_section(sweep, corners, *row) for row in rows]


def _dome(row: tuple[Array, Array, Array], angle: float) -> tuple[Array, Array, Array]:
    centre, size, ahead = row
    return centre + np.sin(angle) * size.min() / 2 * ahead, size * np.cos(angle), ahead


def _section(sweep: forms.Sweep, corners: int, centre: Array, size: Array, ahead: Array) -> Array:
    side = np.array(sweep.side) - np.dot(sweep.side, ahead) * ahead
    side /= np.linalg.norm(side)
    angles = np.arange(corners) * 2 * np.pi / corners
    waves = np.cos(angles), np.sin(angles)
    across, up = (np.sign(wave) * np.abs(wave) ** (2 / sweep.power) for wave in waves)
    half = np.maximum(size / 2, 0.0)
    return centre + half[0] * across[:, None] * side + half[1] * up[:, None] * np.cross(ahead, side)
