# SPDX-License-Identifier: Apache-2.0
"""Tests for things that lie still."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.scene.scene import parse_scene
from hilt.sim.scene.sleeping import CHECK_INTERVAL, SleepManager
from hilt.sim.scene.world import World

pytestmark = pytest.mark.sim
OBJECTS = load_objects()


@pytest.fixture
def world() -> Iterator[World]:
    """A knife and a mug."""
    with World.build(parse_scene("objects:knife,mug", seed=3, objects=OBJECTS), OBJECTS) as made:
        yield made


def test_sleeping_objects_stay_where_they_are(world: World):
    """A sleeping object has not moved by 2 mm or 0.1 degrees after a second."""
    before = {name: world.pose(name) for name in world.kinds}

    sleeping = SleepManager(world)
    sleeping.step(240)

    assert set(sleeping.asleep) == {"knife", "mug"}
    for name, pose in before.items():
        assert world.pose(name) == pytest.approx(pose, abs=2e-3)


def test_moved_object_wakes_and_touches_sleeping_ones(world: World):
    """A knife that falls on a sleeping mug touches it."""
    sleeping = SleepManager(world)
    above = poses.translation(0, 0, 0.12) @ world.pose("knife")
    above[:2, 3] = world.points("mug")[:, :2].mean(axis=0)

    world.engine.bodies.place("knife", above)
    touched: set[str] = set()
    for _ in range(10):
        sleeping.step(CHECK_INTERVAL)
        touched |= {contact.other for contact in world.engine.contacts.find("knife", other="mug")}

    assert "knife" not in sleeping.asleep
    assert touched == {"mug"}


def test_settled_object_sleeps_again(world: World):
    """Objects that were moved and lie still sleep again, but for the one that will be moved."""
    sleeping = SleepManager(world)
    for name in world.kinds:
        world.engine.bodies.place(name, poses.translation(0.01, 0, 0.0) @ world.pose(name))
    sleeping.step(240)
    assert not sleeping.asleep

    sleeping.sleep_again(but="mug")

    assert sleeping.asleep == ("knife",)
    assert np.isfinite(world.pose("knife")).all()
