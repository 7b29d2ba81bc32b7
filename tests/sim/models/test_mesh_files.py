"""Mesh files as scanners and modelling programs write them."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh
from trimesh import Trimesh
from trimesh.convex import convex_hull

from hilt.ontology.errors import DataError
from hilt.ontology.part_shapes import MeshFile
from hilt.sim.models.meshes import convex_pieces, read_mesh

BOX = trimesh.creation.box((0.10, 0.06, 0.04))
WALL = 0.004  # [m]
CUP = trimesh.creation.revolve(
    [[0, 0], [0.04, 0], [0.04, 0.1], [0.04 - WALL, 0.1], [0.04 - WALL, WALL], [0, WALL]],
    sections=24,
)
Writer = Callable[[Trimesh], MeshFile]


@pytest.fixture
def written(tmp_path: Path) -> Writer:
    """A function that writes a mesh as an OBJ file."""

    def write(mesh: Trimesh) -> MeshFile:
        path = tmp_path / "thing.obj"
        path.write_text(mesh.export(file_type="obj"), encoding="ascii")
        return MeshFile(path, 1.0)

    return write


@pytest.fixture
def textured(tmp_path: Path) -> Callable[[Trimesh], MeshFile]:
    """A function that writes a mesh whose faces share no vertex and have places in a texture."""

    def write(mesh: Trimesh) -> MeshFile:
        lines = [f"v {x} {y} {z}\nvt {x} {y}" for x, y, z in mesh.triangles.reshape(-1, 3)]
        corners = np.arange(1, len(lines) + 1).reshape(-1, 3)
        lines += [f"f {a}/{a} {b}/{b} {c}/{c}" for a, b, c in corners]
        path = tmp_path / "thing.obj"
        path.write_text("\n".join(lines), encoding="ascii")
        return MeshFile(path, 1.0)

    return write


def volume(pieces: list[np.ndarray]) -> float:
    """The volume of convex pieces together [m^3]."""
    return sum(convex_hull(piece).volume for piece in pieces)


def test_seams_of_a_texture_do_not_split_a_mesh(textured: Writer):
    """A box whose triangles have their own vertices has eight corners, and is one piece."""
    form = textured(BOX)

    (piece,) = convex_pieces(form)

    assert len(read_mesh(form).vertices) == len(piece) == 8
    assert volume([piece]) == pytest.approx(BOX.volume)


def test_hollow_mesh_is_felt_hollow(textured: Writer):
    """The pieces of a cup leave its inside free, and make up its wall and its floor."""
    pieces = convex_pieces(textured(CUP))

    assert len(pieces) > 8
    assert volume(pieces) == pytest.approx(CUP.volume, rel=0.25)
    middle = np.array([[0.0, 0.0, 0.05]])
    assert not any(convex_hull(piece).contains(middle)[0] for piece in pieces)


def test_faces_that_are_there_twice_count_once(textured: Writer):
    """A box with each face twice is a box."""
    twice = Trimesh(BOX.vertices, np.vstack([BOX.faces, BOX.faces]), process=False)

    form = textured(twice)

    assert len(read_mesh(form).faces) == 12
    assert volume(convex_pieces(form)) == pytest.approx(BOX.volume)


def test_opening_is_closed_for_the_fingers_only(written: Writer):
    """An open box is felt as a whole one, and seen open."""
    lidless = Trimesh(BOX.vertices, BOX.faces[BOX.face_normals[:, 2] < 0.9])

    form = written(lidless)

    assert len(read_mesh(form).faces) == 10
    assert volume(convex_pieces(form)) == pytest.approx(BOX.volume)


def test_face_that_closes_an_opening_is_no_piece_of_its_own(written: Writer):
    """An opening at a corner is closed along an edge of the box, which has three faces then."""
    broken = Trimesh(BOX.vertices, np.delete(BOX.faces, [1, 2, 3], axis=0))

    pieces = convex_pieces(written(broken))

    assert volume(pieces) == pytest.approx(BOX.volume, rel=0.15)


@pytest.mark.parametrize("height", [0.0, 0.00005])
def test_flat_piece_is_refused_with_its_place(height: float, written: Writer):
    """The message names the file, which of its pieces is flat, and where that is."""
    corners = BOX.vertices * (0.2, 0.2, height / 0.04) + (0.2, 0.0, 0.01)
    sheet = Trimesh(corners, BOX.faces, process=False)

    form = written(trimesh.util.concatenate([BOX, sheet]))

    with pytest.raises(DataError, match=r"thing.obj: piece 2 of 2, round \(0.2, .* is flat"):
        convex_pieces(form)


def test_mesh_of_faces_without_area_is_refused(tmp_path: Path):
    """Triangles whose corners are one point are no faces."""
    (tmp_path / "point.obj").write_text("v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n")

    with pytest.raises(DataError, match=r"point.obj.*has no faces"):
        read_mesh(MeshFile(tmp_path / "point.obj", 1.0))


def test_mesh_is_cut_by_planes(written: Writer):
    """Each plane keeps one side of it, closed: here a quarter and the half beside it."""
    whole = written(BOX)

    half = read_mesh(MeshFile(whole.path, 1.0, (((2.0, 0.0, 0.0, 0.0),),)))
    quarter = read_mesh(MeshFile(whole.path, 1.0, (((-1, 0, 0, -0.0), (0, 1, 0, 0.0)),)))

    assert half.volume == pytest.approx(BOX.volume / 2) and half.is_watertight
    assert quarter.volume == pytest.approx(BOX.volume / 4) and quarter.is_watertight
    assert half.bounds[0][0] == pytest.approx(0.0) == quarter.bounds[1][0]


def test_plane_that_misses_the_mesh_leaves_nothing(written: Writer):
    """What has been cut away wholly is no part."""
    with pytest.raises(DataError, match="has no faces"):
        read_mesh(MeshFile(written(BOX).path, 1.0, (((1.0, 0.0, 0.0, 0.3),),)))
