"""What a person sees on the terminal is whole."""

import io
from collections.abc import Callable

import pytest
from rich.console import Console, RenderableType

from hilt.agent.agent import Agent
from hilt.agent.presentation import console

NARROW = 24  # characters

SHOWN: dict[str, Callable[[Agent], RenderableType]] = {
    "turn": lambda agent: console.turn(agent.hear("to pass a knife grab the knife by the blade")),
    "rules": lambda agent: console.rules(agent.base.rules()),
    "history": lambda agent: console.history(tuple(agent.base.history())),
}


def test_what_somebody_said_commands_no_terminal(agent: Agent):
    """Nor what the history of a stranger's base holds."""
    text = io.StringIO()
    reply = agent.hear("hello\x1b[2J\x07 there")
    agent.base.believe("\x1b]0;title\x07", "", "sam", [])

    Console(file=text).print(console.turn(reply), console.history(tuple(agent.base.history())))

    assert "there" in text.getvalue() and "title" in text.getvalue()
    assert not {"\x1b", "\x07"} & {*text.getvalue()}


@pytest.mark.parametrize("name", SHOWN)
@pytest.mark.parametrize("width", [NARROW, 40, 60, 80])
def test_narrow_terminal_wraps_and_cuts_nothing(taught: Agent, name: str, width: int):
    """A cell that does not fit goes on in the next line; no ellipsis takes the place of its end."""
    text = shown(SHOWN[name](taught), width)

    assert "…" not in text
    assert max(map(len, text.splitlines())) <= width


def shown(what: RenderableType, width: int) -> str:
    """What a terminal of this width shows."""
    text = io.StringIO()
    Console(file=text, width=width).print(what)
    return text.getvalue()
