"""Paths of the arm: they hit no seen point, however thin the object is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.sim import poses
from hilt.sim.physics.engine import PhysicsEngine
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.path_planner import PathPlanner
from hilt.sim.robot.robot import Robot

pytestmark = pytest.mark.sim

ASIDE = np.array((0.7, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0))
NOTHING = np.zeros((0, 3))


@pytest.fixture
def robot() -> Iterator[Robot]:
    """A Panda alone in the world."""
    with PhysicsEngine() as engine:
        yield Robot(engine, find_robot("panda"))


def pole(robot: Robot, share: float) -> np.ndarray:
    """Points of a thin pole in the way of the fingers, that far on the way to `ASIDE`."""
    on_the_way = robot.chain.forward((robot.kind.home + share * ASIDE)[None])[0, :3, 3]
    heights = np.linspace(-0.2, -0.085, 13)
    return on_the_way + np.column_stack([0 * heights, 0 * heights, heights])


@pytest.mark.parametrize("share", np.linspace(0.3, 0.7, 5))
def test_thin_pole_bars_the_path(robot: Robot, share: float):
    """No path leads through a pole that is thinner than the distance between two postures."""
    seen = pole(robot, share)
    planner = PathPlanner(robot, seen, seen, table=-0.3)

    path = planner.plan_transit(robot.kind.home + ASIDE, 0.03)

    assert path is None


def test_path_through_nothing_is_the_shortest(robot: Robot):
    """Where nothing is in the way, the joints go straight."""
    planner = PathPlanner(robot, NOTHING, NOTHING, table=-0.3)

    path = planner.plan_transit(robot.kind.home + ASIDE, 0.03)

    assert path is not None
    assert len(path) == 2


@pytest.mark.parametrize(("beside", "clear"), [(0.15, False), (0.45, True)])
def test_straight_path_is_clear_of_what_stands_beside_it(robot: Robot, beside: float, clear: bool):
    """A path of 20 cm to the side is barred by a pole on it, and not by one beyond its end."""
    start = robot.world_from_grip
    seen = start[:3, 3] + [(0.0, beside, height) for height in np.linspace(-0.05, 0.05, 9)]
    planner = PathPlanner(robot, seen, seen)

    path = planner.plan_straight(poses.translation(0, 0.2, 0) @ start)

    assert path is not None
    assert planner.is_clear(path, 0.04) == clear


def test_way_into_the_arm_is_none(robot: Robot):
    """No path leads to a posture whose hand is in the forearm."""
    planner = PathPlanner(robot, NOTHING, NOTHING)
    folded = robot.kind.home.copy()
    folded[5:] = 0.0

    assert planner.plan_transit(folded, 0.03) is None
