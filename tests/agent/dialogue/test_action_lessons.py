"""Lessons of actions: what is asked, learned as a whole, refused and forgotten."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig

CONFIG = AgentConfig(scene="objects:knife,mug,spoon", simulate=False)
SERVE = "To serve a mug, first pick it up by the handle, then put it down, then point to it."


@pytest.fixture
def agent() -> Iterator[Agent]:
    """An agent without a robot."""
    with Agent.open("memory:", CONFIG) as agent:
        yield agent


def nodes(agent: Agent, command: str) -> list[str]:
    """The nodes that are visited for a command."""
    result = agent.hear(command).result
    return [each.node for each in result.steps] if result else []


def test_a_taught_action_is_a_tree(agent: Agent):
    """Its steps are nodes below it, at which rules and norms hold; a rule for it is used."""
    agent.hear(SERVE)
    agent.hear("To serve a mug, grab it by the handle")

    visited = nodes(agent, "could you serve the mug?")

    assert visited[:4] == [
        "serve", "serve/pickUp", "serve/pickUp/findObject", "serve/pickUp/graspObject"
    ]  # fmt: skip
    agent.hear("never pick up the mug")
    assert agent.hear("serve the mug").ending == "refused"


def test_a_part_that_is_forbidden_is_not_taken(agent: Agent):
    """What was taught for a step does not go before what is denied."""
    agent.hear(SERVE)
    agent.hear("To serve a mug, never grab it by the handle")

    assert agent.hear("serve the mug").said == "I was told not to hold the mug by the handle."


def test_an_unknown_step_is_asked_about_and_nothing_is_stored_half(agent: Agent):
    """The answer teaches the step, then the action; another answer teaches neither."""
    text = "To present a mug, rinse it and then point to it."

    assert agent.hear(text).said == "I don't know how to rinse a mug. How do I do that?"
    agent.hear("never mind")
    assert agent.base.actions() == []

    agent.hear(text)
    taught = agent.hear("pick it up, then put it back")
    assert taught.said.startswith("Now I know how to rinse a mug")
    assert [each.name for each in agent.base.actions()] == ["present", "rinse"]
    assert "present/rinse/putBack/returnObject" in nodes(agent, "present the mug")


@pytest.mark.parametrize(
    "texts",
    [
        ["To polish a mug, polish it and put it down"],
        [SERVE, "To rinse a mug, serve it and lift it", "To serve a mug, rinse it and lift it"],
    ],
)
def test_an_action_that_contains_itself_is_refused(agent: Agent, texts: list[str]):
    """Directly or through another."""
    assert [agent.hear(text).ending for text in texts][-1] == "refused"


def test_a_property_that_is_not_seen_is_asked_about(agent: Agent):
    """It is done after a "yes", and not after a "no"."""
    agent.hear("To dry a mug, pick it up, only if it is empty.")

    assert agent.hear("dry the mug").ending == "asked"
    assert agent.hear("no").said == "I am to do that only if the mug is empty."
    agent.hear("dry the mug")
    assert agent.hear("yes").said == "I would dry the mug."


def test_arguments_go_where_they_belong(agent: Agent):
    """Two objects, none, and one of another kind than was told of."""
    agent.hear("To swap a knife and a spoon, pick up the knife, put it down and pick up the spoon.")
    agent.hear("To tidy up, pick up the mug and put it back.")
    agent.hear(SERVE)

    assert (
        agent.hear("swap the knife and the spoon").said == "I would swap the knife and the spoon."
    )
    assert agent.hear("please tidy up").said == "I would tidy up."
    assert agent.hear("serve the knife").ending == "asked"


def test_a_taught_action_survives_a_restart_and_is_forgotten(tmp_path: Path):
    """By its teacher only; then it is not known any more."""
    with Agent.open(str(tmp_path), CONFIG) as first:
        first.hear(SERVE)
    with Agent.open(str(tmp_path), CONFIG) as second:
        assert "serve" in second.hear("what can you do?").said
        assert SERVE[:-1] in second.hear("how do you serve a mug?").said
        assert second.hear("serve the mug").is_done
        assert second.hear("forget how to serve", speaker="kim").ending == "failed"
        second.hear("forget how to serve")
        assert second.hear("serve the mug").ending == "failed"


def test_a_plan_ends_with_the_first_command_that_fails(agent: Agent):
    """What comes after it is not done."""
    assert nodes(agent, "pick up the mug and then point to the knife")[-1] == "pointTo/pointAt"
    assert "pointTo" not in nodes(agent, "pick up the hammer and then point to the knife")
