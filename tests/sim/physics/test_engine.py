"""The physics engine behind names."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from hilt.ontology.errors import SimulationError, UnknownNameError
from hilt.ontology.objects import load_objects
from hilt.sim import poses
from hilt.sim.models.object_models import object_model
from hilt.sim.physics import pybullet_client
from hilt.sim.physics.engine import GRAVITY, TIME_STEP, PhysicsEngine
from hilt.sim.vision.camera import Camera

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
KNIFE, BLOCK = (object_model(OBJECTS[name]).urdf for name in ("knife", "block"))
ASKEW = poses.pose(poses.rotation_from_rpy(0.3, -0.4, 2.9), (0.1, 0.2, 0.9))
SLIDER = """<robot name="slider"><link name="rail"/>
<link name="cart"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial></link>
<joint name="slide" type="prismatic"><parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="2" effort="30" velocity="0.5"/></joint></robot>"""


@pytest.fixture
def engine() -> Iterator[PhysicsEngine]:
    """An empty world."""
    with PhysicsEngine() as made:
        yield made


@pytest.fixture
def slider(engine: PhysicsEngine, tmp_path: Path) -> PhysicsEngine:
    """A world with a cart on a rail."""
    path = tmp_path / "slider.urdf"
    path.write_text(SLIDER, encoding="utf-8")
    engine.bodies.load("slider", path, fixed=True)
    return engine


def test_body_is_where_it_was_put(engine: PhysicsEngine):
    """The pose of a body is that of its URDF frame, whatever its centre of mass."""
    engine.bodies.load("knife", KNIFE, ASKEW)

    assert engine.bodies.pose("knife") == pytest.approx(ASKEW, abs=1e-6)
    assert engine.bodies.pose("knife", "blade") == pytest.approx(ASKEW, abs=1e-5)


def test_body_falls_as_galilei_says(engine: PhysicsEngine):
    """After a quarter of a second of free fall a body is 0.3 m lower."""
    engine.bodies.load("block", BLOCK, poses.translation(0, 0, 1))

    engine.step(60)

    fallen = 1 - engine.bodies.pose("block")[2, 3]
    assert fallen == pytest.approx(GRAVITY / 2 * (60 * TIME_STEP) ** 2, rel=0.03)


def test_unknown_names_are_told(engine: PhysicsEngine):
    """Asking for what is not there lists what is."""
    engine.bodies.load("knife", KNIFE)

    with pytest.raises(UnknownNameError, match=r'no body "nife".*Did you mean "knife"'):
        engine.bodies.pose("nife")
    with pytest.raises(UnknownNameError, match=r"no link of knife .* Known: blade, handle"):
        engine.bodies.pose("knife", "tip")


def test_two_bodies_of_one_name_are_refused(engine: PhysicsEngine):
    """A name belongs to one body."""
    engine.bodies.load("knife", KNIFE)

    with pytest.raises(SimulationError, match='already is a body "knife"'):
        engine.bodies.load("knife", KNIFE)


def test_worlds_do_not_know_each_other(engine: PhysicsEngine):
    """Two simulators in one process hold different bodies."""
    with PhysicsEngine() as other:
        other.bodies.load("knife", KNIFE)

        assert engine.bodies.names == ()
        assert other.bodies.names == ("knife",)


def test_contact_names_the_other_side(engine: PhysicsEngine):
    """What lies on something touches it, with its weight."""
    engine.bodies.load("block", BLOCK, fixed=True)
    engine.bodies.load("upper", BLOCK, poses.translation(0, 0, 0.0702))

    engine.step(120)

    contacts = engine.bodies.contacts("upper")
    assert {(c.other, c.other_link) for c in contacts} == {("block", "body")}
    assert sum(c.force for c in contacts) == pytest.approx(0.9 * GRAVITY, rel=0.05)


def test_joint_tells_its_effort(slider: PhysicsEngine):
    """The limit of its force is that of its URDF."""
    assert slider.joints.efforts("slider", ["slide"]).tolist() == [30.0]


def test_motor_drives_a_joint(slider: PhysicsEngine):
    """A driven joint reaches its target and stays there."""
    slider.joints.drive_to("slider", ["slide"], [0.2], forces=[30.0])

    slider.step(480)

    assert slider.joints.positions("slider", ["slide"]) == pytest.approx([0.2], abs=1e-3)
    assert slider.joints.states("slider", ["slide"])[1] == pytest.approx([0.0], abs=1e-3)
    assert slider.bodies.pose("slider", "cart")[0, 3] == pytest.approx(0.2, abs=1e-3)


def test_speed_drive_moves_evenly(slider: PhysicsEngine):
    """A joint driven at 0.1 m/s is 0.1 m further after a second."""
    slider.joints.drive_at("slider", "slide", 0.1, force=30.0)

    slider.step(240)

    assert slider.joints.positions("slider", ["slide"]) == pytest.approx([0.1], abs=0.002)


def test_closed_simulator_says_so():
    """Closing twice is allowed; using it afterwards is an error of ours."""
    engine = PhysicsEngine()
    engine.close()
    engine.close()

    with pytest.raises(SimulationError, match="The simulator is closed"):
        engine.step()


def test_missing_file_is_our_error(engine: PhysicsEngine):
    """What PyBullet refuses is told as a simulation error."""
    with pytest.raises(SimulationError, match="PyBullet refuses loadURDF"):
        engine.bodies.load("ghost", Path("/nowhere/ghost.urdf"))


def test_same_steps_give_the_same_world():
    """The physics is deterministic to the last bit."""
    ends: list[np.ndarray] = []
    for _ in range(2):
        with PhysicsEngine() as engine:
            engine.bodies.load("block", BLOCK, fixed=True)
            engine.bodies.load("knife", KNIFE, poses.translation(0, 0, 0.1))
            engine.step(200)
            ends.append(engine.bodies.pose("knife"))

    assert (ends[0] == ends[1]).all()


def test_what_is_unseen_is_only_not_drawn(engine: PhysicsEngine):
    """Inside the block no pixel shows the knife; afterwards the picture is what it was."""
    engine.bodies.load("knife", KNIFE)
    camera = Camera("eye", (0.3, 0.0, 0.4), (0.0, 0.0, 0.0), width=80, height=60)
    before = camera.capture(engine)

    with engine.rendering.hidden(["knife"]):
        unseen = camera.capture(engine)

    after = camera.capture(engine)
    assert before.mask("knife").any()
    assert not unseen.mask("knife").any()
    assert np.array_equal(before.colour, after.colour)


def test_some_links_of_the_unseen_may_be_seen(engine: PhysicsEngine):
    """Only the blade of a knife is drawn; there are two links to be seen of it."""
    engine.bodies.load("knife", KNIFE)
    camera = Camera("eye", (0.3, 0.0, 0.4), (0.0, 0.0, 0.0), width=80, height=60)

    with engine.rendering.hidden(["knife"], but=[("knife", "blade")]):
        view = camera.capture(engine)

    assert view.mask("knife", "blade").any()
    assert not view.mask("knife", "handle").any()
    assert set(engine.rendering.visible_links("knife")) == {"handle", "blade"}


def test_bounds_are_round_the_corners(engine: PhysicsEngine):
    """A block on the floor fills the box that its corners do, to the margin of its hull."""
    engine.bodies.load("block", BLOCK, poses.translation(0.2, 0.0, 0.0), fixed=True)

    low, high = engine.bodies.bounds("block", "body")

    corners = object_model(OBJECTS["block"]).points + np.array([0.2, 0.0, 0.0])
    assert low == pytest.approx(corners.min(axis=0), abs=0.01)
    assert high == pytest.approx(corners.max(axis=0), abs=0.01)


def test_window_without_a_display_is_refused(monkeypatch: pytest.MonkeyPatch):
    """It is one error, where PyBullet would end the process."""
    monkeypatch.setattr(pybullet_client.sys, "platform", "linux")
    monkeypatch.setattr(pybullet_client, "_has_display", lambda: False)

    with pytest.raises(SimulationError, match="no display"):
        PhysicsEngine(gui=True)
