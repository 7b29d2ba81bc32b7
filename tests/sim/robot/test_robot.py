"""The robot in the simulator: it follows paths, and senses what its gripper closes on."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.sim import poses
from hilt.sim.physics.engine import PhysicsEngine
from hilt.sim.poses import Array
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.robot import NAME, Robot, resample, time_path
from tests.sim.contacts import finger_contacts

STEP = 1 / 240
SPEEDS, ACCELERATIONS = np.array([2.0, 1.0]), np.array([15.0, 7.5])
postures = st.lists(st.tuples(st.floats(-2, 2), st.floats(-2, 2)), min_size=2, max_size=6)
BLOCK = """<robot name="block"><link name="core">
<inertial><mass value="0.1"/>
<inertia ixx="1e-4" ixy="0" ixz="0" iyy="1e-4" iyz="0" izz="1e-4"/></inertial>
<collision><geometry><box size="0.03 0.03 0.03"/></geometry></collision></link></robot>"""


@pytest.fixture
def robot() -> Iterator[Robot]:
    """A Panda alone in the world."""
    with PhysicsEngine() as engine:
        yield Robot(engine, find_robot("panda"))


@pytest.mark.sim
def test_follow_ends_where_the_path_does(robot: Robot):
    """The joints end within a milliradian of the path's last posture."""
    goal = robot.kind.home + np.array((0.4, 0.2, 0.1, -0.2, 0.1, 0.2, 0.5))

    arrived = robot.follow(np.vstack([robot.joints, goal]), pace=0.6)
    robot.advance(24)

    assert arrived
    assert np.abs(robot.joints - goal).max() < 1e-3


@pytest.mark.sim
def test_arm_keeps_to_its_way_when_all_its_joints_hurry(robot: Robot):
    """Also where the wrist is flung about, no joint is farther from its way than a step's worth."""
    goal = robot.kind.home + np.array((0.8, 0.3, 0.25, -0.3, -1.7, 0.5, -0.9))
    wanted, _ = robot.timed(np.vstack([robot.joints, goal]), pace=0.9)
    found: list[Array] = []
    robot.follow(
        np.vstack([robot.joints, goal]), pace=0.9, stop=lambda: found.append(robot.joints) or False
    )

    assert np.abs(np.array(found) - wanted).max() < 0.012


@pytest.mark.sim
def test_follow_stops_when_it_is_asked_to(robot: Robot):
    """A path is left at the first step whose question is answered with yes."""
    goal = robot.kind.home + 0.4
    start = robot.engine.steps

    arrived = robot.follow(np.vstack([robot.joints, goal]), pace=0.5, stop=lambda: True)

    assert not arrived
    assert robot.engine.steps == start + 1


@pytest.mark.sim
def test_hand_in_the_simulator_is_where_the_chain_has_it(robot: Robot):
    """Kinematics and simulator agree on the grip frame."""
    base_from_hand = robot.chain.forward(robot.joints[None])[0]

    assert np.allclose(robot.world_from_hand, base_from_hand, atol=1e-5)


@pytest.mark.sim
def test_opening_and_closing_move_both_fingers_alike(robot: Robot):
    """The gear keeps the fingers symmetric."""
    robot.open(0.05)
    robot.advance(120)
    halfway = robot.opening
    fingers = robot.engine.joints.positions(NAME, robot.gripper.joints)
    robot.close()

    assert halfway == pytest.approx(0.05, abs=5e-4)
    assert fingers[0] == pytest.approx(fingers[1], abs=2e-4)
    assert robot.opening < 1e-3


@pytest.mark.sim
def test_fingers_are_no_faster_than_real_ones(robot: Robot):
    """Opening and closing, neither finger passes 5 cm a second."""
    speeds: list[float] = []
    robot.open(0.0)
    for _ in range(200):
        robot.advance(1)
        speeds += robot.engine.joints.states(NAME, robot.gripper.joints)[1].tolist()
    robot.open(robot.gripper.opening)
    for _ in range(200):
        robot.advance(1)
        speeds += robot.engine.joints.states(NAME, robot.gripper.joints)[1].tolist()

    assert np.abs(speeds).max() < 0.0505
    assert robot.opening == pytest.approx(robot.gripper.opening, abs=1e-3)


