"""Kinds that somebody showed: they are known again, in two parts, and no other kind is lost."""

from pathlib import Path

import numpy as np
import pytest

from hilt.ontology.errors import DataError
from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.body import Body
from hilt.sim.scene.scene import parse_scene
from hilt.sim.vision.learned_detector import LearnedDetector
from hilt.sim.vision.shown_kinds import ShownKind, estimated_masses, split_by_width

SCENE = Path(__file__).parents[3] / "examples" / "unknown_thing.yaml"
OBJECTS = load_objects()
MANY = 4000


def plate(length: float, width: float, *, at: float = 0.0) -> np.ndarray:
    """Points of the upper side of a plate along x that begins at `at` (n, 3) [m]."""
    drawn = np.random.default_rng(2).uniform(size=(MANY, 3))
    low, size = np.array((at, -width / 2, 0.0)), np.array((length, width, 0.02))
    return low + drawn * size


@pytest.mark.parametrize("yaw", [0.0, 0.7, 2.5, -1.8])
def test_long_and_wide_pieces_are_found_at_any_turn(yaw: float):
    """Nearly all points of the bar and of the plate at its end are in their piece."""
    turned = poses.pose(poses.rotation_from_rpy(0, 0, yaw), (0.5, 0.1, 0.0))
    bar, end = plate(0.2, 0.02), plate(0.05, 0.1, at=0.2)

    pieces = split_by_width(poses.transform(turned, np.vstack([bar, end])))

    assert set(pieces) == {"long", "wide"}
    assert len(pieces["long"]) == pytest.approx(len(bar), rel=0.05)
    assert len(pieces["wide"]) == pytest.approx(len(end), rel=0.05)


@pytest.mark.parametrize(("first", "second"), [(0.04, 0.04), (0.04, 0.06)])
def test_thing_of_about_one_width_is_whole(first: float, second: float):
    """A step to less than twice the width makes no parts."""
    points = np.vstack([plate(0.15, first), plate(0.1, second, at=0.15)])

    assert set(split_by_width(points)) == {"whole"}


def test_masses_follow_the_sizes():
    """The box of the wide piece here is about two and a half times as large."""
    masses = estimated_masses(np.vstack([plate(0.2, 0.02), plate(0.05, 0.1, at=0.2)]))

    assert masses["wide"] / masses["long"] == pytest.approx(1.25, rel=0.15)
    assert 0.01 < sum(masses.values()) < 0.2


def test_kind_is_the_same_after_it_was_kept():
    """What is written is read again; the parts have their names."""
    views = (np.array([0.12345, -1.0]), np.array([0.0, 2.0]))
    kind = ShownKind("mallet", views, {"long": 0.1, "wide": 0.2}, {"long": "handle"})

    again = ShownKind.from_json("mallet", kind.as_json())

    assert np.allclose(again.views, views, atol=1e-4)
    assert {name: part.mass for name, part in again.kind.parts.items()} == {
        "handle": 0.1,
        "wide": 0.2,
    }


def open_eyes(seed: int) -> Body:
    """A body that sees the scene with the mallet with learned eyes."""
    return Body(
        parse_scene(str(SCENE), seed=seed, objects=OBJECTS), OBJECTS, seed=seed, vision="learned"
    )


def eyes_of(body: Body) -> LearnedDetector:
    """The learned eyes of a body."""
    assert body.eyes is not None
    return body.eyes


@pytest.fixture(scope="module")
def look() -> str:
    """What a mallet looks like, from one showing, with its parts named."""
    with open_eyes(1) as body:
        (thing,) = eyes_of(body).unknown
        kind = eyes_of(body).show("mallet", thing)
    names = {"long": "handle", "wide": "head"}
    return ShownKind("mallet", kind.views, kind.masses, names).as_json()


@pytest.mark.sim
def test_thing_without_a_class_is_unknown_and_all_others_are_not():
    """One of the four things in view is."""
    with open_eyes(2) as body:
        unknown = {percept.name for percept in eyes_of(body).unknown}

        assert len(eyes_of(body).percepts) == 4
        assert len(unknown) == 1
        assert unknown.isdisjoint({"knife", "mug", "hammer"})


@pytest.mark.sim
@pytest.mark.parametrize("seed", range(3, 9))
def test_kind_that_was_shown_is_known_elsewhere(seed: int, look: str):
    """It lies elsewhere and otherwise; all things are seen as what they are, and none as two."""
    with open_eyes(seed) as body:
        eyes_of(body).recall("mallet", look)
        seen = eyes_of(body).percepts
        corners = {
            part: body.world.engine.bodies.bounds("thing", part) for part in ("head", "handle")
        }

    assert sorted(percept.object for percept in seen) == ["hammer", "knife", "mallet", "mug"]
    (mallet,) = (percept for percept in seen if percept.object == "mallet")
    assert mallet.name == "thing"
    for part, (low, high) in corners.items():
        points = mallet.parts[part]
        inside = ((points > low - 0.01) & (points < high + 0.01)).all(axis=1)
        assert inside.mean() > 0.95


@pytest.mark.sim
def test_showing_again_adds_views(look: str):
    """A kind may be shown in several ways to lie; its parts keep their names."""
    with open_eyes(2) as body:
        eyes = eyes_of(body)
        (thing,) = eyes.unknown
        eyes.recall("mallet", look)

        kind = eyes.show("mallet", thing)

    assert len(kind.views) == 10
    assert kind.names == {"long": "handle", "wide": "head"}


def test_unknown_file_that_is_not_there_is_an_error(tmp_path: Path):
    """The error names it."""
    (tmp_path / "scene.yaml").write_text("objects: []\nunknown: none.yaml\n", encoding="utf-8")

    with pytest.raises(DataError, match="none"):
        parse_scene(str(tmp_path / "scene.yaml"), seed=0, objects=OBJECTS)
