"""Tests for robot files made of an arm and a hand."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.ontology.errors import DataError
from hilt.ontology.objects import load_objects
from hilt.sim.body import Body
from hilt.sim.models.urdf import HandFile, robot_file
from hilt.sim.robot.kinematics import read_chain
from hilt.sim.robot.models import find_robot
from hilt.sim.scene.scene import parse_scene

OBJECTS = load_objects()
ARM = """<robot name='arm'><link name='base'/><link name='wrist'/>
<joint name='turn' type='revolute'><parent link='base'/><child link='wrist'/>
<axis xyz='0 0 1'/><limit lower='-1' upper='1' velocity='9' effort='1'/></joint></robot>"""
HAND = """<robot name='hand'><link name='stand'/><link name='palm'/><link name='finger'/>
<joint name='a' type='fixed'><parent link='stand'/><child link='palm'/></joint>
<joint name='b' type='fixed'><parent link='palm'/><child link='finger'/></joint></robot>"""


@pytest.fixture
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[Path, Path]:
    """An arm and a hand, and a cache of their own."""
    monkeypatch.setenv("HILT_CACHE", str(tmp_path / "cache"))
    arm, hand = tmp_path / "arm.urdf", tmp_path / "hand.urdf"
    arm.write_text(ARM)
    hand.write_text(HAND)
    return arm, hand


def test_hand_hangs_on_the_arm(files: tuple[Path, Path]):
    """The chain leads through the arm to what hangs on the attached link, and no farther."""
    arm, hand = files

    file = robot_file("x", arm, attachment=HandFile(hand, "palm", "wrist", (0, 0, 0.1)))

    chain = read_chain(file, "finger")
    assert chain.links == ("wrist", "palm", "finger")
    assert "stand" not in file.read_text()


def test_link_that_is_not_there_is_told(files: tuple[Path, Path]):
    """The error names the link and the file."""
    arm, hand = files

    with pytest.raises(DataError, match=r'hand\.urdf: expected a link "claw"'):
        robot_file("x", arm, attachment=HandFile(hand, "claw", "wrist", (0, 0, 0)))


@pytest.mark.sim
@pytest.mark.parametrize("part", ["handle", "blade"])
def test_another_arm_grasps_by_the_same_part(part: str):
    """The KUKA takes the knife by the part it is told, and gives it."""
    with Body(
        parse_scene("objects:knife", seed=3, objects=OBJECTS), OBJECTS, seed=3, robot="kuka"
    ) as body:
        report = body.grasp(body.search(["object:knife"])[0], part)

        assert report.touched == (part,)
        assert body.lift().ok
        assert body.hand_over().ok


def test_kuka_waits_like_the_panda():
    """At home both hands are at the same place."""
    first, second = (find_robot(name) for name in ("panda", "kuka"))

    at_first, at_second = (r.arm.forward(r.home[None])[0, :3, 3] for r in (first, second))

    assert at_second == pytest.approx(at_first, abs=0.02)
