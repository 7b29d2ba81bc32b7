"""Spheres that stand for the links of a robot: they contain the links, and little more."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh

from hilt.ontology.errors import DataError
from hilt.sim import poses
from hilt.sim.models.urdf import child_attribute, origin_pose, read_urdf
from hilt.sim.physics.engine import PhysicsEngine
from hilt.sim.robot.link_spheres import cover, fit_spheres
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.robot import Robot

MOST_BULGE = 0.015  # [m]
SHAPES = {
    "box": "<box size='0.1 0.06 0.2'/>",
    "cylinder": "<cylinder radius='0.05' length='0.2'/>",
    "sphere": "<sphere radius='0.06'/>",
    "capsule": "<capsule radius='0.04' length='0.1'/>",
}
OWN = """
<robot name="own">
  <link name="base"><collision><geometry><box size="0.2 0.2 0.02"/></geometry></collision></link>
  <joint name="turn" type="revolute">
    <parent link="base"/><child link="upper"/><origin xyz="0 0 0.1"/><axis xyz="0 0 1"/>
    <limit lower="-2" upper="2" effort="50" velocity="1"/>
  </joint>
  <link name="upper">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><origin xyz="0 0 0.1"/><geometry>SHAPE</geometry></collision>
  </link>
  <joint name="lift" type="fixed">
    <parent link="upper"/><child link="tool"/><origin xyz="0 0 0.3" rpy="0 0 1"/>
  </joint>
  <link name="tool">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="0.03"/></geometry></collision>
  </link>
  <joint name="on the tool" type="fixed">
    <parent link="tool"/><child link="camera"/><origin xyz="0.1 0 0"/>
  </joint>
  <link name="camera">
    <inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><box size="0.04 0.04 0.04"/></geometry></collision>
  </link>
</robot>
"""


def own_file(folder: Path, shape: str) -> Path:
    """A robot of one's own, whose upper link has this shape."""
    file = folder / "own.urdf"
    file.write_text(OWN.replace("SHAPE", shape), encoding="utf-8")
    return file


def hulls(name: str) -> dict[str, trimesh.Trimesh]:
    """The hull of each link of the arm that has a mesh, in the link's frame."""
    robot, found = find_robot(name), {}
    for link in read_urdf(robot.file).findall("link"):
        for shape in link.findall("collision") if link.get("name") in robot.arm.links else ():
            mesh = trimesh.load_mesh(
                child_attribute(shape.findall("geometry")[0], "mesh", "filename")
            )
            points = poses.transform(origin_pose(shape), np.asarray(mesh.vertices))
            found[link.get("name")] = trimesh.convex.convex_hull(points)
    return found


def outside(points: np.ndarray, spheres: np.ndarray) -> float:
    """How far the farthest of the points is from the spheres (n, 4) [m]; negative inside."""
    apart = np.linalg.norm(points[:, None] - spheres[:, :3], axis=2) - spheres[:, 3]
    return float(apart.min(axis=1).max())


def bulges(hull: trimesh.Trimesh, spheres: np.ndarray) -> np.ndarray:
    """How far each sphere stands out of a convex hull [m]."""
    offset = np.einsum("ij,ij->i", hull.face_normals, hull.triangles[:, 0])
    return spheres[:, 3] - (offset - spheres[:, :3] @ hull.face_normals.T).min(axis=1)


@pytest.mark.parametrize("name", ["panda", "kuka"])
def test_spheres_contain_each_link_and_little_more(name: str):
    """Points all over the hull of a link are inside, and no sphere is far out of it."""
    spheres = find_robot(name).spheres

    for link, hull in hulls(name).items():
        points = trimesh.sample.sample_surface(hull, 4000, seed=1)[0]

        assert outside(np.vstack([points, hull.vertices]), spheres[link]) <= 0
        assert bulges(hull, spheres[link]).max() <= MOST_BULGE


@pytest.mark.parametrize("name", ["panda", "kuka"])
def test_spheres_are_few(name: str):
    """Each costs time in each check of a path; a link has edges all round, and 25 in the mean."""
    assert 0 < max(map(len, find_robot(name).spheres.values())) <= 50


