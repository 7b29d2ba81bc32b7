"""The world: objects settle where scenes put them, and stay."""

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.ontology.errors import UnknownNameError
from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.physics.engine import TIME_STEP
from hilt.sim.scene.scene import Placement, Scene, graspable, parse_scene
from hilt.sim.scene.world import World

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
        world.engine.step(round(2 / TIME_STEP))
        left = world.pose(name)

        up = poses.rotation_from_rpy(*OBJECTS[name].rest(rest).turn)[2]
        assert np.arccos(np.clip(left[2, :3] @ up, -1, 1)) < MOST_TILT
        assert world.points(name)[:, 2].min() == pytest.approx(0.0, abs=0.001)
        assert np.linalg.norm(left[:3, 3] - laid[:3, 3]) < 0.001
        assert poses.angle_between(left[:3, :3], laid[:3, :3]) < np.radians(1)


def test_eight_objects_settle_without_touching():
    """In a scene of all objects nothing touches anything but the table."""
    with World.build(parse_scene("all", seed=2, objects=OBJECTS), OBJECTS) as world:
        touched = {
            contact.other for name in world.kinds for contact in world.engine.bodies.contacts(name)
        }

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
        world.engine.watchers.append(lambda: seen.append(world.time))
        world.engine.step(3)

        assert seen == pytest.approx([start + i * TIME_STEP for i in (1, 2, 3)])


def test_points_move_with_their_object():
    """An object lifted by 15 cm has its points 15 cm higher."""
    with World.build(parse_scene("objects:shoe", seed=0, objects=OBJECTS), OBJECTS) as world:
        before = world.points("shoe")
        world.engine.bodies.place("shoe", poses.translation(0, 0, 0.15) @ world.pose("shoe"))

        assert world.points("shoe") - before == pytest.approx(
            np.tile((0, 0, 0.15), (len(before), 1)), abs=1e-6
        )


def test_empty_scene_is_a_bare_table():
    """A scene of nothing has a table and a floor."""
    with World.build(Scene((), 0), OBJECTS) as world:
        assert world.engine.bodies.names == ("floor", "table")
        assert not world.kinds


def strike(world: World, height: float) -> None:
    """Let a hammer fall on the nail, face down, and wait until all is over."""
    turn = poses.rotation_from_rpy(-np.pi / 2, 0, 0)
    face = np.array([0.008, 0.058, 0.0145])  # in the frame of the hammer
    x, y = world.pose("nail")[:2, 3]
    above = world.points("nail")[:, 2].max() + height
    world.engine.bodies.place("hammer", poses.pose(turn, np.array([x, y, above]) - turn @ face))
    world.engine.step(round((np.sqrt(2 * height / 9.81) + 0.25) / TIME_STEP))


@pytest.fixture
def carpentry() -> Iterator[World]:
    """A hammer, and a nail in its block."""
    with World.build(parse_scene("objects:hammer,nail", seed=3, objects=OBJECTS), OBJECTS) as made:
        yield made


def test_nail_stands_still_until_it_is_struck(carpentry: World):
    """By itself a nail keeps its depth, to a tenth of a millimetre in two seconds."""
    before = carpentry.depth("nail")

    carpentry.engine.step(round(2 / TIME_STEP))

    assert before == pytest.approx(0.016, abs=1e-4)
    assert carpentry.depth("nail") == pytest.approx(before, abs=1e-4)
    assert carpentry.pose("nail")[2, 2] == pytest.approx(1.0, abs=1e-4)


@pytest.mark.parametrize("height", [0.05, 0.10])
def test_nail_goes_in_as_far_as_the_blow_drives_it(carpentry: World, height: float):
    """Most of the energy of a falling hammer is what the wood resists along the nail's way."""
    start, block = carpentry.depth("nail"), carpentry.pose("block")

    strike(carpentry, height)

    mount = OBJECTS["nail"].mount
    assert mount is not None
    driven = carpentry.depth("nail") - start
    energy = OBJECTS["hammer"].mass * 9.81 * height  # [J]
    assert 0.6 < driven * mount.resistance / energy < 1.2
    assert carpentry.pose("nail")[2, 3] - carpentry.pose("block")[2, 3] == pytest.approx(
        0.07 - carpentry.depth("nail"), abs=1e-3
    )
    assert np.linalg.norm(carpentry.pose("block")[:3, 3] - block[:3, 3]) < 0.001


def test_nail_goes_no_deeper_than_its_head(carpentry: World):
    """However often it is struck, the head stays on the wood."""
    for _ in range(3):
        strike(carpentry, 0.3)

    assert 0.055 < carpentry.depth("nail") < 0.0625


def test_depth_of_what_stands_in_nothing_is_refused(carpentry: World):
    """Only what stands in another thing has a depth."""
    assert carpentry.supports == {"nail": "block"}
    with pytest.raises(UnknownNameError, match=r'object that stands in another "hammer".*nail'):
        carpentry.depth("hammer")


@pytest.fixture
def knife_and_mug() -> Iterator[World]:
    """A knife and a mug."""
    with World.build(parse_scene("objects:knife,mug", seed=3, objects=OBJECTS), OBJECTS) as made:
        yield made


def test_sleeping_objects_stay_where_they_are(knife_and_mug: World):
    """A sleeping object has not moved by 1 mm or 0.1 degrees after a second."""
    knife_and_mug.settle()
    before = {name: knife_and_mug.pose(name) for name in knife_and_mug.kinds}

    knife_and_mug.let_sleep()
    knife_and_mug.engine.step(240)

    for name, pose in before.items():
        assert knife_and_mug.pose(name) == pytest.approx(pose, abs=1e-3)


def test_touched_object_wakes(knife_and_mug: World):
    """A sleeping mug that a knife falls on is pushed by it."""
    bodies = knife_and_mug.engine.bodies
    bodies.put_to_sleep("mug")
    knife_and_mug.engine.step(24)
    before = knife_and_mug.pose("mug")
    above = poses.translation(0, 0, 0.12) @ knife_and_mug.pose("knife")
    above[:2, 3] = knife_and_mug.points("mug")[:, :2].mean(axis=0)

    bodies.place("knife", above)
    knife_and_mug.engine.step(36)

    assert np.abs(knife_and_mug.pose("mug") - before).max() > 1e-3
