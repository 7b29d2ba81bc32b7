"""Robots as data."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest

from hilt.ontology.errors import DataError, UnknownNameError
from hilt.ontology.objects import load_objects
from hilt.sim.body import Body
from hilt.sim.robot.models import ROBOTS_FILE, find_robot, load_robots
from hilt.sim.scene.scene import parse_scene

OBJECTS = load_objects()


@pytest.mark.parametrize("name", load_robots())
def test_each_robot_waits_within_its_limits(name):
    """The posture in which a robot waits is one it can take."""
    robot = find_robot(name)

    assert np.all((robot.starts >= robot.arm.low) & (robot.starts <= robot.arm.high))


def test_hand_of_the_panda_waits_over_the_table_and_looks_down():
    """At home the hand is half a metre up and points down."""
    panda = find_robot("panda")

    base_from_hand = panda.arm.forward(panda.home[None])[0]

    assert base_from_hand[2, 3] > 0.4
    assert base_from_hand[2, 2] < -0.9


def test_limits_of_the_data_sheet_replace_those_of_the_file():
    """Speeds of the KUKA and accelerations of the Panda are those of robots.yaml."""
    assert find_robot("kuka").arm.speed == pytest.approx([1.48, 1.48, 1.75, 1.31, 2.27, 2.36, 2.36])
    assert find_robot("panda").arm.acceleration[1] == pytest.approx(7.5)
    assert np.isinf(find_robot("kuka").arm.acceleration).all()


def test_unknown_robot_names_the_known_ones():
    """The error lists the known robots."""
    with pytest.raises(UnknownNameError, match=r'no robot "pando"\. Did you mean "panda"'):
        find_robot("pando")


@pytest.mark.parametrize("cut", [", 0.785]", ", 20.0]", ", 2.36]"])
def test_wrong_number_of_joints_is_an_error_with_its_line(cut: str, tmp_path: Path):
    """A posture, or the limits of speeds or accelerations, with a joint too few."""
    text = ROBOTS_FILE.read_text(encoding="utf-8").replace(cut, "]")
    file = tmp_path / "robots.yaml"
    file.write_text(text, encoding="utf-8")

    with pytest.raises(DataError, match=r"robots\.yaml:\d+:\d+: expected 7 joints, found 6\."):
        load_robots(file)


def test_robot_without_gripper_has_none(tmp_path: Path):
    """The gripper may be left out: such a robot can point, not grasp."""
    lines = ROBOTS_FILE.read_text(encoding="utf-8").splitlines()
    first = lines.index("  gripper:")
    last = next(i for i in range(first + 1, len(lines)) if not lines[i].startswith("    "))
    file = tmp_path / "robots.yaml"
    file.write_text("\n".join(lines[:first] + lines[last:]), encoding="utf-8")

    assert load_robots(file)["panda"].gripper is None
    assert find_robot(f"{file}:panda").gripper is None


@pytest.mark.sim
def test_robot_without_a_hand_points_with_its_arm(tmp_path: Path):
    """It comes near the object it points at, and touches nothing."""
    arm = ROBOTS_FILE.read_text(encoding="utf-8").partition("\nkuka:\n")[2]
    arm = re.sub(r"  (attached|gripper):\n(    .*\n)+", "", arm)
    file = tmp_path / "arm.yaml"
    file.write_text("arm:\n" + arm.replace("panda_hand", "lbr_iiwa_link_7"), encoding="utf-8")
    scene = parse_scene("objects:glass", seed=3, objects=OBJECTS)

    with Body(scene, OBJECTS, seed=3, robot=str(file)) as body:
        before = body.world.pose("glass")
        report = body.point_at(body.search(["object:glass"])[0])

        assert (report.ok, body.abilities) == (True, {"findObject", "pointAt"})
        assert np.allclose(body.world.pose("glass"), before, atol=1e-4)
        assert np.linalg.norm(body.robot.world_from_hand[:3, 3] - body.world.top("glass")) < 0.3


def test_robot_of_a_file_with_one_needs_no_name(tmp_path: Path):
    """With several robots the name is required; the error lists them."""
    text = ROBOTS_FILE.read_text(encoding="utf-8")
    both, one = tmp_path / "both.yaml", tmp_path / "one.yaml"
    both.write_text(text, encoding="utf-8")
    one.write_text(text[: text.index("\nkuka:")], encoding="utf-8")

    assert find_robot(str(one)).name == "panda"
    assert find_robot(f"{both}:kuka").name == "kuka"
    with pytest.raises(UnknownNameError, match="Known: kuka, panda"):
        find_robot(str(both))
