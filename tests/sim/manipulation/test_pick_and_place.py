"""Impossible grasps are reported without trying; lost objects are grasped again."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hilt.ontology.objects import load_household, load_objects
from hilt.sim import poses
from hilt.sim.body import VISIONS, Body
from hilt.sim.grasping.planner import MAX_ATTEMPTS
from hilt.sim.manipulation import hand_motions
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.robot.robot import NAME
from hilt.sim.scene.scene import Placement, Scene, parse_scene
from hilt.sim.vision.camera import Camera, CameraImage
from hilt.sim.vision.percept import Percept
from tests.sim.contacts import finger_contacts

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
INVERTED = Placement("mug", "mug", (0.5, 0.0), 0.0, "upside down")
ROD = """
objects:
  rod:
    is_a: tool
    parts:
      end: {role: grip, material: steel, colour: "#8a8a8a", mass: 0.05,
            shape: [{box: {size: [0.04, 0.02, 0.02]}, at: [0.02, 0, 0.01]}]}
      weight: {role: surface, material: steel, colour: "#333333", mass: 0.45,
               shape: [{box: {size: [0.26, 0.02, 0.02]}, at: [0.17, 0, 0.01]}]}
    rests:
      flat: {turn_deg: [0, 0, 0]}
"""
BETWEEN = (
    Placement("knife", "knife", (0.45, 0.008), 0.0),
    Placement("shoe", "shoe", (0.38, 0.072), 0.0, "upright"),
    Placement("shoe 2", "shoe", (0.38, -0.072), 0.0, "upright"),
)
BESIDE = (
    Placement("knife", "knife", (0.46, -0.27), 2.9),
    Placement("screwdriver", "screwdriver", (0.53, -0.35), 2.7),
    Placement("mug", "mug", (0.37, -0.35), -2.5),
)


SIDE_BY_SIDE = (
    Placement("knife", "knife", (0.5, 0.0), 0.0),
    Placement("spatula", "spatula", (0.5, 0.3), 0.0),
)


def covered_body() -> Body:
    """A body at a table where a spatula lies on a knife."""
    body = body_at(*SIDE_BY_SIDE)
    body.world.engine.bodies.place("spatula", poses.translation(0.56, 0.0, 0.03))
    body.world.settle()
    return body


def body_at(*placements: Placement, robot: str = "panda") -> Body:
    """A body at a table with objects close to each other."""
    return Body(Scene(placements, 1, gap=0.002), OBJECTS, seed=1, robot=robot)


def body_with(spec: str, *, seed: int, vision: str = "mask") -> Body:
    """A body at a table with these objects."""
    scene = parse_scene(spec, seed=seed, objects=OBJECTS)
    return Body(scene, OBJECTS, seed=seed, vision=vision)


def grasped(body: Body, name: str, part: str) -> MotionReport:
    """The report of grasping a visible object by a part."""
    return body.grasp(body.search([f"object:{name}"])[0], part)


@pytest.mark.parametrize(
    ("placements", "part", "reason"),
    [
        ((INVERTED,), "barrel", "too_wide"),
        (BETWEEN, "handle", "blocked"),
        (BESIDE, "blade", "blocked"),
    ],
    ids=[
        "barrel of an inverted mug",
        "handle between two shoes",
        "blade between mug and screwdriver",
    ],
)
def test_impossible_grasp_is_not_tried(placements: tuple[Placement, ...], part: str, reason: str):
    """The report has the reason, the gripper has not closed, and no time has passed."""
    with body_at(*placements) as body:
        before = body.world.time

        report = grasped(body, placements[0].name, part)

        assert (report.ok, report.reason, report.attempts) == (False, reason, 0)
        assert body.world.time == before
        assert body.holding is None


def test_thing_in_the_way_is_put_aside():
    """The spatula is laid on the table, nothing else is touched, and the knife is handed over."""
    with covered_body() as body:
        body.movable = lambda _: (None,)

        report = grasped(body, "knife", "handle")
        low = body.world.points("spatula")[:, 2].min()

        assert (report.ok, report.touched, report.attempts) == (True, ("handle",), 1)
        assert report.moved == ("spatula",)
        assert low < 0.005
        assert body.lift().ok
        assert body.hand_over().ok


def test_thing_in_the_way_that_must_stay_is_named():
    """It lies where it lay, no time has passed, and the report says what is in the way."""
    asked: list[str] = []

    def movable(other: Percept) -> tuple[str, ...]:
        asked.append(other.name)
        return ()

    with covered_body() as body:
        body.movable, before = movable, body.world.time

        report = grasped(body, "knife", "handle")

        assert (report.reason, report.moved, report.barred_by) == ("blocked", (), ("spatula",))
        assert (body.world.time, asked) == (before, ["spatula"])


def test_thing_is_put_aside_by_the_part_that_is_allowed():
    """The spatula is taken by its handle only, and the same seed gives the same run."""
    runs: list[tuple[str, list[str]]] = []
    for _ in range(2):
        with covered_body() as body:
            planned: list[str] = []
            body.on_plan = lambda name, part, *_, to=planned: to.append(f"{name} {part}")
            body.movable = lambda _: ("handle",)
            assert grasped(body, "knife", "handle").ok
            runs.append((body.state_hash(), planned))

    assert runs[0] == runs[1]
    assert set(runs[0][1]) == {"knife handle", "spatula handle"}


@pytest.mark.parametrize("at", [(1.0, 0.1), (0.9, 0.6), (-0.4, 0.2)])
def test_distant_object_is_reported_as_unreachable(at: tuple[float, float]):
    """The reason is the distance, however little of the object is visible."""
    with body_at(Placement("mug", "mug", at, 0.3)) as body:
        before = body.world.time

        report = grasped(body, "mug", "handle")

        assert (report.ok, report.reason, report.attempts) == (False, "unreachable", 0)
        assert body.world.time == before


def test_other_part_of_the_inverted_mug_is_grasped():
    """The handle is grasped although the barrel is too wide."""
    with body_at(INVERTED) as body:
        report = grasped(body, "mug", "handle")

    assert report.ok
    assert report.touched == ("handle",)


def test_object_that_always_slips_is_given_up():
    """Without friction every attempt fails and is reported, and the hand is empty afterwards."""
    with body_with("objects:screwdriver", seed=3) as body:
        for finger in body.robot.gripper.links:
            body.world.engine.bodies.set_friction(NAME, finger, lateral=0.0, spinning=0.0)

        report = grasped(body, "screwdriver", "handle")
        if report.ok:
            report = body.lift()

        assert not report.ok
        assert report.reason in {"slipped", "dropped", "missed", "no_grasp", "unreachable"}
        assert 1 <= len(report.failures) == report.attempts <= MAX_ATTEMPTS
        assert body.holding is None


def test_fragile_object_is_not_pressed_hard():
    """The fingers press on a glass with 25 N, on a knife with all they have."""
    pressed: dict[str, float] = {}
    for name, part in (("glass", "stem"), ("knife", "handle")):
        with body_with(f"objects:{name}", seed=3) as body:
            assert grasped(body, name, part).ok
            finger = body.world.engine.bodies.contacts(NAME, body.robot.gripper.links[0])
            pressed[name] = sum(contact.force for contact in finger if contact.other == name)

    assert pressed == {"glass": pytest.approx(25, rel=0.3), "knife": pytest.approx(65, rel=0.3)}


def test_object_that_turns_in_the_hand_is_not_held(tmp_path: Path):
    """A heavy rod held by its end turns by more than 15 degrees; it is laid back where it was."""
    (tmp_path / "rod.yaml").write_text(ROD, encoding="utf-8")
    objects = load_household(tmp_path / "rod.yaml", added_to=load_household()).objects
    scene = parse_scene("objects:rod", seed=2, objects=objects)
    with Body(scene, objects, seed=2) as body:
        before = body.world.pose("rod")
        assert grasped(body, "rod", "end").ok

        report = body.lift()

        assert (report.ok, report.reason, report.touched) == (False, "slipped", ("end",))
        assert np.degrees(report.slip_rad) > 15
        assert body.holding is None
        assert np.linalg.norm((body.world.pose("rod") - before)[:3, 3]) < 0.01


@pytest.mark.parametrize("vision", VISIONS)
def test_object_that_slid_in_the_hand_is_grasped_again(vision: str):
    """A knife that was shifted by 3 cm between the fingers is put down, and taken once more."""
    with body_with("objects:knife", seed=7, vision=vision) as body:
        assert grasped(body, "knife", "handle").ok
        assert body.lift().ok
        along = poses.translation(0.03, 0, 0)
        body.world.engine.bodies.place("knife", body.world.pose("knife") @ along)

        report = body.hand_over()

        assert (report.ok, report.attempts, report.failures) == (True, 2, ("slipped",))
        assert report.slip_m < 0.01


def test_object_lost_on_the_way_is_grasped_again_and_handed_over():
    """The knife is put back on the table while it is carried; it arrives at the second attempt."""
    with body_with("objects:knife", seed=7) as body:
        where = body.world.pose("knife")
        assert grasped(body, "knife", "handle").ok
        assert body.lift().ok
        body.world.engine.bodies.place("knife", poses.translation(0, 0, 0.002) @ where)

        report = body.hand_over()

        assert report.ok
        assert (report.attempts, report.failures) == (2, ("dropped",))
        assert report.touched == ("handle",)
        assert body.world.points("knife")[:, 2].min() > 0.1


@pytest.mark.parametrize(
    ("name", "part", "seed"),
    [
        ("knife", "blade", 7),
        ("hammer", "handle", 7),
        ("mug", "barrel", 7),
        ("hammer", "head", 64004),
        ("shoe", "upper", 64002),
        ("spoon", "handle", 64000),
        ("glass", "stem", 64005),
    ],
)
def test_receiver_takes_what_is_offered(name: str, part: str, seed: int):
    """The free part faces the receiver; the hand opens as it is pulled at, and goes home empty.

    No link but the fingers touches anything meanwhile.
    """
    with body_with(f"objects:{name}", seed=seed) as body:
        contacts, touched = body.world.engine.bodies.contacts, set[str]()

        def look() -> None:
            for link in {*body.robot.chain.links} - {*body.robot.gripper.links}:
                touched.update(link for each in contacts(NAME, link) if each.other != NAME)

        body.world.engine.watchers.append(look)
        assert grasped(body, name, part).ok and body.lift().ok
        offered = body.hand_over()
        before = body.world.pose(name)[0, 3]

        report = body.release()

        assert (report.ok, report.taken, body.holding) == (True, True, None)
        assert body.world.pose(name)[0, 3] > before + 0.3
        assert body.world.points(name)[:, 2].min() > 0.1
        assert not body.robot.is_touching()
        assert not touched
    assert np.degrees(offered.facing_rad or 0.0) < 45
    assert offered.clearance_m is not None and offered.clearance_m > -0.002


def test_what_nobody_pulls_at_is_kept(monkeypatch: pytest.MonkeyPatch):
    """A force of 2 N is no pull: the hand stays closed, and says why."""
    monkeypatch.setattr(hand_motions, "PULL", 2.0)
    with body_with("objects:knife", seed=7) as body:
        assert grasped(body, "knife", "blade").ok and body.lift().ok and body.hand_over().ok

        report = body.release()

        assert (report.ok, report.reason, report.taken) == (False, "not_taken", False)
        assert body.holding == "knife"
        assert all(finger_contacts(body.robot))


def test_object_that_is_held_by_the_part_already_is_kept():
    """No second grasp is made; by another part it is put back and grasped again."""
    with body_with("objects:knife", seed=7) as body:
        assert grasped(body, "knife", "blade").ok
        assert body.lift().ok
        before = body.world.time
        (held,) = body.search(["object:knife"])

        again = body.grasp(held, "blade")
        kept = body.world.time == before
        other = body.grasp(held, "handle")

    assert (again.ok, again.attempts, again.touched, kept) == (True, 0, ("blade",), True)
    assert (other.ok, other.touched) == (True, ("handle",))


def test_run_that_is_not_recorded_renders_only_what_vision_needs(monkeypatch: pytest.MonkeyPatch):
    """One image of each of four cameras without the waiting robot, and two looks at the hand.

    Each look takes images of two cameras, first without the robot, then with what may hide things.
    """
    drawn: list[CameraImage] = []
    capture = Camera.capture

    def counted(*args: Any, **options: Any) -> CameraImage:
        view = capture(*args, **options)
        drawn.append(view)
        return view

    monkeypatch.setattr(Camera, "capture", counted)

    with body_with("objects:spatula", seed=4) as body:
        assert grasped(body, "spatula", "handle").ok
        assert body.lift().ok
        assert body.hand_over().ok

    assert len(drawn) == 4 + 2 * 2 * 2
    assert not any(view.mask(NAME).any() for view in drawn[:4])


def test_second_robot_grasps_by_the_part():
    """The KUKA arm with its hand takes the blade, and gives the handle."""
    scene = parse_scene("objects:knife", seed=9, objects=OBJECTS)
    with Body(scene, OBJECTS, seed=9, robot="kuka") as body:
        assert grasped(body, "knife", "blade").ok
        assert body.lift().ok
        report = body.hand_over()
        handle, blade = (
            body.search(["object:knife"])[0].parts[part].mean(axis=0)
            for part in ("handle", "blade")
        )

    assert report.ok
    assert report.touched == ("blade",)
    assert handle[0] > blade[0]


def test_object_put_back_lies_still():
    """A mug that was put back stands where it stood, upright."""
    with body_with("objects:mug", seed=6) as body:
        before = body.world.pose("mug")
        assert grasped(body, "mug", "handle").ok
        assert body.lift().ok
        assert body.put_back().ok
        body.world.settle()
        after = body.world.pose("mug")

    assert np.linalg.norm(after[:3, 3] - before[:3, 3]) < 0.01
    assert after[2, 2] == pytest.approx(before[2, 2], abs=0.02)
