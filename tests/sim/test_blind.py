"""The robot judges by sight and touch only: it does as well where all else is hidden from it."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.body import Body
from hilt.sim.physics.bodies import Bodies, Contact
from hilt.sim.robot.robot import NAME
from hilt.sim.scene.scene import graspable, parse_scene
from hilt.sim.vision.camera import Camera, CameraImage

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
CASES = [(name, part) for name in graspable(OBJECTS) for part in OBJECTS[name].parts]


def hide_all_but_sight_and_touch(patch: pytest.MonkeyPatch) -> None:
    """Hide poses of objects, the names of what is touched, and the masks of images."""
    pose, contacts, capture = Bodies.pose, Bodies.contacts, Camera.capture
    noise = np.random.default_rng(0)

    def own_pose(self: Bodies, body: str, link: str | None = None) -> poses.Array:
        assert body == NAME, f"The pose of {body} was read."
        return pose(self, body, link)

    def nameless_contacts(self: Bodies, body: str, link: str | None = None) -> tuple[Contact, ...]:
        assert body == NAME, f"What touches {body} was read."
        found = contacts(self, body, link)
        return tuple(each if each.other == NAME else Contact("", "", each.force) for each in found)

    def unmasked(self: Camera, engine: Any) -> CameraImage:
        image = capture(self, engine)
        labels = noise.integers(0, 9, image.labels.shape, dtype=np.int32)
        return replace(image, labels=labels)

    patch.setattr(Bodies, "pose", own_pose)
    patch.setattr(Bodies, "contacts", nameless_contacts)
    patch.setattr(Camera, "capture", unmasked)


@pytest.mark.parametrize(("name", "part"), CASES)
def test_object_is_handed_over_by_the_part(monkeypatch: pytest.MonkeyPatch, name: str, part: str):
    """It is grasped by the part, lifted and handed over, and the robot says so."""
    scene = parse_scene(f"objects:{name}", seed=17, objects=OBJECTS)
    with Body(scene, OBJECTS, seed=17, vision="learned") as body:
        before = body.world.pose(name)
        with monkeypatch.context() as patch:
            hide_all_but_sight_and_touch(patch)
            grasped = body.grasp(body.search([f"object:{name}"])[0], part)
            lifted, given = body.lift(), body.hand_over()
        height = (body.world.pose(name) - before)[2, 3]
        found = body.world.engine.bodies.contacts(NAME)

    assert (grasped.touched, lifted.ok, given.ok) == ((part,), True, True)
    assert {each.other_link for each in found if each.other == name} == {part}
    assert height > 0.1
