"""Objects of one's own with a mesh file for each part."""

from pathlib import Path

import pytest

from hilt.ontology.errors import DataError
from hilt.ontology.objects import ObjectType, load_household
from hilt.sim.body import Body
from hilt.sim.models.object_models import object_model
from hilt.sim.scene.scene import parse_scene

pytestmark = pytest.mark.sim

BRUSH = """
objects:
  brush:
    is_a: tool
    parts:
      handle: {role: grip, material: wood, colour: "#8a5a33", mass: 0.06, shape: [{mesh: {file: handle.obj, scale: 0.001}}]}
      head: {role: surface, material: plastic, colour: "#f0f0f0", mass: 0.04, shape: [{mesh: {file: head.obj, scale: 0.001}}]}
    rests:
      flat: {turn_deg: [0, 0, 0]}
"""  # noqa: E501 - as a person would write it
SIDES = "f 1 4 3 2\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n"


def block(x: tuple[int, int], y: tuple[int, int], z: tuple[int, int]) -> str:
    """A box as an OBJ file [mm]."""
    corners = [(x[0], y[0]), (x[1], y[0]), (x[1], y[1]), (x[0], y[1])]
    return "".join(f"v {a} {b} {height}\n" for height in z for a, b in corners) + SIDES


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A folder with a brush: a handle of 120 mm and a head of 60 mm."""
    (tmp_path / "mine.yaml").write_text(BRUSH, encoding="utf-8")
    (tmp_path / "handle.obj").write_text(block((-120, 0), (-9, 9), (0, 20)))
    (tmp_path / "head.obj").write_text(block((0, 60), (-25, 25), (0, 30)))
    return tmp_path


def objects_of(folder: Path) -> dict[str, ObjectType]:
    """Hilt's objects, and the brush."""
    return dict(load_household(folder / "mine.yaml", added_to=load_household()).objects)


@pytest.mark.parametrize("part", ["handle", "head"])
def test_each_part_is_seen_and_held_by_itself(part: str, folder: Path):
    """The fingers close on the part that is asked for, and lift the brush by it."""
    objects = objects_of(folder)
    with Body(parse_scene("objects:brush", seed=2, objects=objects), objects, seed=2) as body:
        (brush,) = body.search(["object:brush"])
        grasped, lifted = body.grasp(brush, part), body.lift()

    assert set(brush.parts) == {"handle", "head"}
    assert (grasped.touched, lifted.ok) == ((part,), True)


@pytest.mark.parametrize(
    ("of_head", "of_handle"),
    [
        ("cut: [[1, 0, 0, -0.05]]", "cut: [[-1, 0, 0, 0.05]]"),
        (
            "points: [[0, 0, 0], [0.05, 0, 0]], other_points: [[-0.1, 0, 0]]",
            "points: [[-0.1, 0, 0]], other_points: [[0, 0, 0], [0.05, 0, 0]]",
        ),
    ],
    ids=["planes", "points"],
)
def test_one_mesh_is_cut_into_parts(folder: Path, of_head: str, of_handle: str):
    """Both parts come from one file; the one that is asked for is held."""
    handle, head = ("handle.obj, scale: 0.001", "head.obj, scale: 0.001")
    text = BRUSH.replace(head, f"{handle}, {of_head}", 1)
    text = text.replace(f"{handle}}}", f"{handle}, {of_handle}}}", 1)
    (folder / "mine.yaml").write_text(text, encoding="utf-8")
    objects = objects_of(folder)

    with Body(parse_scene("objects:brush", seed=2, objects=objects), objects, seed=2) as body:
        (brush,) = body.search(["object:brush"])
        grasped = body.grasp(brush, "head")

    assert grasped.touched == ("head",)
    assert object_model(objects["brush"]).corners["head"][:, 0].min() == pytest.approx(-0.05)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("not a mesh", "has no faces|no mesh that can be read"),
        ("v 0 0 0\nv 1 0 0\n", "has no faces|no mesh that can be read"),
        (block((0, 60000), (0, 1), (0, 1)), "60 m long with the scale 0.001"),
    ],
    ids=["nonsense", "no faces", "too large"],
)
def test_mesh_that_is_no_use_is_told_with_its_file(text: str, problem: str, folder: Path):
    """One sentence with the file, and what to do about units."""
    (folder / "head.obj").write_text(text)

    with pytest.raises(DataError, match=f"head.obj.*({problem})"):
        object_model(objects_of(folder)["brush"])
