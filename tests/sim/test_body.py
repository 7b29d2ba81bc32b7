"""The body acts in the world, and says truly what came of it."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from hilt.ontology.objects import load_objects
from hilt.sim import body as body_module
from hilt.sim import poses
from hilt.sim.body import Body
from hilt.sim.manipulation.hand_motions import MEETING
from hilt.sim.robot.models import find_robot
from hilt.sim.scene.scene import Placement, Scene, parse_scene
from hilt.sim.vision.percept import Percept

pytestmark = pytest.mark.sim

OBJECTS = load_objects()


def body_with(spec: str, *, seed: int) -> Body:
    """A body at a table with these objects."""
    return Body(parse_scene(spec, seed=seed, objects=OBJECTS), OBJECTS, seed=seed)


@pytest.fixture
def knife_body() -> Iterator[Body]:
    """A body that has a knife before it."""
    with body_with("objects:knife", seed=7) as made:
        yield made


def seen(body: Body, name: str) -> Percept:
    """The surest percept of an object."""
    return body.search([f"object:{name}"])[0]


@pytest.mark.parametrize(
    ("name", "part"),
    [("knife", "blade"), ("knife", "handle"), ("mug", "handle"), ("glass", "stem")],
)
def test_thing_is_taken_by_the_part_lifted_and_given(name: str, part: str):
    """The fingers touch the part only; the thing is up, held, and still held where it is given."""
    with body_with(f"objects:{name}", seed=7) as body:
        grasp, lift, given = body.grasp(seen(body, name), part), body.lift(), body.hand_over()
        points = body.world.points(name)

    assert grasp.ok
    assert grasp.touched == lift.touched == given.touched == (part,)
    assert lift.lifted_m >= 0.10
    assert lift.held_s == pytest.approx(1.0)
    assert given.ok
    assert points[:, 2].min() > 0.1


def test_hand_over_turns_the_free_part_to_the_receiver(knife_body: Body):
    """Held by the blade, the handle is nearer to the receiver than the blade is."""
    knife_body.grasp(seen(knife_body, "knife"), "blade")
    knife_body.lift()
    knife_body.hand_over()

    knife = knife_body.search(["object:knife"])[0]

    handle, blade = (knife.parts[part].mean(axis=0) for part in ("handle", "blade"))
    assert handle[0] > blade[0] + 0.03


def test_hand_over_tells_where_the_grip_is(knife_body: Body):
    """The report has the pose of the grip, on the line to the receiver; no other report has one."""
    grasp, lift = knife_body.grasp(seen(knife_body, "knife"), "blade"), knife_body.lift()
    given = knife_body.hand_over()

    stated = poses.pose(Rotation.from_quat(given.at[3:]).as_matrix(), given.at[:3])

    assert stated == pytest.approx(knife_body.robot.world_from_grip, abs=0.01)
    assert stated[:3, 3] == pytest.approx(MEETING, abs=0.125)
    assert grasp.at == lift.at == ()


def test_without_a_part_the_hand_takes_what_holds_best(knife_body: Body):
    """No constraint: some part is touched, and the thing is lifted."""
    grasp = knife_body.grasp(seen(knife_body, "knife"), None)

    assert grasp.ok
    assert set(grasp.touched) <= {"handle", "blade"}
    assert knife_body.lift().ok


def test_put_back_leaves_the_thing_where_it_was(knife_body: Body):
    """Afterwards the knife lies where it lay, and the hand is empty."""
    before = knife_body.world.pose("knife")[:3, 3]
    knife_body.grasp(seen(knife_body, "knife"), "handle")
    knife_body.lift()

    report = knife_body.put_back()
    knife_body.world.settle()

    assert report.ok
    assert knife_body.holding is None
    assert np.linalg.norm(knife_body.world.pose("knife")[:3, 3] - before) < 0.02


def test_pointing_touches_nothing():
    """The hand comes near to the mug, and the mug stays where it is."""
    with body_with("objects:mug,knife", seed=3) as body:
        before = body.world.pose("mug")
        report = body.point_at(seen(body, "mug"))
        tip = body.robot.world_from_grip

        towards = seen(body, "mug").cloud.mean(axis=0) - tip[:3, 3]
        after = body.world.pose("mug")

    assert report.ok
    assert np.allclose(before, after, atol=1e-3)
    assert towards @ tip[:3, 2] / np.linalg.norm(towards) > 0.95


def test_same_seed_gives_the_same_motion_bit_for_bit():
    """Two runs from one seed end in the very same pose."""
    ends = []
    for _ in range(2):
        with body_with("objects:screwdriver", seed=5) as body:
            body.grasp(seen(body, "screwdriver"), "handle")
            body.lift()
            ends.append(body.world.pose("screwdriver"))

    assert np.array_equal(ends[0], ends[1])


def test_thing_that_is_gone_is_not_seen(knife_body: Body):
    """A percept of something that is not there gives a report, not an exception."""
    gone = replace(seen(knife_body, "knife"), name="sword")

    report = knife_body.grasp(gone, "blade")

    assert (report.ok, report.reason) == (False, "nothing_seen")


def test_thing_out_of_reach_is_said_to_be_so():
    """Nothing moves for a knife at the far end of the table."""
    far = Scene((Placement("knife", "knife", (0.95, 0.35), 0.0),), 1)

    with Body(far, OBJECTS, seed=1) as body:
        report = body.grasp(seen(body, "knife"), "handle")

    assert (report.ok, report.reason, report.attempts) == (False, "unreachable", 0)


def test_thing_close_to_the_robot_is_taken():
    """Where the arm is folded up, its way down is also sought from below."""
    near = Scene((Placement("knife", "knife", (0.327, -0.029), 1.7),), 1)

    with Body(near, OBJECTS, seed=1) as body:
        report = body.grasp(seen(body, "knife"), "blade")

    assert (report.ok, report.touched) == (True, ("blade",))


def test_lifting_with_an_empty_hand_is_said_to_be_so(knife_body: Body):
    """Without a grasp there is nothing to lift, give or put back."""
    reports = [knife_body.lift(), knife_body.hand_over(), knife_body.put_back()]

    assert {report.reason for report in reports} == {"nothing_held"}


def test_thing_pulled_out_of_the_hand_is_taken_again(knife_body: Body):
    """What is lost before the lift is noticed, and grasped once more."""
    knife_body.grasp(seen(knife_body, "knife"), "handle")
    knife_body.robot.open(0.07)
    knife_body.robot.advance(72)

    report = knife_body.lift()

    assert report.ok
    assert report.attempts == 2
    assert report.touched == ("handle",)


def test_robot_without_gripper_says_so(monkeypatch: pytest.MonkeyPatch):
    """Its abilities have no grasping, and a grasp is refused."""
    bare = replace(find_robot("panda"), gripper=None)
    monkeypatch.setattr(body_module, "find_robot", lambda name: bare)

    with body_with("objects:knife", seed=7) as body:
        report = body.grasp(seen(body, "knife"), "blade")

        assert "graspObject" not in body.abilities
        assert report.reason == "no_gripper"
