"""Striking with a held object."""

from __future__ import annotations

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim.body import Body
from hilt.sim.manipulation.striking import find_strike_poses
from hilt.sim.scene.scene import parse_scene

OBJECTS = load_objects()
HAND = np.array([(x, y, -0.06) for x in (-0.04, 0.04) for y in (-0.1, 0.1)])  # [m], grip frame


def box(low: tuple[float, float, float], high: tuple[float, float, float]) -> np.ndarray:
    """Points all over a box between two corners [m]."""
    sides = [np.linspace(a, b, 12) for a, b in zip(low, high, strict=True)]
    return np.stack(np.meshgrid(*sides), axis=-1).reshape(-1, 3)


def test_widest_face_below_the_hand_strikes_best():
    """A block held from above strikes with its underside, right below the grip."""
    block = box((-0.02, -0.02, -0.01), (0.02, 0.02, 0.04))

    best = find_strike_poses(block, HAND)[0]

    assert best.rotation[2, 2] == pytest.approx(-1.0)
    assert best.point == pytest.approx((0.0, 0.0, 0.04), abs=0.004)


def test_face_meets_the_nail():
    """At the pose of a strike the point of the face is where the nail's head is."""
    strike = find_strike_poses(box((-0.02, -0.02, 0.0), (0.02, 0.02, 0.05)), HAND)[0]
    nail = np.array([0.5, 0.1, 0.12])

    world_from_grip = strike.world_from_grip(nail)

    assert world_from_grip[:3, :3] @ strike.point + world_from_grip[:3, 3] == pytest.approx(nail)


def test_object_inside_the_hand_cannot_strike():
    """What does not stand out of the hand has no face to strike with."""
    wide_hand = 4 * HAND * (1, 1, -1)

    assert (
        find_strike_poses(
            box((-0.01, -0.01, -0.01), (0.01, 0.01, 0.01)), np.vstack([HAND, wide_hand])
        )
        == []
    )


@pytest.mark.sim
@pytest.mark.parametrize(("tool", "part"), [("hammer", "handle"), ("shoe", "upper")])
def test_nail_is_driven_in_by_blows(tool: str, part: str):
    """Blow by blow the nail goes deeper, by contact alone, until it is in."""
    with Body(
        parse_scene(f"objects:{tool},nail", seed=2, objects=OBJECTS), OBJECTS, seed=2
    ) as body:
        assert body.grasp(body.search([f"object:{tool}"])[0], part).ok
        assert body.lift().ok
        report = body.move_above(body.search(["object:nail"])[0])
        depths = [report.depth_m]
        while not report.driven and len(depths) < 12:
            assert body.raise_().ok
            report = body.lower()
            depths.append(report.depth_m)

    assert report.driven
    assert np.all(np.diff(depths) > 0)


@pytest.mark.sim
def test_only_mounted_objects_are_struck():
    """A mug is not pounded: the report says why, and nothing moves."""
    with Body(parse_scene("objects:hammer,mug", seed=2, objects=OBJECTS), OBJECTS, seed=2) as body:
        mug = body.search(["object:mug"])[0]
        assert body.move_above(mug).reason == "nothing_held"
        assert body.grasp(body.search(["object:hammer"])[0], "handle").ok

        assert body.move_above(mug).reason == "nothing_to_strike"
