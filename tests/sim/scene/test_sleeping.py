# SPDX-License-Identifier: Apache-2.0
"""Tests for things that lie still."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.scene.scene import parse_scene
from hilt.sim.scene.sleeping import LOOK_EVERY, Resting
from hilt.sim.scene.world import World

pytestmark = pytest.mark.sim
OBJECTS = load_objects()


@pytest.fixture
def world() -> Iterator[World]:
    """A knife and a mug."""
    with World.build(parse_scene("objects:knife,mug", seed=3, objects=OBJECTS), OBJECTS) as made:
        yield made


def step(world: World, resting: Resting, count: int) -> None:
    """Let time pass, and let what rests be watched."""
    for _ in range(count):
        world.step()
        resting.watch(1)


def test_still_things_stay_where_they_are(world: World):
    """What rests has not moved by 2 mm or 0.1 degrees after a second."""
    before = {name: world.pose(name) for name in world.kinds}

    resting = Resting(world.engine, world.kinds)
    step(world, resting, 240)

    assert set(resting.names) == {"knife", "mug"}
    for name, pose in before.items():
        assert world.pose(name) == pytest.approx(pose, abs=2e-3)


def test_moved_thing_wakes_and_is_felt_by_those_that_rest(world: World):
    """A knife that falls on a resting mug touches it."""
    resting = Resting(world.engine, world.kinds)
    above = poses.translation(0, 0, 0.12) @ world.pose("knife")
    above[:2, 3] = world.points("mug")[:, :2].mean(axis=0)

    world.engine.bodies.place("knife", above)
    touched: set[str] = set()
    for _ in range(10):
        step(world, resting, LOOK_EVERY)
        touched |= {contact.other for contact in world.engine.contacts.find("knife", other="mug")}

    assert "knife" not in resting.names
    assert touched == {"mug"}


def test_settled_thing_rests_again(world: World):
    """What was moved and lies still rests again, but for what is going to be moved."""
    resting = Resting(world.engine, world.kinds)
    for name in world.kinds:
        world.engine.bodies.place(name, poses.translation(0.01, 0, 0.0) @ world.pose(name))
    step(world, resting, 240)
    assert not resting.names

    resting.settle(but="mug")

    assert resting.names == ("knife",)
    assert np.isfinite(world.pose("knife")).all()
