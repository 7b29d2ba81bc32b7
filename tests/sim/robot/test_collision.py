"""Clearance: gaps between an arm made of spheres and what it may hit."""

from __future__ import annotations

import numpy as np
import pytest

from hilt.sim import poses
from hilt.sim.robot.collision import MAX_GAP, arm_spheres, clearances, finger_spheres, hand_spheres
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.path_planner import TRANSIT_GAP

PANDA = find_robot("panda")
ARM = PANDA.arm
HOME = PANDA.home[None]
NOTHING = np.zeros((0, 3))


def gap(points: np.ndarray, *, table: float = -1.0) -> float:
    """The gap of the waiting arm to these points and the table."""
    spheres = arm_spheres(ARM, PANDA.spheres)
    return clearances(ARM, spheres, HOME, points=points, table=table)[0]


def test_gap_of_a_ball_to_a_point_is_what_geometry_says():
    """A ball of 2 cm round the hand's origin, and a point at (1.5, 1.5, 1.5) cm from it."""
    hand = ARM.forward(HOME)[0]
    point = hand[None, :3, 3] + 0.015
    ball = hand_spheres(ARM, np.zeros((1, 3)), 0.02)

    found = clearances(ARM, ball, HOME, points=point, table=-9.0)[0]

    assert found == pytest.approx(0.015 * np.sqrt(3) - 0.02)


@pytest.mark.parametrize("seed", range(4))
def test_gap_to_many_points_is_that_to_the_nearest(seed: int):
    """It agrees with the distances of all balls to all points, up to where no way needs more."""
    rng = np.random.default_rng(seed)
    points = ARM.forward(HOME)[0, :3, 3] + rng.normal(0.0, 0.2, (800, 3))
    balls = arm_spheres(ARM, PANDA.spheres)
    centres = balls.placed(ARM.frames(HOME))[0]

    apart = np.linalg.norm(centres[:, None] - points, axis=2) - balls.radius[:, None]

    assert gap(points, table=-9.0) == pytest.approx(min(MAX_GAP, apart.min()))


def test_point_inside_the_hand_gives_a_negative_gap():
    """What the hand already fills cannot be passed."""
    assert gap(ARM.forward(HOME)[:, :3, 3] + (0.0, 0.0, -0.03)) < 0


def test_table_counts_as_much_as_points_do():
    """A table raised to the hand is hit, one at the floor is not."""
    hand_height = float(ARM.forward(HOME)[0, 2, 3])

    assert gap(NOTHING, table=hand_height) < 0
    assert gap(NOTHING) > 0.2


def test_fingers_of_an_open_hand_stand_apart():
    """No ball of a finger lies within the opening."""
    assert PANDA.gripper is not None

    fingers = finger_spheres(ARM, PANDA.gripper, 0.06)

    assert (np.abs(fingers.centre[:, 1]) - fingers.radius >= 0.027).all()


def test_object_held_into_the_arm_is_detected():
    """A rod that reaches back to the shoulder hits it; one that hangs down does not."""
    spheres = arm_spheres(ARM, PANDA.spheres)
    shoulder = poses.transform(poses.inverse(ARM.forward(HOME)[0]), np.array([[0.0, 0, 0.333]]))
    below = np.array([[0.0, 0.0, 0.25]])

    def free(points: np.ndarray) -> float:
        held = poses.joined(spheres, hand_spheres(ARM, points, 0.01))
        return clearances(ARM, held, HOME, points=NOTHING, table=-9.0)[1]

    assert free(shoulder) < 0
    assert free(below) > 0.02


def test_hand_folded_back_to_the_forearm_is_detected():
    """The wrist can bend so far that the hand is in the arm, though within its limits."""
    folded = HOME.copy()
    folded[0, 5:] = 0.0

    spheres = arm_spheres(ARM, PANDA.spheres)

    assert clearances(ARM, spheres, folded, points=NOTHING, table=-9.0)[1] < 0


@pytest.mark.parametrize("name", ["panda", "kuka"])
def test_hand_may_turn_as_it_likes_where_the_arm_waits(name: str):
    """The link on which the hand turns is always near: that is no hit."""
    robot = find_robot(name)
    joints = np.tile(robot.home, (60, 1))
    joints[:, -1] = np.linspace(robot.arm.low[-1], robot.arm.high[-1], 60)

    spheres = arm_spheres(robot.arm, robot.spheres)

    assert clearances(robot.arm, spheres, joints, points=NOTHING, table=-9.0)[1] > TRANSIT_GAP


def test_object_held_into_the_link_on_which_the_hand_turns_is_detected():
    """That link counts for what is held, though not for the hand itself."""
    spheres = arm_spheres(ARM, PANDA.spheres)
    frames = ARM.frames(HOME)[0]
    inside = frames[ARM.links.index("panda_link6"), :3, 3][None]
    held = hand_spheres(ARM, poses.transform(poses.inverse(frames[-1]), inside), 0.01)

    found = clearances(ARM, poses.joined(spheres, held), HOME, points=NOTHING, table=-9.0)

    assert found[1] < 0
