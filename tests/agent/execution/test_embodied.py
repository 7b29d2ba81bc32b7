"""The running example in the simulated world: what the fingers touch is what was said."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from hilt.agent.agent import Agent
from hilt.agent.cli import main
from hilt.agent.config import AgentConfig
from hilt.agent.execution.outcome import WorldOutcome
from hilt.sim import poses
from hilt.sim.grasping.planner import ACCEPTABLE
from hilt.sim.manipulation.hand_motions import MEETING

pytestmark = pytest.mark.sim

ALONE = "objects:knife"
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


def world(agent: Agent, command: str) -> WorldOutcome:
    """What happened in the world when something was asked for."""
    reply = agent.hear(command)
    assert reply.result is not None, reply.said
    return reply.result.world


@pytest.mark.parametrize(
    ("pick_up", "hand_over"), [("handle", "blade"), ("blade", "handle")], ids=["told", "exchanged"]
)
def test_fingers_touch_the_part_that_was_said(pick_up: str, hand_over: str):
    """With handle and blade exchanged in the sentences the robot does the exchange."""
    with Agent.open("memory:", AgentConfig(scene=ALONE, seed=3)) as agent:
        agent.hear("A knife is used for cutting")
        agent.hear(f"To pickup a knife grab the knife by the {pick_up}")
        agent.hear(f"To pass a knife grab the knife by the {hand_over}")

        passed = world(agent, "pass me something used for cutting")
        picked = world(agent, "pick up the knife")

    assert (passed.touched, picked.touched) == ((hand_over,), (pick_up,))
    assert passed.handed_over
    assert passed.as_json()["handed_over_at"]["position_m"] == pytest.approx(MEETING, abs=0.125)
    assert min(passed.lifted_m, picked.lifted_m) >= 0.10
    assert min(passed.held_s, picked.held_s) >= 1.0
    assert 0 <= passed.as_json()["slip_m"] < 0.01 and passed.as_json()["turn_deg"] < 15
    assert passed.as_json()["score"] > ACCEPTABLE


def test_object_that_turns_in_the_hand_is_not_handed_over(tmp_path: Path):
    """The answer is that it slips, and the world says by how much it turned."""
    (tmp_path / "rod.yaml").write_text(ROD, encoding="utf-8")
    config = AgentConfig(objects=tmp_path / "rod.yaml", scene="objects:rod", seed=2)
    with Agent.open("memory:", config) as agent:
        reply = agent.hear("pass me the rod by the end")

    assert (reply.ending, reply.said) == (
        "failed",
        "I couldn't get a firm hold of the rod: it slips in my hand.",
    )
    assert reply.result is not None
    happened = reply.result.world.as_json()
    assert not happened["handed_over"]
    assert happened["turn_deg"] > 15
    assert [trial.outcome for trial in reply.result.trials] == ["slipped"]


@contextmanager
def covered_knife(*told: str) -> Iterator[Agent]:
    """An agent that was told something, at a table where a spatula lies on a knife."""
    with Agent.open("memory:", AgentConfig(scene="objects:knife,spatula", seed=3)) as agent:
        for sentence in told:
            agent.hear(sentence)
        world = agent.body.world
        world.engine.bodies.place("knife", poses.translation(0.5, 0, 0))
        world.engine.bodies.place("spatula", poses.translation(0.56, 0, 0.03))
        world.settle()
        yield agent


def test_what_is_in_the_way_is_moved_aside_and_said():
    """It is taken as it would be picked up, and the knife handed over by the part that was said."""
    parts: dict[str, str | None] = {}
    with covered_knife("To pick up a spatula grab the spatula by the handle") as agent:
        agent.body.on_plan = lambda name, part, *_: parts.update({name: part})
        reply = agent.hear("pass me the knife by the handle")

    assert reply.said.startswith("I moved the spatula aside first. Here is the knife.")
    assert parts == {"knife": "handle", "spatula": "handle"}
    assert reply.result is not None
    assert reply.as_do_json()["world"]["moved"] == ["spatula"]
    assert (reply.result.world.touched, reply.result.world.handed_over) == (("handle",), True)


@pytest.mark.parametrize(
    "told",
    [
        "never pick up the spatula",
        "don't pick up the spatula",
        "never hold a spatula by the handle",  # and the blade is too wide
    ],
)
def test_what_must_not_be_picked_up_is_not_moved_aside(told: str):
    """The answer says what is in the way, and it lies where it lay."""
    with covered_knife(told) as agent:
        before = agent.body.world.pose("spatula")
        reply = agent.hear("pass me the knife by the handle")
        after = agent.body.world.pose("spatula")

    assert reply.said == (
        "I can't get my fingers around the handle of the knife, because of the spatula."
    )
    assert np.array_equal(before, after)


def test_robot_does_not_move_for_what_it_was_not_told():
    """Without the sentences nothing is touched, and the answer says why."""
    with Agent.open("memory:", AgentConfig(scene=ALONE, seed=3)) as agent:
        reply = agent.hear("pass me something used for cutting")

    assert (reply.ending, reply.said) == (
        "failed",
        "I don't see anything for cutting. What is used for cutting?",
    )
    assert reply.result is not None
    assert reply.result.world == WorldOutcome()


def test_robot_does_not_look_for_a_part_that_is_not_there():
    """It says so, and leaves the thing where it is."""
    with Agent.open("memory:", AgentConfig(scene=ALONE, seed=3)) as agent:
        reply = agent.hear("pass me the knife by the stem")

    assert (reply.ending, reply.said) == ("failed", "A knife has no stem.")
    assert reply.result is not None
    assert not reply.result.world.touched


def test_same_seed_gives_the_same_run():
    """Every number of what happened repeats."""
    runs: list[WorldOutcome] = []
    for _ in range(2):
        with Agent.open("memory:", AgentConfig(scene=ALONE, seed=5)) as agent:
            agent.hear("To pass a knife grab the knife by the blade")
            runs.append(world(agent, "pass me the knife"))

    assert runs[0] == runs[1]


def test_demo_shows_the_example_and_writes_its_pictures(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
):
    """`hilt demo` ends well, tells what happened, and leaves pictures and an animation."""
    with pytest.raises(SystemExit) as ended:
        main(["demo", "--out", str(tmp_path)])
    out = capfd.readouterr().out

    assert ended.value.code == 0
    assert "Here is the knife. I'm holding it by the blade, as you told me." in out
    assert "I picked up the knife by the handle, as you told me." in out
    assert "I don't see anything for rolling." in out
    frames = {}
    for path in tmp_path.iterdir():
        with Image.open(path) as picture:
            frames[path.name] = getattr(picture, "n_frames", 1)
            assert picture.size[0] >= 400
    assert set(frames) == {"before.png", "grasp.png", "hand-over.png", "animation.gif"}
    assert frames["animation.gif"] > 10


def test_nail_is_pounded_with_what_is_used_for_it():
    """Told what pounds, the robot drives the nail in with it, and takes it by its handle."""
    with Agent.open("memory:", AgentConfig(scene="objects:hammer,knife,nail", seed=3)) as agent:
        agent.hear("A hammer is used for pounding")

        reply = agent.hear("pound the nail")

    document = reply.as_do_json()["world"]
    assert (reply.ending, reply.said) == ("done", "I pounded the nail with the hammer.")
    assert isinstance(document, dict)
    assert document["touched"] == ["handle"]
    assert document["nail_depth_mm"] > document["driven_mm"] > 10
