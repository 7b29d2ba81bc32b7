"""The mask detector: percepts of the requested features, and smoothing of depths."""

from collections.abc import Iterator

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.scene.scene import graspable, parse_scene
from hilt.sim.scene.world import World
from hilt.sim.vision.camera import CAMERAS_ROUND_TABLE, CameraImage
from hilt.sim.vision.object_detector import FULL_CONFIDENCE, MaskDetector, smooth_depth
from hilt.sim.vision.percept import Percept, visible_features
from hilt.sim.vision.perception_noise import NoiseLevels

OBJECTS = load_objects()
ROWS, COLUMNS = np.mgrid[0:30, 0:40]
OBLIQUE = (0.8 + 0.002 * ROWS - 0.003 * COLUMNS).astype(np.float32)  # [m], an oblique face
LEFT = np.where(COLUMNS < 20, 1, 2).astype(np.int32)


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    """All eight objects on the table."""
    with World.build(parse_scene("all", seed=1, objects=OBJECTS), OBJECTS) as made:
        yield made


@pytest.fixture(scope="module")
def vision(world: World) -> MaskDetector:
    """The detector of that world."""
    return MaskDetector(world)


def whole_images(world: World) -> list[CameraImage]:
    """Images in which the table hides what is below it."""
    return [camera.capture(world.engine) for camera in CAMERAS_ROUND_TABLE]


def names(percepts: tuple[Percept, ...]) -> set[str]:
    """What has been found."""
    return {percept.name for percept in percepts}


@pytest.mark.sim
def test_every_object_is_seen_with_all_its_parts(vision: MaskDetector):
    """Nothing on a well-lit table is missed."""
    percepts = vision.search([f"object:{name}" for name in OBJECTS])

    assert names(percepts) == set(graspable(OBJECTS))
    for percept in percepts:
        assert set(percept.parts) == set(OBJECTS[percept.object].parts)
        assert percept.confidence == pytest.approx(FULL_CONFIDENCE, abs=0.1)


@pytest.mark.sim
@pytest.mark.parametrize(
    ("features", "expected"),
    [
        (["object:knife"], {"knife"}),
        (["object:knife", "object:mug", "object:sabre"], {"knife", "mug"}),
        (["part:stem"], {"glass"}),
        (["property:sharp"], {"knife"}),
        (["action:pass", "affordance:cutting"], set()),
        ([], set()),
    ],
)
def test_only_what_is_asked_is_found(vision: MaskDetector, features: list[str], expected: set[str]):
    """Search returns the objects that have one of the features, and no others."""
    assert names(vision.search(features)) == expected


@pytest.mark.sim
def test_cloud_lies_on_its_part(world: World, vision: MaskDetector):
    """The points of a part are inside the box round that part, to half a millimetre."""
    (percept,) = vision.search(["object:hammer"])

    object_from_world = poses.inverse(world.pose("hammer"))
    for part, cloud in percept.parts.items():
        points = poses.transform(object_from_world, cloud)
        corners = world.models["hammer"].corners[part]
        assert (points > corners.min(axis=0) - 0.0005).all()
        assert (points < corners.max(axis=0) + 0.0005).all()


@pytest.mark.sim
def test_half_hidden_object_is_less_sure():
    """A glass of which only the upper third is in sight is seen with less confidence."""
    with World.build(parse_scene("objects:glass", seed=0, objects=OBJECTS), OBJECTS) as world:
        (before,) = MaskDetector(world).detect(whole_images(world))
        world.engine.bodies.place("glass", poses.translation(0, 0, -0.12) @ world.pose("glass"))
        (after,) = MaskDetector(world).detect(whole_images(world))

    assert before.confidence == FULL_CONFIDENCE
    assert after.confidence < 0.9 * FULL_CONFIDENCE
    assert set(after.parts) == {"bowl"}


