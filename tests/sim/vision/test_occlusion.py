"""Images of objects alone show them as images of everything do."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim.robot.models import find_robot
from hilt.sim.robot.robot import NAME, Robot
from hilt.sim.scene.scene import parse_scene
from hilt.sim.scene.world import World
from hilt.sim.vision.camera import CAMERAS_ROUND_TABLE, CameraImage
from hilt.sim.vision.object_detector import capture_objects

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
ACROSS = (0.0, 0.7, 0.0, -1.9, 0.0, 2.6, 0.785)  # the hand is between a camera and the table


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    """All eight objects on the table, and the robot at it."""
    with World.build(parse_scene("all", seed=4, objects=OBJECTS), OBJECTS) as made:
        Robot(made.engine, find_robot("panda"))
        yield made


def images(world: World) -> list[CameraImage]:
    """The images of the cameras, of the objects alone."""
    return list(capture_objects(world.engine, world.kinds, CAMERAS_ROUND_TABLE))


def shown(view: CameraImage) -> dict[tuple[str, str], np.ndarray]:
    """Body and link of what is in view -> the points on it, to a tenth of a millimetre."""
    present = [view.names[label] for label in np.unique(view.labels) if label in view.names]
    return {(body, link): view.points(view.mask(body, link)).round(4) for body, link in present}


def pixels_of_objects(world: World, view: CameraImage) -> dict[tuple[str, str], int]:
    """Body and link of the objects in view -> how many pixels show it."""
    return {key: len(points) for key, points in shown(view).items() if key[0] in world.kinds}


@pytest.mark.parametrize("posture", [None, ACROSS], ids=["arm waiting", "arm before the objects"])
def test_objects_are_seen_as_in_the_whole_image(world: World, posture: tuple[float, ...] | None):
    """No pixel of an object is lost or added."""
    arm = find_robot("panda").arm.names
    waiting = world.engine.joints.positions(NAME, arm)
    world.engine.joints.reset(NAME, arm, posture or waiting)
    views = images(world)
    whole = [view.camera.capture(world.engine) for view in views]
    world.engine.joints.reset(NAME, arm, waiting)

    for part, all_of_it in zip(views, whole, strict=True):
        expected, found = pixels_of_objects(world, all_of_it), pixels_of_objects(world, part)
        assert found == expected


def test_arm_that_cannot_hide_anything_is_not_drawn(world: World):
    """The waiting arm is behind the objects, or beside them."""
    views = images(world)

    assert not any(view.mask(NAME, "panda_hand").any() for view in views)


def test_empty_table_shows_nothing(world: World):
    """Without objects there is nothing to look at."""
    (view,) = capture_objects(world.engine, (), CAMERAS_ROUND_TABLE[:1])

    assert shown(view) == {}
