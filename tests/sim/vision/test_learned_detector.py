"""The learned detector: types and parts from images alone, with calibrated confidence."""

import runpy
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hilt.ontology.errors import DataError
from hilt.ontology.objects import ObjectType, load_household, load_objects
from hilt.sim import poses
from hilt.sim.poses import voxel_keys
from hilt.sim.scene.scene import Placement, Scene, graspable, parse_scene
from hilt.sim.scene.world import World
from hilt.sim.vision.camera import CameraImage
from hilt.sim.vision.learned_detector import CLASSIFIERS_FILE, LearnedDetector, Recogniser
from hilt.sim.vision.perception_noise import NoiseLevels
from hilt.sim.vision.segmentation import Segment, describe_segment, segment_frame, segment_images

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
ALL = [f"object:{name}" for name in OBJECTS]
TRAINING = Path(__file__).parents[3] / "examples" / "train_recognition.py"
THING = """
objects:
  thing:
    is_a: tool
    parts:
      body: {{role: container, material: glass, colour: "{colour}", mass: 0.3, shape: [{shape}]}}
    rests: {{lying: {{turn_deg: [0, {turn}, 0]}}}}
"""
STRANGE = {
    "bottle": ("#d060c0", "cylinder: {radius: 0.03, length: 0.24}", 0),
    "lying bottle": ("#e070a0", "cylinder: {radius: 0.035, length: 0.16}", 90),
    "rolling pin": ("#c99e6c", "cylinder: {radius: 0.03, length: 0.3}", 90),
    "brick": ("#a03020", "box: {size: [0.16, 0.06, 0.05]}", 0),
    "plate": ("#f0f0f0", "cylinder: {radius: 0.09, length: 0.015}", 0),
    "pen": ("#202080", "cylinder: {radius: 0.006, length: 0.14}", 90),
}


@pytest.fixture(scope="module")
def world() -> Iterator[World]:
    """All eight objects on the table."""
    with World.build(parse_scene("all", seed=11, objects=OBJECTS), OBJECTS) as made:
        yield made


@pytest.fixture(scope="module")
def views(world: World) -> tuple[CameraImage, ...]:
    """Images of the cameras without their mask."""
    seen = LearnedDetector(world).capture()
    return tuple(replace(view, labels=np.full_like(view.labels, -1), names={}) for view in seen)


@pytest.fixture(scope="module")
def detector(world: World) -> LearnedDetector:
    """The detector of that world."""
    return LearnedDetector(world)


def test_each_object_is_one_segment(views: tuple[CameraImage, ...]):
    """Eight objects on a table are eight segments, above the table and apart."""
    found = segment_images(views)

    assert len(found) == 8
    for segment in found:
        assert segment.points[:, 2].min() > 0
        assert len(np.unique(voxel_keys(segment.points, 0.0012))) == len(segment)


def test_empty_table_has_no_segments():
    """An empty table has no segments and no percepts."""
    with World.build(Scene((), 0), OBJECTS) as world:
        detector = LearnedDetector(world)

        assert segment_images(detector.capture()) == ()
        assert detector.search(ALL) == ()


def test_all_objects_are_recognised_without_the_mask(
    world: World, detector: LearnedDetector, views: tuple[CameraImage, ...]
):
    """Each object is detected with its type, at its place."""
    percepts = tuple(detector.detect(views))

    assert {percept.object for percept in percepts} == set(graspable(OBJECTS))
    for percept in percepts:
        assert percept.confidence > 0.8
        assert np.linalg.norm((percept.centre - world.top(percept.object))[:2]) < 0.03


@pytest.fixture(scope="module")
def training() -> dict[str, Any]:
    """What the example that trains the recogniser defines."""
    return runpy.run_path(str(TRAINING))


def recognised(objects: Mapping[str, ObjectType], seed: int, depth_noise: float = 0.0) -> set[str]:
    """Those of the eight objects that are detected at their place, more surely than not."""
    noise = NoiseLevels(depth_m=depth_noise, seed=seed)
    with World.build(parse_scene("all", seed=seed, objects=objects), objects) as world:
        seen = LearnedDetector(world, noise=noise).percepts
        tops = {name: world.top(name) for name in world.kinds}
    return {
        percept.object
        for percept in seen
        if percept.confidence > 0.5
        and np.linalg.norm((percept.centre - tops[percept.object])[:2]) < 0.05
    }


@pytest.mark.parametrize("depth_noise", [0.002, 0.005])
def test_objects_are_recognised_in_noisy_depths(depth_noise: float):
    """Each object is detected at its place, though single pixels are 5 mm off."""
    assert recognised(OBJECTS, 21, depth_noise) == set(graspable(OBJECTS))


@pytest.mark.parametrize("seed", [31, 32])
def test_objects_of_other_colours_are_recognised(seed: int, training: dict[str, Any]):
    """The shape suffices."""
    rng = np.random.default_rng(seed)
    painted = {name: training["recoloured"](OBJECTS[name], rng) for name in graspable(OBJECTS)}

    assert recognised({**OBJECTS, **painted}, seed) == set(graspable(OBJECTS))


@pytest.mark.parametrize("factor", [0.75, 1.3])
def test_objects_of_other_sizes_are_recognised(factor: float, training: dict[str, Any]):
    """Proportions and colours suffice."""
    sized = {name: training["resized"](OBJECTS[name], factor) for name in graspable(OBJECTS)}

    assert recognised({**OBJECTS, **sized}, 41) == set(graspable(OBJECTS))


