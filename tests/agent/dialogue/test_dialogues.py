"""Whole conversations, which are data: what each answer has and has not."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
import yaml

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig

MOST_WORDS = 40
SYMBOLS = re.compile(r"λ|\d\.\d|\[\d|\bhilt:|->|=>")


DIALOGUES: dict[str, list[dict[str, object]]] = yaml.safe_load(
    (Path(__file__).parents[1] / "data" / "dialogues.yaml").read_text(encoding="utf-8")
)


def poor_answers(agent: Agent, turns: list[dict[str, object]]) -> list[str]:
    """The turns whose answer lacks something, has what it must not, or is no plain speech."""
    poor: list[str] = []
    for turn in turns:
        said = agent.hear(str(turn["say"]), speaker=str(turn.get("by", "sam"))).said
        if not _fits(said, turn) or SYMBOLS.search(said) or len(said.split()) > MOST_WORDS:
            poor.append(f"{turn['say']} -> {said}")
    return poor


def _fits(said: str, turn: dict[str, object]) -> bool:
    has, lacks = turn.get("has", []), turn.get("not", [])
    assert isinstance(has, list) and isinstance(lacks, list)
    return all(str(each) in said for each in has) and not any(str(each) in said for each in lacks)


@pytest.mark.parametrize("name", DIALOGUES)
def test_conversation_has_no_poor_answer(name: str):
    """Every answer fits, in plain words."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        assert poor_answers(agent, DIALOGUES[name]) == []


@pytest.mark.sim
def test_robot_says_what_it_holds_and_did():
    """With a simulated robot it tells what really happened."""
    with Agent.open("memory:", AgentConfig(scene="objects:mug,spoon", seed=7)) as agent:
        before = agent.hear("what are you holding?").said
        agent.hear("pick up the mug")

        assert before == "I'm not holding anything."
        assert agent.hear("what are you holding?").said == "I'm holding the mug."
        assert agent.hear("what did you just do?").said.startswith("I picked up the mug")
        agent.hear("put it down")
        agent.hear("okay")
        assert agent.hear("what did you just do?").said == "I put the mug down."