@pytest.mark.parametrize("shape", SHAPES)
def test_own_robot_needs_no_more_than_its_file(shape: str, tmp_path: Path):
    """The spheres of an arm of simple shapes contain what the shapes measure."""
    rng = np.random.default_rng(3)
    ways = rng.normal(size=(2000, 3))
    ways /= np.linalg.norm(ways, axis=1, keepdims=True)
    mesh = {
        "box": trimesh.creation.box((0.1, 0.06, 0.2)),
        "cylinder": trimesh.creation.cylinder(0.05, 0.2, sections=200),
    }.get(shape)
    surface = {
        "sphere": 0.06 * ways,
        "capsule": 0.04 * ways + np.sign(ways[:, 2:]) * (0.0, 0.0, 0.05),
    }.get(shape)
    points = surface if mesh is None else trimesh.sample.sample_surface(mesh, 2000, seed=1)[0]

    spheres = fit_spheres(own_file(tmp_path, SHAPES[shape]), ["upper", "tool"], apart=())

    assert outside(points + np.array((0.0, 0.0, 0.1)), spheres["upper"]) <= 0


def test_what_hangs_on_a_link_belongs_to_it(tmp_path: Path):
    """A camera beside the tool is covered with the tool, unless it is to be apart."""
    file = own_file(tmp_path, SHAPES["box"])
    corner = np.array([[0.12, 0.02, 0.02]])

    with_it = fit_spheres(file, ["upper", "tool"], apart=())
    without = fit_spheres(file, ["upper", "tool"], apart=("camera",))

    assert outside(corner, with_it["tool"]) < 0 < outside(corner, without["tool"])


def test_links_come_out_the_same_every_time():
    """Nothing is left to chance."""
    corners = np.random.default_rng(5).uniform(-0.1, 0.1, (40, 3))

    assert np.array_equal(cover(corners), cover(corners))


def test_plate_thinner_than_the_spheres_is_covered():
    """A tilted plate of 2 mm has no inside that a grid would find."""
    plate = trimesh.creation.box((0.2, 0.1, 0.002))
    tilted = poses.pose(poses.rotation_from_rpy(0.3, 0.5, 0.7), (0.0, 0.0, 0.1))

    spheres = cover(poses.transform(tilted, np.asarray(plate.vertices)))

    points = trimesh.sample.sample_surface(plate, 2000, seed=1)[0]
    assert outside(poses.transform(tilted, points), spheres) <= 0


def test_large_link_is_covered_by_few_large_spheres():
    """A column of a metre bulges by more, so that no link takes long."""
    column = trimesh.creation.box((0.4, 0.4, 1.0))

    spheres = cover(np.asarray(column.vertices))

    assert len(spheres) < 250
    assert outside(trimesh.sample.sample_surface(column, 2000, seed=1)[0], spheres) <= 1e-3


@pytest.mark.parametrize("shape", ["<mesh filename='no.stl'/>", "<box size='1 2'/>", "<cone/>", ""])
def test_shape_that_cannot_be_read_is_an_error_with_its_link(shape: str, tmp_path: Path):
    """The error names the link."""
    with pytest.raises(DataError, match='collision shape of "upper"'):
        fit_spheres(own_file(tmp_path, shape), ["upper"], apart=())


@pytest.mark.sim
def test_arm_ends_where_its_last_link_does(tmp_path: Path):
    """A robot of one's own without gripper and without list has its tip at the end of the tool."""
    own_file(tmp_path, SHAPES["cylinder"])
    file = tmp_path / "own.yaml"
    file.write_text("own: {label: Own, urdf: own.urdf, hand: tool, home: [0]}\n", encoding="utf-8")

    with PhysicsEngine() as engine:
        robot = Robot(engine, find_robot(str(file)))

        assert 0.03 <= robot.tip <= 0.05
        assert len(robot.body_spheres(0.0).radius) == len(robot.spheres.radius)
