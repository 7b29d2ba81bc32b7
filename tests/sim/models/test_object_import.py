"""Objects from URDF and MJCF files."""

from pathlib import Path

import pytest
import trimesh

from hilt.ontology.errors import DataError, UnknownNameError
from hilt.ontology.objects import Household, load_household
from hilt.sim.body import Body
from hilt.sim.models.object_import import import_object
from hilt.sim.scene.scene import parse_scene

pytestmark = pytest.mark.sim

URDF = """<robot name="brush">
  <link name="link_1">
    <inertial><mass value="0.06"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><geometry><sphere radius="0.2"/></geometry><material name="m"><color rgba="0.5 0.3 0.2 1"/></material></visual>
    <collision><origin xyz="-0.06 0 0" rpy="0 1.5708 0"/><geometry><cylinder radius="0.01" length="0.12"/></geometry></collision>
  </link>
  <link name="link_2">
    <collision name="c"><geometry><mesh filename="package://parts/head.stl" scale="0.001 0.001 0.001"/></geometry></collision>
  </link>
  <joint name="neck" type="revolute">
    <parent link="link_1"/><child link="link_2"/><origin xyz="0.03 0 0"/>
    <axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="1" velocity="1"/>
  </joint>
</robot>
"""  # noqa: E501 - as programs write it
MJCF = """<mujoco>
  <default><geom density="500"/></default>
  <worldbody>
    <geom type="plane" size="1 1 1"/>
    <body name="mallet" pos="0 0 1">
      <freejoint/>
      <geom name="Grip_1" type="capsule" fromto="-0.16 0 0 0 0 0" size="0.01" mass="0.1" rgba="0.6 0.4 0.2 1"/>
      <geom name="head" type="box" size="0.02 0.03 0.02" pos="0.02 0 0" friction="0.7 0.01 0.01"/>
      <geom type="ellipsoid" size="0.1 0.1 0.1" contype="0" conaffinity="0" mass="0"/>
    </body>
  </worldbody>
</mujoco>
"""  # noqa: E501
NAMED = {"link_1": "handle", "link_2": "head"}


def imported(folder: Path, text: str, links: dict[str, str], roles: dict[str, str]) -> Household:
    """Hilt's objects and the one of a file, written into a folder with the mesh of a head."""
    (folder / "parts").mkdir()
    trimesh.creation.box((60, 50, 20)).export(folder / "parts" / "head.stl")
    file = folder / ("thing.urdf" if "robot" in text else "thing.xml")
    file.write_text(text, encoding="utf-8")
    out = folder / "mine.yaml"
    import_object(file, out, links, roles, name="thing", is_a="tool")
    return load_household(out, added_to=load_household())


def test_links_of_urdf_are_parts(tmp_path: Path):
    """A mass is that of the link, or by the volume of its mesh; colours are those of the file."""
    thing = imported(tmp_path, URDF, NAMED, {"handle": "grip"}).objects["thing"]

    handle, head = thing.parts.values()
    assert (handle.name, handle.role, head.name, head.role) == ("handle", "grip", "head", "base")
    assert (handle.mass, head.mass) == (0.06, pytest.approx(0.06))  # 60 cm^3 of 1000 kg/m^3
    assert thing.mass == pytest.approx(0.12)
    assert handle.colour == pytest.approx((0.5, 0.3, 0.2), abs=0.005)
    assert handle.material.friction == 0.6


def test_named_geoms_of_mjcf_are_parts(tmp_path: Path):
    """Masses, friction and defaults are read; planes and what is only seen are no parts."""
    thing = imported(tmp_path, MJCF, {}, {}).objects["thing"]

    grip, head = thing.parts.values()
    assert (grip.name, head.name) == ("grip 1", "head")
    assert (grip.mass, head.mass) == pytest.approx((0.1, 0.048))  # 96 cm^3 of 500 kg/m^3
    assert (grip.material.friction, head.material.friction) == (0.6, 0.7)


def test_what_is_not_named_is_the_body(tmp_path: Path):
    """With one link named, the other one is the part "body"."""
    thing = imported(tmp_path, URDF, {"link_2": "head"}, {}).objects["thing"]

    assert list(thing.parts) == ["body", "head"]


@pytest.mark.parametrize(
    ("text", "links", "part"),
    [(URDF, NAMED, "handle"), (URDF, NAMED, "head"), (MJCF, {}, "grip 1")],
)
def test_imported_object_is_held_by_its_part(
    text: str, links: dict[str, str], part: str, tmp_path: Path
):
    """The fingers close on the part that is asked for, and lift the object by it."""
    objects = dict(imported(tmp_path, text, links, {}).objects)
    with Body(parse_scene("objects:thing", seed=2, objects=objects), objects, seed=2) as body:
        (thing,) = body.search(["object:thing"])
        grasped, lifted = body.grasp(thing, part), body.lift()

    assert (grasped.touched, lifted.ok) == ((part,), True)


@pytest.mark.parametrize(
    ("right", "wrong", "problem"),
    [
        ('radius="0.01"', 'radius="wide"', r"thing.urdf:5: .*'radius' Element 'cylinder'"),
        ("head.stl", "tail.stl", r"thing.urdf:8: .*tail.stl"),
        ('child link="link_2"', 'child link="link_3"', r"thing.urdf:10: .*'joint'"),
        ("</link>", "</lnk>", r"thing.urdf:2: .*XML"),
    ],
)
def test_mistake_in_file_has_a_line(right: str, wrong: str, problem: str, tmp_path: Path):
    """The message has the file, the line and the element."""
    with pytest.raises(DataError, match=problem):
        imported(tmp_path, URDF.replace(right, wrong, 1), {}, {})


@pytest.mark.parametrize("inside", ["", "<body/>", '<geom type="plane" size="1 1 1"/>'])
def test_file_without_shapes_is_refused(inside: str, tmp_path: Path):
    """An object has at least one part."""
    with pytest.raises(DataError, match="at least one part"):
        imported(tmp_path, f"<mujoco><worldbody>{inside}</worldbody></mujoco>", {}, {})


@pytest.mark.parametrize(
    ("links", "roles", "problem"),
    [
        ({"link_3": "head"}, {}, r'"link_3".*link_1, link_2'),
        ({}, {"tip": "grip"}, r'"tip".*link 1'),
    ],
)
def test_name_that_is_not_in_the_file_is_told(
    links: dict[str, str], roles: dict[str, str], problem: str, tmp_path: Path
):
    """The message lists the names that are there."""
    with pytest.raises(UnknownNameError, match=problem):
        imported(tmp_path, URDF, links, roles)
