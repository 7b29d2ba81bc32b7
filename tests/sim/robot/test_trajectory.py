"""Trajectories: packed and read back, exported in three forms, and true to what the robot did."""

from __future__ import annotations

import json
import sys
from io import BytesIO

import numpy as np
import pytest

from hilt.ontology.errors import DataError, MissingExtraError
from hilt.ontology.objects import load_objects
from hilt.sim import Body, parse_scene
from hilt.sim.robot.robot import FINGER_SPEED
from hilt.sim.robot.trajectory import export, pack, unpack

TABLE = np.array([[0.5, -1.25, 0.04], [0.520833, -1.249999, 0.039], [0.55, 2.5, 0.0]])
PACKED = pack("arm", ("elbow", "finger"), TABLE)
WRONG = ("{}", "[]", "arm", '{"joints": ["elbow"], "data": "AAAA"}', '{"joints": 1, "data": ""}')


def test_packed_trajectory_comes_back():
    """Robot, joints, times and positions, to a millionth."""
    found = unpack(PACKED)

    assert (found["robot"], found["joints"]) == ("arm", ["elbow", "finger"])
    assert found["time_s"] == TABLE[:, 0].tolist()
    assert found["positions"] == TABLE[:, 1:].tolist()


@pytest.mark.parametrize("text", [*WRONG, PACKED.replace('"finger"', '"finger", "thumb"')])
def test_text_that_is_no_trajectory_is_refused(text: str):
    """Also one with another number of joints."""
    with pytest.raises(DataError, match="hilt:trajectory: is no trajectory"):
        unpack(text)


def test_long_motion_of_small_steps_does_not_drift():
    """Differences are of the rounded numbers, so that rounding does not add up."""
    times = np.arange(20_000) / 48
    table = np.column_stack([times, np.sin(times / 7), times * 1e-7])

    found = unpack(pack("arm", ("elbow", "finger"), table))

    assert np.abs(np.array(found["positions"]) - table[:, 1:]).max() < 1e-6


def test_table_has_a_column_for_each_joint():
    """As CSV, with a line for the names, and fixed decimals."""
    lines = export(PACKED, "csv").decode().splitlines()

    assert lines[0] == "time_s,elbow,finger"
    assert lines[2] == "0.520833,-1.249999,0.039000"
    assert len(lines) == 4


def test_json_is_what_was_packed():
    """One document on one line."""
    assert json.loads(export(PACKED, "json")) == unpack(PACKED)


def test_mcap_has_a_message_for_each_time():
    """With the positions and the velocities of all joints, in one channel."""
    reading = pytest.importorskip("mcap.reader", reason='the extra "mcap" is not installed')

    reader = reading.make_reader(BytesIO(export(PACKED, "mcap")))
    found = [(schema, message) for schema, _, message in reader.iter_messages("/joint_states")]

    messages = [json.loads(message.data) for _, message in found]
    assert {schema.name for schema, _ in found} == {"foxglove.JointStates"}
    assert [message.log_time for _, message in found] == [500_000_000, 520_833_000, 550_000_000]
    assert messages[1]["timestamp"] == {"sec": 0, "nsec": 520_833_000}
    assert messages[2]["joints"][0] == {
        "name": "elbow", "position": 2.5, "velocity": pytest.approx(3.749999 / 0.029167, rel=1e-6),
    }  # fmt: skip


def test_mcap_without_its_package_says_what_to_install(monkeypatch: pytest.MonkeyPatch):
    """The extra of its own."""
    monkeypatch.setitem(sys.modules, "mcap.writer", None)

    with pytest.raises(MissingExtraError, match=r'pip install "hilt\[mcap\]"'):
        export(PACKED, "mcap")


@pytest.mark.sim
@pytest.mark.parametrize("robot", ["panda", "kuka"])
def test_trajectory_of_a_hand_over_is_what_the_arm_did(robot: str):
    """It ends where the robot does; times increase; joints and fingers keep to their speeds."""
    objects = load_objects()
    with Body(
        parse_scene("objects:mug", seed=7, objects=objects), objects, seed=7, robot=robot
    ) as b:
        b.grasp(b.search(["object:mug"])[0], "handle"), b.lift(), b.hand_over()
        ended, opening, limits = b.robot.joints, b.robot.opening, b.robot.chain.speed
        found, after = unpack(b.robot.take_trajectory() or ""), b.robot.take_trajectory()

    times, positions = np.array(found["time_s"]), np.array(found["positions"])
    speeds = np.abs(np.diff(positions, axis=0)) / np.diff(times)[:, None]
    assert np.abs(positions[-1, :-2] - ended).max() < 1e-6
    assert positions[-1, -2:].sum() == pytest.approx(opening, abs=2e-6)
    assert 0 < np.diff(times).min() <= np.diff(times).max() < 0.05
    assert (speeds[:, :-2] <= limits).all()
    assert speeds[:, -2:].max() < 1.01 * FINGER_SPEED
    assert after is None
