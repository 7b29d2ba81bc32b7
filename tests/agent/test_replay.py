"""Claims about episodes that are run again."""

from __future__ import annotations

import json
from dataclasses import fields, replace
from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.cli import main
from hilt.agent.config import AgentConfig
from hilt.agent.episodes import as_json, from_json, settings_as_choices
from hilt.agent.execution.perception import PerfectVision
from hilt.agent.execution.request import Request
from hilt.agent.replay import find_episode, replay
from hilt.inference.settings import Settings
from hilt.inference.types import Conclusion, Target
from hilt.kb.interval import CERTAIN, Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Atom, norm
from hilt.ontology.errors import HiltError, UnknownNameError

from .conftest import LESSONS

OTHERWISE = "To pass a knife grab the knife by the handle"


@pytest.fixture
def base(taught: Agent) -> KnowledgeBase:
    """A base with an episode, after which something else was told."""
    taught.hear("pass me something used for cutting")
    taught.hear(OTHERWISE)
    return taught.base


@pytest.mark.parametrize(
    ("part", "target"),
    [
        (None, Target("knife", used_for="cutting", properties=frozenset({"red"}))),
        ("blade", Target(affords=Conclusion("cutWith", Atom("object", "bread")))),
        (None, Target(affords=Conclusion("cutWith"), not_used_for="poking", is_confirmed=True)),
    ],
)
def test_request_comes_back_whole(part: str | None, target: Target):
    """Nothing of what a speaker asked for is lost on the way through JSON."""
    request = Request(
        "pass", {"object": target, "recipient": "anna"}, "sam", part,
        {Atom("place", "kitchen"): Interval(0.5, 1)}, frozenset({"object"}),
        momentary=(norm("forbidden", "pass", "knife", Atom("part", "blade"), interval=CERTAIN),),
        unheeded=frozenset({"rule/3f9c"}),
    )  # fmt: skip

    kept = json.loads(json.dumps(as_json(request)))

    assert from_json(Request, kept) == request
    assert {each.name for each in fields(Request)} == kept.keys()
    assert {each.name for each in fields(Target)} == kept["arguments"]["object"].keys()


def test_settings_come_back_from_their_choices():
    """Thresholds and operators are kept as a command line would name them."""
    settings = Settings.load().with_choices(["fusion=dempster", "threshold.pass=0.25"])

    assert Settings().with_choices(settings_as_choices(settings)) == settings


def test_episode_comes_out_the_same_with_the_rules_of_then(base: KnowledgeBase):
    """What was told since does not count."""
    replayed = replay(base, "last")

    assert replayed.differences == ()
    assert replayed.result.decision is not None
    assert replayed.result.decision.chosen_part == "blade"


def test_episode_after_a_yes_comes_out_the_same():
    """What was asked back and confirmed is part of the request, and settings are kept."""
    careful = Settings.load().with_choices(["threshold=0.9"])
    with Agent.open("memory:", AgentConfig(settings=careful, simulate=False)) as agent:
        agent.hear("A knife is used for cutting")
        asked = agent.hear("pass me something used for cutting")
        done = agent.hear("yes")

        replayed = replay(agent.base, "last")

    assert (asked.ending, done.ending, replayed.differences) == ("asked", "done", ())


def test_episode_of_a_robot_that_induces_comes_out_the_same():
    """Only the rules of then are induced from, not what was told since."""
    with Agent.open("memory:", AgentConfig(simulate=False, induce=True)) as agent:
        agent.hear("To pass a knife grab the knife by the blade")
        done = agent.hear("pass me the screwdriver")
        agent.hear("To pass a screwdriver grab the screwdriver by the handle")

        replayed = replay(agent.base, "last")

    assert done.result is not None and done.result.decision is not None
    assert (done.result.decision.chosen_part, replayed.differences) == ("shaft", ())


def test_other_outcome_is_told(base: KnowledgeBase):
    """Each number that replayed out otherwise is listed with both values."""
    episode = next(base.episodes())
    document = json.loads(episode.document)
    document["decision"]["lower"] = 0.5
    base.record_episode(replace(episode, document=json.dumps(document)))

    replayed = replay(base, "last")

    assert replayed.differences == ("decision.lower: 0.5, now 0.95",)
    assert not replayed.as_json()["same"]


