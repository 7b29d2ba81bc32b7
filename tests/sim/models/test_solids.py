"""The geometry of solids: visual surfaces and convex collision pieces."""

from math import pi
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from trimesh import Trimesh

from hilt.ontology.objects import load_objects
from hilt.ontology.part_shapes import Box, Extrusion, Form, Lathe, MeshFile, PlacedSolid, Sweep
from hilt.sim.models import meshes
from hilt.sim.models.meshes import triangulate
from hilt.sim.models.solids import build_solid

OBJECTS = load_objects()
PARTS = [
    (kind.name, part.name)
    for kind in OBJECTS.values()
    if kind.graspable
    for part in kind.parts.values()
]
lengths = st.floats(0.004, 0.2)


def solid(form: Form, at: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> PlacedSolid:
    """A form at a place, neither turned nor coloured."""
    return PlacedSolid(form, at, (0.0, 0.0, 0.0), None, visible=True, collides=True)


def cylinder(radius: float, height: float) -> Lathe:
    """A round bar that stands on the origin."""
    return Lathe(((radius, 0.0), (radius, height)), 0.0, 0, (1.0, 1.0), smooth=False)


def surface(form: Form) -> Trimesh:
    """Return the visual surface of a form."""
    mesh = build_solid(solid(form)).visual
    assert mesh is not None
    return mesh


def collision_volume(pieces: tuple[np.ndarray, ...]) -> float:
    """Return the volume of all pieces together."""
    return sum(ConvexHull(piece).volume for piece in pieces)


@given(lengths, lengths, lengths)
def test_box_has_its_volume(x: float, y: float, z: float):
    """A box of x, y, z holds x y z."""
    mesh = surface(Box((x, y, z), 0.0))

    assert mesh.volume == pytest.approx(x * y * z)


@given(lengths, lengths)
def test_cylinder_has_nearly_its_volume(radius: float, height: float):
    """A round bar loses less than half a percent to its flat sides."""
    mesh = surface(cylinder(radius, height))

    assert mesh.volume == pytest.approx(pi * radius**2 * height, rel=0.005)


def test_bevel_takes_only_the_edges():
    """A bevelled box reaches as far as a plain one and holds less."""
    mesh = surface(Box((0.1, 0.2, 0.3), 0.01))

    assert np.ptp(mesh.vertices, axis=0) == pytest.approx((0.1, 0.2, 0.3))
    assert 0.9 * 0.006 < mesh.volume < 0.006


def test_vessel_is_open():
    """The middle of a vessel belongs to none of its pieces."""
    mug = Lathe(((0.04, 0.0), (0.04, 0.1)), 0.004, 0, (1.0, 1.0), smooth=False)

    pieces = build_solid(solid(mug)).collision

    inside = [(ConvexHull(p).equations @ (0, 0, 0.05, 1) <= 0).all() for p in pieces]
    assert not any(inside)


def test_wall_has_its_thickness():
    """The volume of a vessel is that of its outside less that of its inside."""
    mug = Lathe(((0.04, 0.0), (0.04, 0.1)), 0.004, 0, (1.0, 1.0), smooth=False)

    volume = surface(mug).volume

    expected = pi * (0.04**2 * 0.1 - 0.036**2 * 0.096)
    assert volume == pytest.approx(expected, rel=0.01)


def test_blade_is_thin_at_its_edge():
    """The thickness of a plate may differ from corner to corner."""
    blade = Extrusion(
        ((0.0, 0.0), (0.1, 0.0), (0.1, 0.03), (0.0, 0.03)), (0.001, 0.001, 0.003, 0.003), 0.0, False
    )

    vertices = surface(blade).vertices

    assert np.ptp(vertices[vertices[:, 1] == 0.0][:, 2]) == pytest.approx(0.001)
    assert np.ptp(vertices[vertices[:, 1] == 0.03][:, 2]) == pytest.approx(0.003)


def test_concave_plate_keeps_its_notch():
    """An L becomes pieces that leave its inner corner free."""
    corner = ((0.0, 0.0), (0.1, 0.0), (0.1, 0.02), (0.02, 0.02), (0.02, 0.1), (0.0, 0.1))
    plate = Extrusion(corner, (0.01,) * 6, 0.0, smooth=False)

    pieces = build_solid(solid(plate)).collision

    assert collision_volume(pieces) == pytest.approx(0.0036 * 0.01)
    assert len(pieces) == 2


def test_sweep_follows_its_path():
    """A rod bent by a right angle reaches both ends of its path."""
    rod = Sweep(
        ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.1, 0.0, 0.1)),
        ((0.01, 0.01),) * 3,
        (0.0, 1.0, 0.0),
        2.0,
        rounded=False,
        smooth=False,
    )

    vertices = surface(rod).vertices

    assert vertices[:, 0].min() == pytest.approx(0.0, abs=1e-9)
    assert vertices[:, 2].max() == pytest.approx(0.1)


