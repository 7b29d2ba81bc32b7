"""Noise: objects are missed, confused and doubted as often as asked, and from the seed."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.ontology.errors import DataError
from hilt.ontology.objects import load_objects
from hilt.sim.scene.scene import graspable
from hilt.sim.vision.camera import Camera, CameraImage
from hilt.sim.vision.percept import Percept, visible_features
from hilt.sim.vision.perception_noise import (
    NoiseLevels,
    NoisyDetector,
    relabelled,
    with_depth_noise,
    without_mixed_pixels,
)

OBJECTS = load_objects()
KINDS = graspable(OBJECTS)
ALL = [f"object:{name}" for name in KINDS]
COUNT = 400
shares = st.floats(0, 1)


@dataclass(frozen=True)
class Crowd:
    """A perfect detector before many objects of all types."""

    percepts: tuple[Percept, ...]

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """Those that have one of the features."""
        wanted = frozenset(features)
        return [p for p in self.percepts if wanted & visible_features(OBJECTS[p.object])]


def percept(name: str, kind: str) -> Percept:
    """A object seen for certain, with a point on each part."""
    parts = {part: np.zeros((1, 3)) for part in OBJECTS[kind].parts}
    return Percept(name, kind, 1.0, parts, OBJECTS[kind].properties)


CROWD = Crowd(tuple(percept(f"{KINDS[i % 8]} {i}", KINDS[i % 8]) for i in range(COUNT)))


def seen(noise: NoiseLevels, features: Sequence[str] = ALL) -> dict[str, Percept]:
    """The percepts of the crowd with noise."""
    found = NoisyDetector(CROWD.search, noise, OBJECTS).search(features)
    return {percept.name: percept for percept in found}


@given(shares, shares, shares, st.integers(0, 2**31 - 1))
def test_same_seed_is_the_same_noise(missed: float, confused: float, doubt: float, seed: int):
    """Misperception depends on nothing but the amounts and the seed."""
    noise = NoiseLevels(missed, confused, doubt, seed=seed)
    detector = NoisyDetector(Crowd(CROWD.percepts[:8]).search, noise, OBJECTS)

    first, second = detector.search(ALL), detector.search(ALL)

    facts = [[(p.name, p.object, p.confidence) for p in percepts] for percepts in (first, second)]
    assert facts[0] == facts[1]


def test_without_noise_nothing_changes():
    """No noise changes nothing."""
    facts = {p.name: (p.object, p.confidence, p.parts) for p in seen(NoiseLevels()).values()}
    assert facts == {p.name: (p.object, p.confidence, p.parts) for p in CROWD.percepts}


def test_objects_are_missed_as_often_as_asked():
    """With missed=0.2, a fifth of all objects is missed."""
    left = seen(NoiseLevels(missed=0.2, seed=1))

    assert len(left) / COUNT == pytest.approx(0.8, abs=0.06)


def test_objects_are_confused_as_often_as_asked():
    """With confused=0.3, three in ten objects are taken for another type that can be grasped."""
    found = seen(NoiseLevels(confused=0.3, seed=1))

    wrong = [p for name, p in found.items() if name.rsplit(" ", 1)[0] != p.object]
    assert len(wrong) / COUNT == pytest.approx(0.3, abs=0.06)
    assert {p.object for p in wrong} == set(KINDS)


def test_confused_object_is_found_as_what_it_is_relabelled():
    """A search for knives finds all that seems a knife, and no knife that seems something else."""
    noise = NoiseLevels(confused=0.3, seed=1)

    knives = seen(noise, ["object:knife"])

    assert knives.keys() == {name for name, p in seen(noise).items() if p.object == "knife"}
    assert {name.rsplit(" ", 1)[0] for name in knives} > {"knife"}


def test_confidence_falls_by_no_more_than_asked():
    """With confidence=0.4 percepts keep between 60 and 100 % of theirs."""
    kept = [percept.confidence for percept in seen(NoiseLevels(confidence=0.4, seed=1)).values()]

    assert 0.6 <= min(kept) < 0.62
    assert 0.98 < max(kept) <= 1.0
    assert kept == sorted(kept, reverse=True)


def test_object_keeps_its_noise_whatever_is_searched():
    """Whether other objects are looked for as well makes no difference to one of them."""
    noise = NoiseLevels(missed=0.3, confidence=0.5, seed=3)
    alone, among = seen(noise, ["object:mug"]), seen(noise)

    assert alone
    assert all(among[name].confidence == each.confidence for name, each in alone.items())


def test_relabelled_percept_has_the_parts_of_the_other_type():
    """A spoon taken for a knife shows a handle and a blade."""
    mistaken = relabelled(percept("spoon 1", "spoon"), OBJECTS["knife"])

    assert list(mistaken.parts) == ["handle", "blade"]
    assert "sharp" in mistaken.properties
    assert mistaken.name == "spoon 1"


def image_at(depth: float, name: str = "one") -> CameraImage:
    """An image of a wall at this distance [m], whose right half has the label 1."""
    camera = Camera(name, (0.0, 0.0, 1.0), (0.0, 0.0, 0.0), width=120, height=80)
    camera = replace(camera, calibration=(565.0, 565.0, 60.0, 40.0))
    shape, labels = (80, 120), np.zeros((80, 120), dtype=np.int32)
    labels[:, 60:] = 1
    colour = np.zeros((*shape, 3), dtype=np.uint8)
    return CameraImage(camera, colour, np.full(shape, depth, dtype=np.float32), labels, {})


def test_depth_noise_is_new_in_every_image():
    """Noise depends on the step and the camera, and is repeatable."""
    noise, image = NoiseLevels(depth_m=0.002, seed=5), image_at(1.0)

    first = with_depth_noise(image, noise, 10, {}).depth

    assert (first == with_depth_noise(image, noise, 10, {}).depth).all()
    assert (first != with_depth_noise(image, noise, 11, {}).depth).any()
    assert (first != with_depth_noise(image_at(1.0, "two"), noise, 10, {}).depth).any()
    assert np.std(first) == pytest.approx(0.002, rel=0.05)
    assert with_depth_noise(image, NoiseLevels(), 10, {}) is image


@pytest.mark.parametrize("amount", [1.0, 2.0])
def test_errors_of_a_depth_camera_grow_with_the_square_of_the_distance(amount: float):
    """Twice as far the depth is four times as uncertain, and its steps are four times as large."""
    noise = NoiseLevels(camera=amount, seed=5)
    near, far = (with_depth_noise(image_at(z), noise, 1, {}).depth for z in (0.6, 1.2))

    deviation = 0.6**2 * 0.08 * amount / (565 * 0.05)
    assert np.nanstd(near) == pytest.approx(deviation, rel=0.1)
    assert np.nanstd(far) == pytest.approx(4 * np.nanstd(near), rel=0.1)
    steps = np.diff(np.unique(near[np.isfinite(near)]))
    assert np.median(steps) == pytest.approx(0.6**2 / (565 * 0.05 * 32), rel=0.1)


def test_depth_camera_has_holes_where_things_shine():
    """A share of the pixels that is the square of the shine; elsewhere hardly any."""
    depth = with_depth_noise(image_at(0.8), NoiseLevels(camera=1, seed=5), 1, {1: 0.7}).depth

    assert np.isnan(depth[:, 60:]).mean() == pytest.approx(0.49, abs=0.06)
    assert np.isnan(depth[:, :60]).mean() < 0.01


def test_pixels_of_no_surface_lie_at_edges_and_can_be_removed():
    """Between both surfaces, and nowhere else; what is removed is near the edge."""
    image = image_at(1.0)
    image.depth[:, 60:] = 0.8
    seen = with_depth_noise(image, NoiseLevels(camera=1, seed=5), 1, {})
    cleaned = without_mixed_pixels(seen)

    mixed = (seen.depth > 0.83) & (seen.depth < 0.97)
    assert 5 < np.count_nonzero(mixed) == np.count_nonzero(mixed[:, 59:61])
    assert not np.any((cleaned.depth > 0.83) & (cleaned.depth < 0.97))
    assert np.isfinite(cleaned.depth[:, :55]).mean() > 0.9


@pytest.mark.parametrize("text", ["", "missed=0.1", "missed=0.1, depth_m=0.002,confused=1"])
def test_noise_is_read_from_text(text: str):
    """Each amount of the text is read."""
    noise = NoiseLevels.parse(text, seed=2)

    for item in filter(None, text.split(",")):
        name, _, number = item.strip().partition("=")
        assert getattr(noise, name) == float(number)


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("fog=1", 'expected one of missed, confused, confidence, depth_m, camera, found "fog"'),
        ("missed=some", 'expected a number after "missed=", found "some"'),
        ("missed", 'expected a number after "missed=", found ""'),
        ("missed=1.5", r"missed must be in \[0, 1\], found 1.5"),
        ("depth_m=2", r"depth_m must be in \[0, 0.05\], found 2"),
        ("missed=nan", "missed must be in"),
    ],
)
def test_wrong_noise_is_an_error(text: str, problem: str):
    """The error says what was expected."""
    with pytest.raises(DataError, match=problem):
        NoiseLevels.parse(text)
