"""What who watches is told of the robot, and shown on the desktop."""

import sys
import webbrowser
from pathlib import Path

import pytest

from hilt.agent import Agent
from hilt.agent.presentation.progress import doing, view


def steps(agent: Agent, command: str) -> list[str]:
    """What is said of each step of a command."""
    told: list[str] = []
    watch = agent.watchers.append
    watch(lambda step: told.append("" if step.action else doing(step, "knife")))
    agent.hear(command)
    return [each for each in told if each]


def test_each_step_is_told(taught: Agent):
    """In words that name the thing, and the part where there is one."""
    assert steps(taught, "pass me something used for cutting") == [
        "looking for something used for cutting",
        "grasping the knife by the blade",
        "lifting the knife",
        "handing over the knife",
    ]


def test_named_thing_is_looked_for_by_its_name(taught: Agent):
    """Also where nothing is known about it."""
    assert steps(taught, "point to the mug")[0] == "looking for the mug"


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """The addresses that the desktop is asked to show."""
    addresses: list[str] = []
    monkeypatch.setattr(webbrowser, "open", addresses.append)
    monkeypatch.setattr(sys, "platform", "linux")
    monkeypatch.delenv("DISPLAY", raising=False)
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    return addresses


def test_file_is_shown_on_a_desktop(opened: list[str], monkeypatch: pytest.MonkeyPatch):
    """By the program that belongs to it."""
    monkeypatch.setenv("DISPLAY", ":0")

    view(Path("a.png"))

    assert opened == [Path("a.png").absolute().as_uri()]


def test_nothing_is_opened_without_a_display(opened: list[str]):
    """On a server, for instance."""
    view(Path("a.png"))

    assert opened == []