@pytest.mark.sim
def test_absent_object_is_not_seen():
    """An object that has left the table is not found."""
    with World.build(parse_scene("objects:mug", seed=0, objects=OBJECTS), OBJECTS) as world:
        world.engine.bodies.place("mug", poses.translation(0, 0, -0.6))

        assert not tuple(MaskDetector(world).detect(whole_images(world)))


@pytest.mark.sim
def test_obstacles_are_the_other_objects(world: World, vision: MaskDetector):
    """Obstacles are points of all objects but the one that is wanted, and not of the table."""
    obstacles = vision.obstacles("mug")

    near_mug = np.linalg.norm(obstacles[:, :2] - world.pose("mug")[:2, 3], axis=1) < 0.03
    assert len(obstacles) > 1000
    assert not near_mug.any()


@pytest.mark.sim
def test_depth_noise_blurs_clouds_and_comes_from_its_seed(world: World):
    """With 2 mm of depth noise points still leave their part, the same ones each time."""
    noise = NoiseLevels(depth_m=0.002, seed=4)

    (percept,) = MaskDetector(world, noise=noise).search(["object:mug"])
    (again,) = MaskDetector(world, noise=noise).search(["object:mug"])

    points = poses.transform(poses.inverse(world.pose("mug")), percept.parts["barrel"])
    beyond = points.max(axis=0) - world.models["mug"].corners["barrel"].max(axis=0)
    assert 0.0004 < beyond.max() < 0.006  # [m]
    assert (percept.cloud == again.cloud).all()


def test_features_of_a_type_are_its_names_parts_and_properties():
    """A knife can be searched for as a knife, by its blade or as something sharp."""
    assert {"object:knife", "part:blade", "property:sharp"} <= visible_features(OBJECTS["knife"])


def test_clouds_cannot_be_changed():
    """The points of a percept are read-only."""
    percept = Percept("mug", "mug", 0.9, {"barrel": np.zeros((4, 3))})

    with pytest.raises(ValueError, match="read-only"):
        percept.parts["barrel"][0, 0] = 1.0


def test_plane_stays_what_it_is():
    """Also at its rim, where a mean would bend it."""
    result = smooth_depth(OBLIQUE, LEFT, [1, 2], noise=0.002)

    assert result == pytest.approx(OBLIQUE, abs=1e-3)
    assert result[5:25, 5:15] == pytest.approx(OBLIQUE[5:25, 5:15], abs=1e-4)


def test_noise_becomes_a_quarter():
    """Noise of 2 mm is below 0.6 mm in the mean over a whole face."""
    noise = np.random.default_rng(3).normal(0.0, 0.002, OBLIQUE.shape)

    result = smooth_depth((OBLIQUE + noise).astype(np.float32), LEFT, [1, 2], noise=0.002)

    assert float(np.std(result - OBLIQUE)) < 0.0006


def test_step_between_two_parts_stays_sharp():
    """What is a centimetre behind is not pulled forwards by what is before it."""
    step = np.where(LEFT == 1, 0.80, 0.81).astype(np.float32)

    result = smooth_depth(step, LEFT, [1, 2], noise=0.002)

    assert result == pytest.approx(step, abs=1e-6)


def test_part_that_hides_more_of_itself_keeps_its_edge():
    """Behind the rim of a mug its far wall is seen: one part, but two faces."""
    mug = np.where(COLUMNS < 20, 0.80, 0.86).astype(np.float32)

    result = smooth_depth(mug, np.ones_like(LEFT), [1], noise=0.002)

    assert result == pytest.approx(mug, abs=1e-5)


def test_all_else_stays_as_it_was():
    """Pixels of other labels keep their noise."""
    noisy = np.random.default_rng(4).normal(0.8, 0.01, OBLIQUE.shape).astype(np.float32)

    result = smooth_depth(noisy, LEFT, [1], noise=0.01)

    assert np.array_equal(result[LEFT == 2], noisy[LEFT == 2])
    assert not np.array_equal(result[LEFT == 1], noisy[LEFT == 1])
