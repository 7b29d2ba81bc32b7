# SPDX-License-Identifier: Apache-2.0
"""The world: objects settle where scenes put them, and stay."""

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.engine import TIME_STEP
from hilt.sim.scene import Placement, Scene, graspable, parse_scene
from hilt.sim.world import World

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
RESTS = [(name, rest.name) for name in graspable(OBJECTS) for rest in OBJECTS[name].rests]
MOST_TILT = np.radians(30)  # a mug on its side rolls until its handle touches the table


@pytest.mark.parametrize(("name", "rest"), RESTS)
def test_every_rest_is_stable(name: str, rest: str):
    """Every object comes to lie nearly as it was laid, on the table, and stays for two seconds."""
    scene = Scene((Placement(name, name, (0.5, 0.0), 0.4, rest),), 0)

    with World.build(scene, OBJECTS) as world:
        laid = world.pose(name)
        world.step(round(2 / TIME_STEP))
        left = world.pose(name)

        up = poses.rotation_from_rpy(*OBJECTS[name].rest(rest).turn)[2]
        assert np.arccos(np.clip(left[2, :3] @ up, -1, 1)) < MOST_TILT
        assert world.clearance(name) == pytest.approx(0.0, abs=0.001)
        assert np.linalg.norm(left[:3, 3] - laid[:3, 3]) < 0.001
        assert poses.angle_between(left[:3, :3], laid[:3, :3]) < np.radians(1)


def test_eight_objects_settle_without_touching():
    """In a scene of all objects nothing touches anything but the table."""
    with World.build(parse_scene("all", seed=2, objects=OBJECTS), OBJECTS) as world:
        touched = {contact.other for name in world.kinds for contact in world.engine.contacts(name)}

        assert len(world.kinds) == 8
        assert touched == {"table"}


def test_same_scene_is_the_same_world():
    """Two worlds of one scene agree to the last bit."""
    scene = parse_scene("objects:spoon,mug", seed=5, objects=OBJECTS)

    with World.build(scene, OBJECTS) as one, World.build(scene, OBJECTS) as other:
        assert (one.points("spoon") == other.points("spoon")).all()
        assert one.time == other.time


def test_watcher_sees_every_step():
    """Whoever watches is called once for each step."""
    seen: list[float] = []

    with World.build(parse_scene("objects:mug", seed=0, objects=OBJECTS), OBJECTS) as world:
        start = world.time
        world.watcher = lambda: seen.append(world.time)
        world.step(3)

        assert seen == pytest.approx([start + i * TIME_STEP for i in (1, 2, 3)])


def test_clearance_is_the_height_above_the_table():
    """An object lifted by 15 cm is 15 cm above the table."""
    with World.build(parse_scene("objects:shoe", seed=0, objects=OBJECTS), OBJECTS) as world:
        before = world.clearance("shoe")
        world.engine.place("shoe", poses.translation(0, 0, 0.15) @ world.pose("shoe"))

        assert world.clearance("shoe") - before == pytest.approx(0.15, abs=1e-6)


def test_empty_scene_is_a_bare_table():
    """A scene of nothing has a table and a floor."""
    with World.build(Scene((), 0), OBJECTS) as world:
        assert world.engine.bodies == ("floor", "table")
        assert not world.kinds