def test_episode_of_other_eyes_is_not_run_again():
    """Nobody knows what they would see now."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as plain:
        eyes = PerfectVision(plain.scene, plain.objects)
    with Agent.open("memory:", vision=eyes) as agent:
        agent.hear("pass me the knife")

        with pytest.raises(HiltError, match="used vision or motion other than Hilt's own"):
            replay(agent.base, "last")


def test_episode_is_found_by_the_start_of_its_id(base: KnowledgeBase):
    """A start that several have is refused, as is one that none has; they are listed."""
    episode = next(base.episodes())
    other = base.record_episode(replace(episode, document="{}"))
    both = list(base.episodes())

    assert find_episode(both, episode.id[:-1]) == episode
    with pytest.raises(UnknownNameError, match=f"Known: {min(episode.id, other.id)}"):
        find_episode(both, "nine")
    with pytest.raises(HiltError, match='2 episodes begin with "", among'):
        find_episode(both, "")


def test_commands_list_and_replay(tmp_path: Path, capfd: pytest.CaptureFixture[str]):
    """`hilt episodes --json` has the documents, and `hilt replay` exits with 0 for the same."""
    with Agent.open(str(tmp_path / "kb"), AgentConfig(simulate=False)) as mind:
        for sentence in (*LESSONS, "pass me something used for cutting"):
            mind.hear(sentence)
    found: list[object] = []
    for arguments in (["episodes"], ["replay", "last"], ["replay", "x"]):
        with pytest.raises(SystemExit) as ended:
            main([*arguments, "--kb", str(tmp_path / "kb"), "--json"])
        said = capfd.readouterr()
        found.append((ended.value.code, json.loads(said.out) if said.out else said.err))

    (_, [episode]), (_, again), missing = found  # pyright: ignore
    assert (episode["outcome"], episode["decision"]["part"]) == ("done", "blade")
    assert (again["episode"], again["same"]) == (episode["id"], True)
    assert missing[0] == 1
    assert "There is no episode" in missing[1]


@pytest.mark.sim
def test_trajectory_of_each_command_is_kept_and_exported(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
):
    """The second goes on where the first ended; what nothing moved for has none, and says so."""
    config = AgentConfig(scene="objects:knife", seed=5)
    with Agent.open(str(tmp_path / "kb"), config) as agent:
        for command in ("point to the knife", "pick up the knife", "pass me the mug"):
            agent.hear(command)
    ids = [each.id for each in KnowledgeBase.open(tmp_path / "kb").episodes()]
    found: list[object] = []
    for name in ("1", ids[1]):
        with pytest.raises(SystemExit):
            main(["--kb", str(tmp_path / "kb"), "episodes", "trajectory", name])
        found.append([line.split(",") for line in capfd.readouterr().out.splitlines()])
    with pytest.raises(SystemExit) as ended:
        main(["episodes", "--kb", str(tmp_path / "kb"), "trajectory", "last"])

    first, second = found  # pyright: ignore
    assert first[0][:2] == ["time_s", "panda_joint1"]
    assert first[-1] == second[1]  # where the first ended, the second began
    assert len(second) > 100
    assert ended.value.code == 1
    assert f"{ids[2]} has no trajectory" in capfd.readouterr().err


@pytest.mark.sim
def test_second_command_of_a_conversation_is_run_again_bit_for_bit():
    """What the first one moved is moved first; noise and learned eyes come again too."""
    with Agent.open(
        "memory:",
        AgentConfig(scene="objects:knife", seed=5, vision="learned", noise="depth_m=0.001"),
    ) as agent:
        agent.hear("To pass a knife grab the knife by the blade")
        agent.hear("pass me the knife")
        agent.hear("pick up the knife")
        agent.hear(OTHERWISE)

        replayed = replay(agent.base, "last")

    assert replayed.differences == ()
    assert replayed.recorded["state"]
    assert replayed.result.world.executed