def test_mesh_file_becomes_one_piece_for_each_body(tmp_path: Path):
    """Two tetrahedra in one file become two pieces, in metres."""
    path = tmp_path / "two.obj"
    corners = [(0, 0, 0), (10, 0, 0), (0, 10, 0), (0, 0, 10)]
    lines = [f"v {x + 50 * i} {y} {z}" for i in range(2) for x, y, z in corners]
    faces = ((1, 3, 2), (1, 2, 4), (2, 3, 4), (1, 4, 3))
    lines += [f"f {a + 4 * i} {b + 4 * i} {c + 4 * i}" for i in range(2) for a, b, c in faces]
    path.write_text("\n".join(lines), encoding="ascii")

    shape = build_solid(solid(MeshFile(path, 0.001)))

    assert sorted(round(float(p[:, 0].max()), 3) for p in shape.collision) == [0.01, 0.06]


@pytest.mark.parametrize(("name", "part"), PARTS)
def test_collision_pieces_reach_as_far_as_the_visual_surface(name: str, part: str):
    """The surface and the collision pieces of every part reach equally far, to within 1.5 mm."""
    shapes = [build_solid(solid) for solid in OBJECTS[name].part(part).shape]

    seen = np.vstack([shape.visual.vertices for shape in shapes if shape.visual is not None])
    felt = np.vstack([piece for shape in shapes for piece in shape.collision])
    assert np.abs(seen.min(axis=0) - felt.min(axis=0)).max() < 0.0015
    assert np.abs(seen.max(axis=0) - felt.max(axis=0)).max() < 0.0015


@pytest.mark.parametrize(("name", "part"), PARTS)
def test_surfaces_are_closed_and_outwards(name: str, part: str):
    """Every edge of a surface is walked once in each direction, and the inside is inside."""
    for shape in (build_solid(solid) for solid in OBJECTS[name].part(part).shape):
        if shape.visual is not None:
            faces = shape.visual.faces
            edges = np.vstack([faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]])

            assert {tuple(e) for e in edges} == {tuple(e[::-1]) for e in edges}
            assert shape.visual.volume > 0


@given(st.lists(lengths, min_size=3, max_size=3), st.floats(0.0001, 0.001))
def test_shrinking_moves_every_face(sizes: list[float], distance: float):
    """A box shrunk by d is 2 d smaller in each direction."""
    corners = np.array(np.meshgrid(*([0.0, size] for size in sizes))).reshape(3, -1).T

    shrunk = meshes.shrink(corners, distance)

    assert np.ptp(shrunk, axis=0) == pytest.approx(np.array(sizes) - 2 * distance, abs=1e-6)


def test_shrinking_leaves_something_of_a_foil():
    """A piece thinner than twice the distance keeps a tenth of its thickness."""
    foil = np.array(np.meshgrid([0, 0.1], [0, 0.1], [0, 0.001])).reshape(3, -1).T

    shrunk = meshes.shrink(foil, 0.001)

    assert np.ptp(shrunk[:, 2]) == pytest.approx(0.0001, rel=0.01)


def test_inertia_of_a_box_is_the_textbooks():
    """A box of mass m has m (y^2 + z^2) / 12 about its x axis, wherever it is."""
    box = np.array(np.meshgrid([1.0, 1.2], [2.0, 2.4], [3.0, 3.6])).reshape(3, -1).T

    centre, inertia = meshes.mass_properties([box], 6.0)

    assert centre == pytest.approx((1.1, 2.2, 3.3))
    assert np.diag(inertia) == pytest.approx(
        [0.5 * (0.16 + 0.36), 0.5 * (0.04 + 0.36), 0.5 * (0.04 + 0.16)]
    )


def test_triangles_fill_a_star():
    """A star cut into triangles keeps its area."""
    angles = np.arange(10) * 2 * pi / 10
    radii = np.where(np.arange(10) % 2, 0.4, 1.0)
    star = np.column_stack([radii * np.cos(angles), radii * np.sin(angles)])

    a, b, c = (star[triangulate(star)[:, i]] for i in range(3))

    areas = ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]) / 2
    assert areas.sum() == pytest.approx(10 * 0.5 * 1.0 * 0.4 * np.sin(2 * pi / 10))
    assert (areas > 0).all()


def test_box_keeps_its_edges_when_shaded():
    """The normals of a box are those of its faces: its edges are creases."""
    mesh = surface(Box((0.1, 0.1, 0.1), 0.0))

    lines = meshes.shaded_obj(mesh).splitlines()

    normals = np.array([line.split()[1:] for line in lines if line.startswith("vn ")], dtype=float)
    assert np.sort(np.abs(normals), axis=1)[:, 2] == pytest.approx(1.0)
