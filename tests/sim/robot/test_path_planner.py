"""Paths of the arm: they hit no seen point, however thin the object is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

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

    path = planner.plan_transit(robot.kind.home + ASIDE, robot.body_spheres(0.03), seen)

    assert path is None


def test_path_through_nothing_is_the_shortest(robot: Robot):
    """Where nothing is in the way, the joints go straight."""
    planner = PathPlanner(robot, NOTHING, NOTHING, table=-0.3)

    path = planner.plan_transit(robot.kind.home + ASIDE, robot.body_spheres(0.03), NOTHING)

    assert path is not None
    assert len(path) == 2
