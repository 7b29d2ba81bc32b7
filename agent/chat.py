# SPDX-License-Identifier: Apache-2.0
"""A conversation on the terminal or down a pipe: an utterance a line, and a few slash commands."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TextIO

from rich.console import Console, RenderableType
from rich.text import Text

from . import console as shown
from .agent import Agent
from .prompt import lines

QUIT = "/quit"


def run(agent: Agent, out: Console, source: TextIO, speaker: str) -> None:
    """Talk until the lines end or `/quit` is said.

    Args:
        agent: who listens.
        out: where the conversation is shown.
        source: what is said; prompted for when it is a terminal.
        speaker: who says it.
    """
    talking = source.isatty()
    if talking:
        out.print(Text(f"I am Hilt. {_help()}", "dim"))
    said = lines(f"{speaker}> ", lambda: _completable(agent)) if talking else source
    for line in (line.strip() for line in said):
        if line == QUIT:
            return
        if line.startswith("/"):
            out.print(_command(agent, line))
        elif line:
            _converse(agent, out, line, speaker, talking=talking)


def _completable(agent: Agent) -> set[str]:
    return {*agent.dialogue.language.known_words, *_COMMANDS, QUIT}


def _converse(agent: Agent, out: Console, line: str, speaker: str, *, talking: bool) -> None:
    with out.status("..."):
        reply = agent.hear(line, speaker=speaker)
    out.print(Text.assemble(("Hilt: ", "bold green"), reply.said) if talking else shown.turn(reply))


def _command(agent: Agent, line: str) -> RenderableType:
    if line not in _COMMANDS:
        return Text(f"There is no {line}. {_help()}")
    return _COMMANDS[line](agent)


def _help() -> str:
    return f"Talk to me, or say {', '.join(_COMMANDS)} or {QUIT}."


def _why(agent: Agent) -> RenderableType:
    last = agent.dialogue.last_done
    if last is None or last.achievement is None:
        return Text("I have not done anything yet.")
    return shown.achievement(last.achievement, agent.quote)


_COMMANDS: Mapping[str, Callable[[Agent], RenderableType]] = {
    "/rules": lambda agent: shown.rules(agent.base.rules()),
    "/why": _why,
    "/scene": lambda agent: Text(", ".join(agent.visible()) or "nothing on the table"),
    "/help": lambda agent: Text(_help()),
}
