# SPDX-License-Identifier: Apache-2.0
"""A conversation on the terminal or down a pipe: an utterance a line, and a few slash commands."""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Collection, Generator, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TextIO

from platformdirs import user_state_path
from rich.console import Console, RenderableType
from rich.text import Text

from ..kb.rule import check_speaker
from ..ontology.errors import ValidationError
from .agent import Agent
from .presentation import console as shown
from .presentation.text import printable

QUIT = "/quit"
LAST_WORDS = {QUIT, "/exit", "quit", "exit"}  # none of the three others is an utterance
SPEAKER = "/speaker"
HISTORY_LENGTH = 1000  # lines
_DELIMITERS = " \t\n,.;:!?\"'"


def run(agent: Agent, out: Console, source: TextIO, speaker: str) -> None:
    """Talk until the lines end or `/quit` is said.

    Args:
        agent: who listens.
        out: where the conversation is shown.
        source: what is said; prompted for when it is a terminal.
        speaker: who says it at first.
    """
    chat = Chat(agent, out, speaker, talking=source.isatty())
    if chat.talking:
        out.print(Text(f"I am Hilt. {_help()}", "dim"))
    said = read_lines(lambda: f"{chat.speaker}> ", chat.completable) if chat.talking else source
    for line in (line.removeprefix("\ufeff").strip() for line in said):
        if line in LAST_WORDS:
            return
        if line:
            chat.take(line)


@dataclass
class Chat:
    """A conversation on a terminal or down a pipe.

    Attributes:
        agent: who listens.
        out: where it is shown.
        speaker: who is speaking now.
        talking: whether a person sees each answer at once.
    """

    agent: Agent
    out: Console
    speaker: str
    talking: bool

    def take(self, line: str) -> None:
        """Show what comes of a line: the answer to an utterance, or the result of a command."""
        name, _, rest = line.partition(" ")
        if not line.startswith("/"):
            self._converse(line)
        elif name == SPEAKER:
            self.out.print(self._turn_to(rest.strip()))
        elif line in _COMMANDS:
            self.out.print(_COMMANDS[line](self.agent))
        else:
            self.out.print(Text(f"There is no {line}. {_help()}"))

    def completable(self) -> set[str]:
        """What the Tab key may make of a beginning."""
        return {*self.agent.dialogue.language.known_words, *_COMMANDS, SPEAKER, QUIT}

    def _converse(self, line: str) -> None:
        try:
            with self.out.status("..."):
                reply = self.agent.hear(line, speaker=self.speaker)
        except KeyboardInterrupt:
            self.agent.reset_body()
            self.out.print(Text("I stopped. The next command finds the table as it was at first."))
            return
        except ValidationError as error:  # what is no text ends no conversation
            self.out.print(Text(str(error)))
            return
        spoken = Text.assemble(("Hilt: ", "bold green"), printable(reply.said))
        self.out.print(spoken if self.talking else shown.turn(reply))
        if reply.hint:
            self.out.print(Text(f'Try: "{reply.hint}"', "dim"))

    def _turn_to(self, speaker: str) -> Text:
        """Let somebody else speak from now on."""
        if not speaker:
            return Text(f"{self.speaker} is speaking. {SPEAKER} NAME lets somebody else speak.")
        try:
            check_speaker(speaker)
        except ValidationError as error:
            return Text(str(error))
        self.speaker = speaker = self.agent.base.match_speaker(speaker)
        trust = self.agent.base.trust(speaker)
        doubt = "" if trust is not None and trust.upper > 0 else ", whom I do not trust yet"
        return Text(f"{speaker} is speaking now{doubt}.")


def _help() -> str:
    return f"Talk to me, or say {', '.join(_COMMANDS)}, {SPEAKER} NAME or {QUIT}."


def _why(agent: Agent) -> RenderableType:
    last = agent.dialogue.last_done
    if last is None or last.achievement is None:
        return Text("I have not done anything yet.")
    return shown.goal_result(last.achievement, agent.quote)


_COMMANDS: Mapping[str, Callable[[Agent], RenderableType]] = {
    "/rules": lambda agent: shown.rules(agent.base.rules()),
    "/why": _why,
    "/scene": lambda agent: Text(", ".join(agent.visible()) or "nothing on the table"),
    "/help": lambda _: Text(_help()),
}


def read_lines(prompt: Callable[[], str], words: Callable[[], Collection[str]]) -> Iterator[str]:
    """What is typed, a line at a time, until the end of input; Ctrl-C drops a line.

    Args:
        prompt: gives what stands before the cursor.
        words: gives the words that can be completed now.
    """
    with _editing(user_state_path("hilt") / "history", words):
        while True:
            try:
                line = input(prompt())
            except EOFError:
                sys.stdout.write("\n")  # the shell's prompt stands on a line of its own
                return
            except KeyboardInterrupt:
                sys.stdout.write("\n")
                continue
            yield line


def completions(start: str, words: Collection[str]) -> list[str]:
    """The words that begin so, sorted; an empty beginning is completed by nothing.

    >>> completions("spo", {"spoon", "spoons", "mug"})
    ['spoon', 'spoons']
    """
    return sorted(word for word in words if start and word.startswith(start.lower()))


@contextlib.contextmanager
def _editing(history: Path, words: Callable[[], Collection[str]]) -> Generator[None]:
    try:
        import readline
    except ImportError:
        yield
        return

    def complete(start: str, number: int) -> str | None:
        found = completions(start, words())
        return found[number] if number < len(found) else None

    with contextlib.suppress(OSError):
        readline.read_history_file(history)
    readline.set_history_length(HISTORY_LENGTH)
    readline.set_completer_delims(_DELIMITERS)
    readline.set_completer(complete)
    readline.parse_and_bind("tab: complete")
    try:
        yield
    finally:
        readline.set_completer(None)
        with contextlib.suppress(OSError):
            history.parent.mkdir(parents=True, exist_ok=True)
            readline.write_history_file(history)
