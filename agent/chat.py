"""A conversation on a terminal or through a pipe: an utterance per line, and slash commands.

On a terminal `readline` gives a prompt, a history over sessions, and completion of known words. The
lines are heard in a thread of their own, so that "stop" can be typed while the arm moves.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Callable, Collection, Generator, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor, wait
from dataclasses import dataclass, field
from pathlib import Path
from typing import TextIO

from platformdirs import user_state_path
from rich.console import Console, RenderableType
from rich.text import Text

from ..kb.rule import check_speaker
from ..ontology.errors import ValidationError
from .agent import Agent
from .dialogue.reply import Reply
from .presentation import console as shown
from .presentation.plain_text import printable

QUIT = "/quit"
QUIT_WORDS = {QUIT, "/exit", "quit", "exit"}
SPEAKER = "/speaker"
HISTORY_LENGTH = 1000  # lines
PATIENCE = 1.5  # [s] until the next line can be typed although the last one is not answered
_DELIMITERS = " \t\n,.;:!?\"'"


def run(agent: Agent, out: Console, source: TextIO, speaker: str) -> None:
    """Converse until the lines end or `/quit` is entered."""
    chat = Chat(agent, out, speaker, is_interactive=source.isatty())
    if chat.is_interactive:
        out.print(Text(f"I am Hilt. {_help()}", "dim"))
    said = (
        read_lines(chat.prompt, chat.completable, chat.interrupt) if chat.is_interactive else source
    )
    for line in (line.removeprefix("\ufeff").strip() for line in said):
        if line in QUIT_WORDS:
            break
        if line:
            chat.handle_line(line)
    chat.close()


@dataclass
class Chat:
    """A chat on a terminal or through a pipe: answers each line, and runs slash commands."""

    agent: Agent
    out: Console
    speaker: str
    is_interactive: bool
    _worker: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1))
    _waiting: list[Future[None]] = field(default_factory=list[Future[None]])
    _is_interrupted: bool = False  # by a control whose answer is not there yet
    _is_typing: bool = False  # whether the prompt is shown

    def prompt(self) -> str:
        """Return what stands before the line that is typed now."""
        self._is_typing = True
        return f"{self.speaker}> "

    def handle_line(self, line: str) -> None:
        """Show the answer to an utterance, or the result of a slash command."""
        self._is_typing = False
        name, _, rest = line.partition(" ")
        if not line.startswith("/"):
            self._converse(line)
        elif name == SPEAKER:
            self.out.print(self._set_speaker(rest.strip()))
        elif line in _COMMANDS:
            self._do(lambda: self.out.print(_COMMANDS[line](self.agent)))
        else:
            self.out.print(Text(f"There is no {line}. {_help()}"))

    def completable(self) -> set[str]:
        """Return the words that the Tab key can complete."""
        return {*self.agent.dialogue.language.known_words, *_COMMANDS, SPEAKER, QUIT}

    def interrupt(self) -> None:
        """Stop what is being done, and drop the lines that wait to be heard."""
        self._is_typing = False
        self._drop_waiting()
        if self.agent.is_busy:
            self.agent.interrupt()
        wait(self._waiting)

    def close(self) -> None:
        """Wait for the last answer."""
        wait(self._waiting)
        self._worker.shutdown()

    def _converse(self, line: str) -> None:
        self._waiting = [each for each in self._waiting if not each.done()]
        control = self.agent.dialogue.language.control(line) if self._waiting else None
        if control is None:
            if self.agent.interruption.is_paused:
                self.agent.interrupt()  # what is said in a pause ends the command
            self._do(lambda: self._hear(line))
            return
        if control.control not in {"wait", "continue"}:
            self._drop_waiting()
            self._is_interrupted = True
        self._hear(line)
        self._is_interrupted = False

    def _drop_waiting(self) -> None:
        for each in self._waiting:
            each.cancel()

    def _do(self, work: Callable[[], None]) -> None:
        """Do something in the other thread; return when it is done, or takes long."""
        if not self.is_interactive:
            work()
            return
        done = self._worker.submit(work)
        self._waiting.append(done)
        try:
            with self.out.status("..."):
                wait([done], PATIENCE)
        except KeyboardInterrupt:
            self.interrupt()
        if done.done():
            done.result()
        else:
            done.add_done_callback(lambda _: self._prompt_again())

    def _prompt_again(self) -> None:
        """Show the prompt again below an answer that came while a line was typed."""
        if self._is_typing:
            self.out.print(self.prompt(), end="")

    def _hear(self, line: str) -> None:
        try:
            reply = self.agent.hear(line, speaker=self.speaker)
        except ValidationError as error:  # a text that cannot be stored
            self.out.print(Text(str(error)))
            return
        # What was interrupted is said in the answer to the control.
        if not (reply.is_interrupted and self._is_interrupted):
            self._show(reply)

    def _show(self, reply: Reply) -> None:
        spoken = Text.assemble(("Hilt: ", "bold green"), printable(reply.said))
        self.out.print(spoken if self.is_interactive else shown.turn(reply))

    def _set_speaker(self, speaker: str) -> Text:
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
    if last is None or last.result is None:
        return Text("I have not done anything yet.")
    return shown.goal_result(last.result, agent.quote)


_COMMANDS: Mapping[str, Callable[[Agent], RenderableType]] = {
    "/rules": lambda agent: shown.rules(agent.base.rules()),
    "/why": _why,
    "/scene": lambda agent: Text(", ".join(agent.visible()) or "nothing on the table"),
    "/help": lambda _: Text(_help()),
}


def read_lines(
    prompt: Callable[[], str],
    words: Callable[[], Collection[str]],
    interrupt: Callable[[], None] = lambda: None,
) -> Iterator[str]:
    """Yield the lines that are typed until the end of input; Ctrl-C discards one and interrupts."""
    with _editing(user_state_path("hilt") / "history", words):
        while True:
            try:
                line = input(prompt())
            except EOFError:
                sys.stdout.write("\n")  # the shell's prompt stands on a line of its own
                return
            except KeyboardInterrupt:
                sys.stdout.write("\n")
                interrupt()
                continue
            yield line


def completions(start: str, words: Collection[str]) -> list[str]:
    """Return the words with this prefix, sorted; none for an empty prefix.

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