@pytest.mark.sim
def test_closed_gripper_senses_what_is_between_its_fingers(robot: Robot, tmp_path: Path):
    """Both fingers press on a block, and hold it against gravity without any constraint."""
    urdf = tmp_path / "block.urdf"
    urdf.write_text(BLOCK, encoding="utf-8")
    robot.open(0.034)
    robot.advance(120)
    robot.engine.bodies.load("block", urdf, poses.pose(np.eye(3), robot.world_from_grip[:3, 3]))

    robot.close()
    touched, is_holding = finger_contacts(robot), robot.is_holding
    pressed = robot.engine.bodies.contacts("robot", robot.gripper.links[0])
    robot.advance(120)

    assert is_holding
    assert touched == [{("block", "core")}] * 2
    assert sum(c.force for c in pressed) == pytest.approx(robot.gripper.force, rel=0.3)
    assert abs(robot.engine.bodies.pose("block")[2, 3] - robot.world_from_grip[2, 3]) < 0.02


@pytest.mark.sim
def test_empty_gripper_senses_nothing(robot: Robot):
    """The fingers that meet each other do not count."""
    robot.close()

    assert not robot.is_touching()
    assert not robot.is_holding


@given(postures, st.floats(0.1, 1.0))
def test_path_ends_at_rest_where_the_path_ends(points, pace):
    """The last position is the path's end, and it stands still there."""
    positions, speeds = time_path(np.array(points), SPEEDS, ACCELERATIONS, step=STEP, pace=pace)

    assert np.allclose(positions[-1], points[-1])
    assert not speeds[-1].any()


@given(postures, st.floats(0.1, 1.0))
def test_path_keeps_to_the_speed_limits(points, pace):
    """No joint is asked for more than its share of its limit."""
    _, speeds = time_path(np.array(points), SPEEDS, ACCELERATIONS, step=STEP, pace=pace)

    assert np.all(np.abs(speeds) <= SPEEDS * pace * 1.02 + 1e-9)


@given(postures, st.floats(0.1, 1.0))
def test_path_keeps_to_the_accelerations(points, pace):
    """Nor to get faster or slower than it can, and the acceleration itself changes gradually."""
    _, speeds = time_path(np.array(points), SPEEDS, ACCELERATIONS, step=STEP, pace=pace)

    accelerations = np.diff(speeds, axis=0, prepend=np.zeros((1, 2))) / STEP
    assert np.all(np.abs(accelerations) <= ACCELERATIONS * (1 + 1e-9))
    jerks = np.diff(accelerations, axis=0) / STEP
    assert np.all(np.abs(jerks) <= 7500)


@given(postures, st.floats(0.05, 0.5))
def test_resampling_leaves_no_gap(points, apart):
    """Of a run are kept its ends, and so much that a joint turns little between two positions."""
    positions, _ = time_path(np.array(points), SPEEDS, ACCELERATIONS, step=STEP, pace=0.9)

    kept = resample(positions, apart)

    assert np.allclose(kept[[0, -1]], positions[[0, -1]])
    longest_step = np.abs(np.diff(positions, axis=0)).max(initial=0.0)
    assert np.abs(np.diff(kept, axis=0)).max(initial=0.0) <= apart + longest_step + 1e-9


def test_path_takes_longer_at_a_slower_pace():
    """Half the pace takes twice as long, but for the rounding."""
    path = np.array([[0.0, 0.0], [1.0, 0.5]])

    fast, slow = (
        len(time_path(path, SPEEDS, ACCELERATIONS, step=STEP, pace=pace)[0]) - 0.1 / STEP
        for pace in (0.8, 0.4)
    )

    assert slow == pytest.approx(2 * fast, abs=2)
