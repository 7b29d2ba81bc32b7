# SPDX-License-Identifier: Apache-2.0
"""Claims about what an agent can be put into."""

import json
from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import Embodiment
from hilt.ontology.errors import DataError, UnknownNameError

ROLLING_PIN = """
objects:
  rolling pin:
    is_a: kitchen utensil
    properties: [wooden, long]
    parts:
      grip: {role: grip, material: wood, colour: "#8a5a33", mass: 0.08, shape: [{cylinder: {radius: 0.012, length: 0.1}, at: [-0.16, 0, 0.03], turn_deg: [0, 90, 0]}]}
      roller: {role: surface, material: wood, colour: "#c99e6c", mass: 0.4, shape: [{cylinder: {radius: 0.03, length: 0.22}, at: [0, 0, 0.03], turn_deg: [0, 90, 0]}]}
    rests:
      flat: {turn_deg: [0, 0, 0]}
"""  # noqa: E501 - as a person would write it


@pytest.fixture
def mine(tmp_path: Path) -> Path:
    """A file with a rolling pin."""
    path = tmp_path / "mine.yaml"
    path.write_text(ROLLING_PIN, encoding="utf-8")
    return path


def test_same_embodiment_is_made_from_what_was_kept(mine: Path):
    """As JSON it goes and comes back whole, but for the window."""
    made = Embodiment.of(
        scene="objects:rolling pin,nail", seed=4, objects=mine, robot="kuka", eyes="learned",
        noise="missed=0.1", gui=True,
    )  # fmt: skip

    again = Embodiment.from_json(json.loads(json.dumps(made.as_json())))

    assert (again.scene, again.robot, again.eyes) == (made.scene, "kuka", "learned")
    assert again.household.objects == made.household.objects
    assert again.errors() == made.errors()
    assert not again.gui


def test_changed_file_of_objects_is_refused(mine: Path):
    """Other objects would be another embodiment."""
    kept = Embodiment.of(objects=mine).as_json()

    mine.write_text(ROLLING_PIN.replace("0.4", "0.5"), encoding="utf-8")

    with pytest.raises(DataError, match="changed since"):
        Embodiment.from_json(kept)


@pytest.mark.parametrize(
    ("option", "error"),
    [
        ({"robot": "r2d2"}, 'no robot "r2d2".* Known: kuka, panda'),
        ({"eyes": "xray"}, 'no source of vision "xray".* Known: learned, learned:FILE, mask'),
        ({"noise": "blind=1"}, "expected one of missed, confused, confidence, depth_m"),
        ({"noise": "missed=2"}, r"missed must be in \[0, 1\], found 2"),
        ({"objects": Path("nowhere.yaml")}, "nowhere.yaml"),
        ({"scene": "objects:sabre"}, 'no object "sabre"'),
    ],
)
def test_wrong_options_are_refused_before_anything_is_made(
    option: dict[str, str | Path], error: str
):
    """What there is instead is told."""
    with pytest.raises((DataError, UnknownNameError), match=error):
        Embodiment.of(**option)  # pyright: ignore[reportArgumentType]


def test_own_objects_are_understood_and_decided_about(mine: Path):
    """A word from the file needs no learning: its plural and its parts are known."""
    with Agent.open(
        "memory:", scene="objects:rolling pin,mug", objects=mine, simulate=False
    ) as mind:
        learned = mind.hear("Rolling pins are used for flattening")
        mind.hear("To pass a rolling pin, grab it by the roller")
        came = mind.hear("pass me something used for flattening").achievement

    assert [word.word for word in learned.understanding.new_words] == ["flattening"]
    assert came is not None
    assert came.decision is not None
    assert came.decision.chosen_part == "roller"


def test_eyes_that_miss_everything_find_nothing():
    """Noise also blurs what is seen without a simulator."""
    with Agent.open("memory:", noise="missed=1", simulate=False) as mind:
        reply = mind.hear("pass me the knife")

    assert (reply.ending, reply.said) == ("failed", "I do not see a knife.")


@pytest.mark.sim
def test_own_object_is_grasped_by_the_part_that_was_told(mine: Path):
    """The fingers touch the grip of the rolling pin, and it is lifted."""
    with Agent.open("memory:", scene="objects:rolling pin", objects=mine, seed=3) as robot:
        robot.hear("To pick up a rolling pin grab it by the grip")
        came = robot.hear("pick up the rolling pin").achievement

    assert came is not None
    assert came.world.touched == ("grip",)
    assert came.world.lifted_m > 0.1


@pytest.mark.sim
def test_eyes_that_are_not_sure_make_the_robot_ask(mine: Path):
    """A rolling pin is nothing that was learned: it is not taken for anything unasked."""
    with Agent.open(
        "memory:", scene="objects:rolling pin", objects=mine, eyes="learned", seed=1
    ) as robot:
        taken_for = robot.body.search([f"object:{name}" for name in robot.objects])[0].object
        reply = robot.hear(f"pick up the {taken_for}")

    assert reply.ending == "asked"
    assert "not sure enough that what I see is a" in reply.said
    assert reply.achievement is not None
    assert not reply.achievement.world.executed
