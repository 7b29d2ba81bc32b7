"""Agents that decide without a robot, over a base in memory."""

from collections.abc import Iterator

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig

LESSONS = (
    "A knife is used for cutting",
    "To pickup a knife grab the knife by the handle",
    "To pass a knife grab the knife by the blade",
)


@pytest.fixture
def agent() -> Iterator[Agent]:
    """A mind that was taught nothing, with all eight objects in view."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as mind:
        yield mind


@pytest.fixture
def taught(agent: Agent) -> Agent:
    """A mind that was taught the three sentences of the paper's running example."""
    for sentence in LESSONS:
        agent.hear(sentence)
    return agent
