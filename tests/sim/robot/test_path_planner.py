# SPDX-License-Identifier: Apache-2.0
"""Ways of the arm: they hit nothing that was seen, however thin it is."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.sim.physics.engine import PhysicsEngine
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.path_planner import Reacher
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
def test_thin_pole_bars_the_way(robot: Robot, share: float):
    """No way leads through a pole, although it is thinner than a posture is far from the next."""
    seen = pole(robot, share)
    reacher = Reacher(robot, -0.3, seen, seen)

    path = reacher.transit(robot.kind.home + ASIDE, robot.body_spheres(0.03), seen)

    assert path is None


def test_way_through_nothing_is_the_shortest(robot: Robot):
    """Where nothing is in the way, the joints go straight."""
    reacher = Reacher(robot, -0.3, NOTHING, NOTHING)

    path = reacher.transit(robot.kind.home + ASIDE, robot.body_spheres(0.03), NOTHING)

    assert path is not None
    assert len(path) == 2
