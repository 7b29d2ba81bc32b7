"""How an object moved between two views of it is found from its points."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.scene.scene import parse_scene
from hilt.sim.scene.world import World
from hilt.sim.vision.object_detector import MaskDetector
from hilt.sim.vision.percept import Percept
from hilt.sim.vision.registration import motion_between

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
shifts = st.tuples(*[st.floats(-0.008, 0.008)] * 3)
turns = st.tuples(*[st.floats(-0.14, 0.14)] * 3)


@pytest.fixture(scope="module")
def hammer() -> Iterator[tuple[MaskDetector, Percept]]:
    """A detector, and the hammer that it sees on the table."""
    with World.build(parse_scene("objects:hammer", seed=3, objects=OBJECTS), OBJECTS) as world:
        detector = MaskDetector(world)
        yield detector, detector.percepts[0]


def motion(shift: tuple[float, ...], turn: tuple[float, ...], about: poses.Array) -> poses.Array:
    """A turn about a point [rad], then a shift [m]."""
    rotation = poses.rotation_from_rpy(*turn)
    return poses.pose(rotation, about + np.array(shift) - rotation @ about)


@given(shifts, turns)
@settings(max_examples=20, deadline=None, suppress_health_check=[HealthCheck.differing_executors])
def test_points_that_moved_as_one_are_brought_back(
    hammer: tuple[MaskDetector, Percept], shift: tuple[float, ...], turn: tuple[float, ...]
):
    """Shifts up to 8 mm and turns up to 8 degrees along and about each axis are found to 1 mm."""
    seen = hammer[1]
    moved = motion(shift, turn, seen.centre)
    parts = {name: poses.transform(moved, cloud) for name, cloud in seen.parts.items()}

    found = motion_between(seen, Percept("hammer", "hammer", 1.0, parts), np.eye(4))

    assert (
        np.abs(poses.transform(found, seen.cloud) - poses.transform(moved, seen.cloud)).max() < 1e-3
    )


@pytest.mark.parametrize("share", [0.0, 0.02])
def test_another_view_of_a_moved_object_shows_how_it_moved(
    hammer: tuple[MaskDetector, Percept], share: float
):
    """Two of the cameras suffice, also where it was raised and turned, to a millimetre."""
    detector, seen = hammer
    before = detector.world.pose("hammer")
    moved = motion((share, -share, 0.15), (share * 10, 0.0, share * 10), before[:3, 3])
    detector.world.engine.bodies.place("hammer", moved @ before)

    now = detector.look(seen)

    assert now is not None
    found = motion_between(seen, now, poses.translation(0, 0, 0.15))
    gaps = poses.transform(found, seen.cloud) - poses.transform(moved, seen.cloud)
    assert np.linalg.norm(gaps, axis=1).mean() < 1e-3
    detector.world.engine.bodies.place("hammer", before)


def test_roll_of_a_round_rod_stays_as_it_was_guessed():
    """What the points do not determine is left alone."""
    angles, along = np.meshgrid(np.linspace(0, 2 * np.pi, 40), np.linspace(0, 0.2, 60))
    rod = np.stack([along, 0.01 * np.cos(angles), 0.01 * np.sin(angles)], axis=-1).reshape(-1, 3)
    seen = Percept("rod", "rod", 1.0, {"end": rod})
    after = Percept("rod", "rod", 1.0, {"end": rod + np.array([0.0, 0.004, 0.0])})

    found = motion_between(seen, after, np.eye(4))

    assert found[:3, 3] == pytest.approx([0.0, 0.004, 0.0], abs=5e-4)
    assert np.degrees(poses.angle_between(np.eye(3), found[:3, :3])) < 1.0
