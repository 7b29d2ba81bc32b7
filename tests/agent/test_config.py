"""Claims about what an agent can be put into."""

import json
from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.episodes import embodiment_as_json, embodiment_from_json
from hilt.agent.execution.embodiment import Embodiment
from hilt.ontology.errors import DataError, UnknownNameError

ROLLING_PIN = """
objects:
  rolling pin:
    is_a: kitchen utensil
    properties: [wooden, long]
    parts:
      grip: {role: grip, material: wood, colour: "#8a5a33", mass: 0.08, shape: [{cylinder: {radius: 0.012, length: 0.1}, at: [-0.16, 0, 0.03], turn_deg: [0, 90, 0]}]}
      roller: {role: surface, material: wood, colour: "#c99e6c", mass: 0.15, shape: [{cylinder: {radius: 0.03, length: 0.22}, at: [0, 0, 0.03], turn_deg: [0, 90, 0]}]}
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
    made = Embodiment.from_config(AgentConfig(
        scene="objects:rolling pin,nail", seed=4, objects=mine, robot="kuka", vision="learned",
        noise="missed=0.1", gui=True,
    ))  # fmt: skip

    again = embodiment_from_json(json.loads(json.dumps(embodiment_as_json(made))))

    assert (again.scene, again.robot, again.vision) == (made.scene, "kuka", "learned")
    assert again.household.objects == made.household.objects
    assert again.noise_model() == made.noise_model()
    assert not again.gui


def test_changed_file_of_objects_is_refused(mine: Path):
    """Other objects would be another embodiment."""
    kept = embodiment_as_json(Embodiment.from_config(AgentConfig(objects=mine)))

    mine.write_text(ROLLING_PIN.replace("0.15", "0.5"), encoding="utf-8")

    with pytest.raises(DataError, match="changed since"):
        embodiment_from_json(kept)


@pytest.mark.parametrize(
    ("option", "error"),
    [
        ({"robot": "r2d2"}, 'no robot "r2d2".* Known: kuka, panda'),
        ({"vision": "xray"}, 'no source of vision "xray".* Known: learned, learned:FILE, mask'),
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
        Embodiment.from_config(AgentConfig(**option))  # pyright: ignore[reportArgumentType]


def test_configuration_is_read_from_yaml(tmp_path: Path):
    """Keys are the names of the options; files are looked up beside the configuration."""
    path = tmp_path / "agent.yaml"
    path.write_text(
        "scene: table.yaml\nseed: 3\nsimulate: false\nactions: kitchen.yaml\n"
        "overrides: [fusion=dempster]\ncontexts: role:child=0.9\n",
        encoding="utf-8",
    )

    assert AgentConfig.from_yaml(path) == AgentConfig(
        scene=str(tmp_path / "table.yaml"),
        seed=3,
        simulate=False,
        actions=tmp_path / "kitchen.yaml",
        overrides=("fusion=dempster",),
        contexts=("role:child=0.9",),
    )


@pytest.mark.parametrize(
    ("text", "error"),
    [
        ("scene: all\nrobott: kuka", r'agent.yaml:2:1: unknown key "robott" .did you mean "robot'),
        ("seed: high", r'agent.yaml:1:7: expected a whole number, found "high"'),
        ("gui: 1", r"agent.yaml:1:6: expected true or false, found 1"),
        ("contexts: [place:kitchen=2]", r"agent.yaml:1:12: expected KIND:NAME or KIND:NAME=DEGREE"),
    ],
)
def test_wrong_configuration_file_is_refused_with_its_place(tmp_path: Path, text: str, error: str):
    """Unknown keys and wrong values are reported with file, line and column."""
    path = tmp_path / "agent.yaml"
    path.write_text(text, encoding="utf-8")

    with pytest.raises(DataError, match=error):
        AgentConfig.from_yaml(path)


def test_wrong_context_of_a_configuration_is_refused():
    """The kind of a context is told."""
    with pytest.raises(DataError, match="expected KIND:NAME"):
        AgentConfig(contexts=("kitchen",))


def test_embodiment_of_an_earlier_version_is_read():
    """Episodes said "simulated" until version 0.1."""
    kept = embodiment_as_json(Embodiment.from_config(AgentConfig(simulate=False)))
    kept["simulated"] = kept.pop("simulate")

    assert not embodiment_from_json(kept).simulate


def test_own_objects_are_understood_and_decided_about(mine: Path):
    """A word from the file needs no learning: its plural and its parts are known."""
    with Agent.open(
        "memory:", AgentConfig(scene="objects:rolling pin,mug", objects=mine, simulate=False)
    ) as mind:
        learned = mind.hear("Rolling pins are used for flattening")
        mind.hear("To pass a rolling pin, grab it by the roller")
        came = mind.hear("pass me something used for flattening").result

    assert [word.word for word in learned.understanding.new_words] == ["flattening"]
    assert came is not None
    assert came.decision is not None
    assert came.decision.chosen_part == "roller"


def test_eyes_that_miss_everything_find_nothing():
    """Noise also blurs what is seen without a simulator."""
    with Agent.open("memory:", AgentConfig(noise="missed=1", simulate=False)) as mind:
        reply = mind.hear("pass me the knife")

    assert (reply.ending, reply.said) == ("failed", "I don't see a knife.")


@pytest.mark.sim
def test_own_object_is_grasped_by_the_part_that_was_told(mine: Path):
    """The fingers touch the grip of the rolling pin, and it is lifted."""
    with Agent.open(
        "memory:", AgentConfig(scene="objects:rolling pin", objects=mine, seed=3)
    ) as robot:
        robot.hear("To pick up a rolling pin grab it by the grip")
        came = robot.hear("pick up the rolling pin").result

    assert came is not None
    assert came.world.touched == ("grip",)
    assert came.world.lifted_m > 0.1


@pytest.mark.sim
def test_eyes_that_are_not_sure_make_the_robot_ask(mine: Path):
    """A rolling pin is nothing that was learned: it is not taken for anything unasked."""
    with Agent.open(
        "memory:", AgentConfig(scene="objects:rolling pin", objects=mine, vision="learned", seed=1)
    ) as robot:
        taken_for = robot.body.search([f"object:{name}" for name in robot.objects])[0].object
        reply = robot.hear(f"pick up the {taken_for}")

    assert reply.ending == "asked"
    assert "not sure enough that what I see is a" in reply.said
    assert reply.result is not None
    assert not reply.result.world.executed