def test_points_are_shared_out_to_their_parts(
    world: World, detector: LearnedDetector, views: tuple[CameraImage, ...]
):
    """Nineteen of twenty points at least lie in the box round their part."""
    for percept in detector.detect(views):
        object_from_world = poses.inverse(world.pose(percept.name))
        assert set(percept.parts) == set(OBJECTS[percept.object].parts)
        for name, cloud in percept.parts.items():
            points = poses.transform(object_from_world, cloud)
            corners = world.models[percept.object].corners[name]
            low, high = corners.min(axis=0) - 0.004, corners.max(axis=0) + 0.004
            assert ((points > low) & (points < high)).all(axis=1).mean() > 0.95


def test_only_what_is_asked_is_found(detector: LearnedDetector):
    """The learned detector searches for features, too."""
    assert {p.name for p in detector.search(["property:sharp"])} == {"knife"}
    assert detector.search(["action:pass"]) == ()


def test_obstacles_are_all_the_others(world: World, detector: LearnedDetector):
    """Obstacles are points of all other objects."""
    obstacles = detector.obstacles("mug")

    distance = np.linalg.norm(obstacles[:, :2] - world.pose("mug")[:2, 3], axis=1)
    assert len(obstacles) > 1000
    assert distance.min() > 0.03


def test_equal_names_get_numbers(views: tuple[CameraImage, ...]):
    """Where the world has a single object, everything is taken for that."""
    with World.build(parse_scene("objects:mug", seed=2, objects=OBJECTS), OBJECTS) as world:
        names = {percept.name for percept in LearnedDetector(world).detect(views)}

    assert names == {"mug", *(f"mug {number}" for number in range(2, 9))}


def test_nail_is_seen_in_its_block():
    """A nail and the block in which it stands are one segment and two objects."""
    with World.build(parse_scene("objects:nail", seed=2, objects=OBJECTS), OBJECTS) as world:
        percepts = {p.object: p for p in LearnedDetector(world).search(ALL)}

        assert percepts.keys() == {"nail", "block"}
        away = percepts["nail"].parts["head"].mean(axis=0) - world.top("nail")
        assert np.linalg.norm(away) < 0.01


@pytest.mark.parametrize("strange", STRANGE)
def test_novel_object_has_low_confidence(strange: str, tmp_path: Path):
    """It is classified as something known, with little confidence."""
    colour, shape, turn = STRANGE[strange]
    text = THING.format(colour=colour, shape=f"{{{shape}}}", turn=turn)
    (tmp_path / "mine.yaml").write_text(text, encoding="utf-8")
    objects = load_household(tmp_path / "mine.yaml", added_to=load_household()).objects

    with World.build(Scene((Placement("thing", "thing", (0.5, 0.1)),), 0), objects) as world:
        percepts = LearnedDetector(world).percepts

    assert all(percept.confidence < 0.15 for percept in percepts)


def test_description_does_not_change_with_place_and_turn(views: tuple[CameraImage, ...]):
    """A segment that is moved and turned on the table is described nearly alike."""
    segment = max(segment_images(views), key=len)
    moved = poses.pose(poses.rotation_from_rpy(0, 0, 0.8), (0.05, -0.1, 0))

    turned = Segment(poses.transform(moved, segment.points), segment.colours, segment.sources)

    assert describe_segment(turned) == pytest.approx(describe_segment(segment), abs=0.15)
    assert segment_frame(turned.points)[:3, :3] == pytest.approx(
        (moved @ segment_frame(segment.points))[:3, :3], abs=1e-6
    )


def test_recogniser_of_hilts_own_objects_is_small():
    """The file is below a megabyte, and knows the parts of each type."""
    recogniser = Recogniser.default()

    assert CLASSIFIERS_FILE.stat().st_size < 1_000_000
    assert {kind for kind, _ in recogniser.parts} == set(recogniser.kinds)


@pytest.mark.parametrize("content", [b"", b"nothing", b"PK\x03\x04 cut off", b"\x93NUMPY"])
def test_unreadable_recogniser_is_rejected(tmp_path: Path, content: bytes):
    """The error names the file, and what makes such files."""
    (tmp_path / "own.npz").write_bytes(content)

    with pytest.raises(DataError, match=r"own\.npz: cannot be read .*train_recognition\.py"):
        Recogniser.load(tmp_path / "own.npz")


@pytest.mark.parametrize(
    ("left_out", "problem"), [("things_mean", "things_mean"), ("kinds", "made by an earlier")]
)
def test_recogniser_of_other_contents_is_rejected(tmp_path: Path, left_out: str, problem: str):
    """A file of something else lacks arrays; an earlier one has no class of all others."""
    arrays = dict(np.load(CLASSIFIERS_FILE))
    kept = [*arrays.pop(left_out), "other"]
    np.savez(tmp_path / "own.npz", **arrays, **({"kinds": kept} if left_out == "kinds" else {}))

    with pytest.raises(DataError, match=rf"cannot be read \(.*{problem}"):
        Recogniser.load(tmp_path / "own.npz")


def test_recogniser_needs_the_objects_that_it_was_trained_on(world: World):
    """Without their file the error names the option that gives it."""
    knowing = Recogniser.default()
    knowing = replace(knowing, kinds=("rolling pin", *knowing.kinds[1:]))

    with pytest.raises(DataError, match=r"trained on rolling pin.* --objects"):
        LearnedDetector(world, recogniser=knowing)
