"""Kinematics: forward agrees with the simulator, inverse undoes forward."""

from __future__ import annotations

import numpy as np
import pytest

from hilt.ontology.errors import DataError
from hilt.sim import poses
from hilt.sim.physics.engine import PhysicsEngine
from hilt.sim.robot.kinematics import pose_error, read_chain
from hilt.sim.robot.models import find_robot


@pytest.fixture(scope="module")
def panda():
    """The arm that the tests use."""
    return find_robot("panda")


@pytest.mark.sim
def test_forward_agrees_with_the_simulator(panda):
    """The chain puts the hand where the simulator has it, within a micrometre or so."""
    joints = np.random.default_rng(3).uniform(panda.arm.low, panda.arm.high, (20, 7))
    names = panda.arm.names

    with PhysicsEngine() as engine:
        engine.bodies.load("arm", panda.urdf, fixed=True)
        for posture, base_from_hand in zip(joints, panda.arm.forward(joints), strict=True):
            engine.joints.reset("arm", names, posture)
            assert np.allclose(engine.bodies.pose("arm", panda.hand), base_from_hand, atol=2e-6)


def test_solve_reaches_poses_over_a_table(panda):
    """Poses of the hand over a table are reached, within limits and tolerances."""
    rng = np.random.default_rng(5)
    down = poses.rotation_about((1, 0, 0), np.pi)
    turned = poses.rotation_about((0, 0, 1), rng.uniform(-np.pi, np.pi, 60)) @ down
    targets = poses.pose(turned, rng.uniform((0.35, -0.3, 0.12), (0.6, 0.3, 0.3), (60, 3)))

    answer = panda.arm.solve(targets, panda.starts)
    error = pose_error(panda.arm.forward(answer.joints), targets)

    assert answer.found.mean() > 0.95
    assert np.abs(error[answer.found]).max() < 2e-3
    assert np.all((answer.joints >= panda.arm.low) & (answer.joints <= panda.arm.high))


def test_solve_reports_a_pose_out_of_reach(panda):
    """A pose two metres away is not found."""
    target = poses.translation(2.0, 0.0, 0.5)[None]

    answer = panda.arm.solve(target, panda.starts)

    assert not answer.found[0]


def test_jacobian_agrees_with_differences(panda):
    """The Jacobian is the derivative of the tip's pose."""
    joints, step = panda.home[None] + 0.1, 1e-6
    jacobian = panda.arm.jacobian(panda.arm.frames(joints))[0]

    moved = np.concatenate([joints + step * unit for unit in np.eye(7)])
    before = np.repeat(panda.arm.forward(joints), 7, axis=0)
    difference = pose_error(before, panda.arm.forward(moved)).T / step

    assert np.allclose(jacobian, difference, atol=1e-4)


def test_track_follows_a_straight_way_without_a_jump(panda):
    """Along a straight way each posture is near to the one before."""
    base_from_hand = panda.arm.forward(panda.home[None])[0]
    goal = poses.translation(0.0, 0.1, -0.1) @ base_from_hand
    way = poses.interpolate(base_from_hand, goal, np.linspace(0, 1, 11)[1:])

    answer = panda.arm.track(way[None], panda.home[None])

    assert answer.found[0]
    assert np.abs(np.diff(answer.joints[0], axis=0)).max() < 0.1
    assert np.allclose(panda.arm.forward(answer.joints[0]), way, atol=3e-3)


def test_read_chain_names_a_missing_link(panda):
    """The error names the file and the link."""
    with pytest.raises(
        DataError, match=r'panda\.urdf: expected a joint that leads to a link "foot"'
    ):
        read_chain(panda.urdf, "foot")
