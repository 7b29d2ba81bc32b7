"""A conversation on a terminal or through a pipe: an utterance per line, and slash commands.

On a terminal the lines are heard in a thread of their own, so that "stop" can be typed while the
arm moves. The first conversation with a base makes its speaker the owner, who is trusted.
"""

from __future__ import annotations

import os
import re
import sys
import webbrowser
from collections.abc import Callable, Collection, Iterator, Mapping
from concurrent.futures import Future, ThreadPoolExecutor, wait
from contextlib import nullcontext
from dataclasses import dataclass, field
from functools import partial
from itertools import count
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, TextIO

from platformdirs import user_state_path
from prompt_toolkit import PromptSession, prompt
from prompt_toolkit.completion import WordCompleter
from prompt_toolkit.history import FileHistory, History, InMemoryHistory
from prompt_toolkit.patch_stdout import patch_stdout
from prompt_toolkit.shortcuts import CompleteStyle
from rich.console import Console, Group, RenderableType
from rich.text import Text

from ..inference.node_rules import FIND
from ..kb.rule import DEFAULT_SPEAKER, check_speaker
from ..nlu.generation.templates import proper_name
from ..ontology.errors import HiltError
from .agent import Agent
from .execution.outcome import WalkStep
from .presentation import console as shown
from .presentation.plain_text import printable

if TYPE_CHECKING:
    from .speech.listening import Heard
    from .speech.talk import Talk

QUIT = "/quit"
QUIT_WORDS = {QUIT, "/exit", "quit", "exit"}
PATIENCE = 1.5  # [s] until the next line can be typed although the last one is not answered
MEDIA = Path("out/chat")  # where pictures and films go that get no name
EXAMPLES = (  # what it is for, and what is said
    ("teach", "A knife is used for cutting", "To pass a knife, grab it by the blade"),
    ("have something done", "Pass me something used for cutting", "Pick up the mug"),
    ("ask", "What is a knife used for?", "Why?", "What can you do?"),
    ("correct", "No, by the handle", "Forget that"),
    ("interrupt", "Stop", "Wait", "Go on", "Put it down"),
    ("introduce somebody", "My name is Anna", "You can trust Anna"),
)
_NO_ROBOT = Text("There is no robot to be seen: this chat was started with --no-sim.")
_WORD = re.compile(r"[^\s,.;:!?\"']+")
_TRUST = re.compile(r"(.+?)((?: +\d*\.?\d+){0,2})")


def run(
    agent: Agent, out: Console, source: TextIO, speaker: str | None = None, talk: Talk | None = None
) -> None:
    """Converse until the lines, or the sounds of a talk, end or `/quit` is entered.

    Without a speaker it is the owner of the base; who that is, is asked on a terminal.
    """
    is_interactive = source.isatty()
    if is_interactive:
        out.print(Text("I am Hilt. Talk to me, or say /help.", "dim"))
    try:
        speaker = _first_speaker(agent, speaker, out if is_interactive else None)
    except (EOFError, KeyboardInterrupt):
        out.print()
        return  # who it is, was not told
    chat = Chat(agent, out, speaker, talk.is_live if talk else is_interactive, talk)
    if talk:
        chat.listen(talk)
        return
    said = read_lines(chat.prompt, chat.completable, chat.interrupt) if is_interactive else source
    for line in (line.removeprefix("\ufeff").strip() for line in said):
        if line in QUIT_WORDS:
            break
        if line:
            chat.handle_line(line)
    chat.close()


def read_lines(
    prompt: Callable[[], str],
    words: Callable[[], Collection[str]],
    interrupt: Callable[[], None] = lambda: None,
) -> Iterator[str]:
    """Yield the lines that are typed until the end of input; Ctrl-C discards one and interrupts.

    What is printed meanwhile, in any thread, stands above the line that is being typed.
    """
    session = PromptSession[str](
        history=_history(),
        completer=WordCompleter(lambda: sorted(words()), ignore_case=True, pattern=_WORD),
        complete_style=CompleteStyle.READLINE_LIKE,
        complete_while_typing=False,
    )
    while True:
        try:
            with patch_stdout(raw=True):
                line = session.prompt(prompt())
        except EOFError:
            return
        except KeyboardInterrupt:
            interrupt()
        else:
            yield line


def _history() -> History:
    file = user_state_path("hilt") / "history"
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        file.touch()
    except OSError:
        return InMemoryHistory()
    return FileHistory(file)


def _first_speaker(agent: Agent, name: str | None, out: Console | None) -> str:
    conversation = agent.dialogue.conversation
    if (owner := conversation.people.owner) is None:
        owner = name or (_ask_name(agent, out) if out else DEFAULT_SPEAKER)
        owner = agent.base.match_speaker(owner)
        if not conversation.people.trusts(owner):
            conversation.trust(owner, by=owner)
    return agent.base.match_speaker(name or owner)


def _ask_name(agent: Agent, out: Console) -> str:
    account = proper_name(os.environ.get("USER", DEFAULT_SPEAKER))
    while True:
        said = prompt(f"What is your name? [{account}] ").strip()
        introduced = agent.dialogue.conversation.language.introduction(said)
        name = proper_name(introduced.name) if introduced else said or account
        try:
            check_speaker(name)
        except HiltError as error:
            out.print(Text(str(error)))
        else:
            out.print(Text(f"Hello {proper_name(name)}. I will believe what you tell me.", "dim"))
            return name


@dataclass
class Chat:
    """A chat on a terminal or through a pipe: answers each line, and runs slash commands."""

    agent: Agent
    out: Console
    speaker: str
    is_interactive: bool
    talk: Talk | None = None  # what it hears and speaks with
    _worker: ThreadPoolExecutor = field(default_factory=lambda: ThreadPoolExecutor(1))
    _waiting: list[Future[None]] = field(default_factory=list[Future[None]])
    _is_interrupted: bool = False  # by a control whose answer is not there yet
    film: Path | None = None  # of what is done next
    _found: str = ""  # the object that is acted on

    def prompt(self) -> str:
        """Return what stands before the line that is typed now."""
        people = self.agent.dialogue.conversation.people
        return f"{people.called(people.speaker(self.speaker))}> "

    def handle_line(self, line: str) -> None:
        """Show the answer to an utterance, or the result of a slash command."""
        name, _, rest = line.partition(" ")
        if not line.startswith("/"):
            self._converse(line)
        elif name in _COMMANDS:
            self._do(partial(self._run, _COMMANDS[name], rest.strip()))
        else:
            self.out.print(Text(f"There is no {name}. Say /help to see what there is."))

    def listen(self, talk: Talk) -> None:
        """Answer what is heard until the sounds end, or Ctrl-C is pressed."""
        now = self.agent.dialogue.conversation
        try:
            for heard in talk.heard(lambda: (now.language, now.discourse), self.out.print):
                self.out.print(Text(f"{self.prompt()}{heard.text}"))
                self._converse(heard.text, heard)
        except KeyboardInterrupt:
            self.interrupt()
        self.close()

    def completable(self) -> set[str]:
        """Return the words that the Tab key can complete."""
        return {*self.agent.dialogue.conversation.language.lexicon.words(), *_COMMANDS, QUIT}

    def interrupt(self) -> None:
        """Stop what is being done, and drop the lines that wait to be heard."""
        self._drop_waiting()
        if self.agent.is_busy:
            self.agent.interrupt()
        wait(self._waiting)

    def close(self) -> None:
        """Wait for the last answer."""
        wait(self._waiting)
        self._worker.shutdown()

    def _run(self, command: SlashCommand, argument: str) -> None:
        is_lacking = command.needs_robot and not self.agent.simulate
        try:
            if found := _NO_ROBOT if is_lacking else command.run(self, argument):
                self.out.print(found)
        except HiltError as error:
            self.out.print(Text(str(error)))

    def _converse(self, line: str, heard: Heard | None = None) -> None:
        self._waiting = [each for each in self._waiting if not each.done()]
        known = self.agent.dialogue.conversation.language.control
        found = [known(each.text) for each in heard.alternatives] if heard else []
        halt = next((each for each in found if each and each.is_halt), None)
        control = (halt or known(line)) if self._waiting else None
        if control:
            self._is_interrupted = control.control not in {"wait", "continue"}
            if self._is_interrupted:
                self._drop_waiting()
            self._hear(line, heard)
            self._is_interrupted = False
            return
        if self.agent.interruption.is_paused:
            self.agent.interrupt()  # what is said in a pause ends the command
        self._do(partial(self._hear, line, heard))

    def _drop_waiting(self) -> None:
        for each in self._waiting:
            each.cancel()

    def _do(self, work: Callable[[], None]) -> None:
        if not self.is_interactive:
            work()
            return
        done = self._worker.submit(work)
        self._waiting.append(done)
        try:
            with self.out.status("..."):
                wait([done], 0 if self.talk else PATIENCE)
        except KeyboardInterrupt:
            self.interrupt()
        if done.done():
            done.result()

    def _hear(self, line: str, heard: Heard | None = None) -> None:
        film, self.film = self.film, None
        likely = [(each.text, each.score) for each in heard.alternatives] if heard else []
        say = partial(self.agent.hear, line, speaker=self.speaker, alternatives=likely)
        watchers = [self._report] if self.is_interactive and self.agent.simulate else []
        self.agent.watchers += watchers
        try:
            with self.agent.filmed(film) if film else nullcontext():
                reply = say(heard=heard.heard if heard else 1.0)
        except HiltError as error:  # a text that cannot be stored, a film that cannot be written
            self.out.print(Text(str(error)))
            return
        finally:
            for each in watchers:
                self.agent.watchers.remove(each)
        # What was interrupted is said in the answer to the control.
        if not (reply.is_interrupted and self._is_interrupted):
            spoken = Text.assemble(("Hilt: ", "bold green"), printable(reply.said))
            self.out.print(spoken if self.is_interactive else shown.turn(reply))
            if reply.ending == "refused" and self.agent.base.trust(reply.speaker) is None:
                self.out.print(Text(self.hint(reply.speaker), "dim"))
            if self.talk:
                speaking = partial(self.talk.say, reply.said)
                # In turn, and so that somebody can be heard meanwhile.
                self._worker.submit(speaking) if self.is_interactive else speaking()
        if film:
            self.show_file("film", film)

    def _report(self, step: WalkStep) -> None:
        if step.inference.best and not step.action:
            self._found = step.inference.best.object
        if not step.action and (said := doing(step, self._found)):
            self.out.print(Text(f"... {said}", "dim"))

    def hint(self, stranger: str) -> str:
        """Return how a stranger comes to be trusted."""
        host = self.agent.dialogue.conversation.people.owner or DEFAULT_SPEAKER
        return f"{proper_name(host)} may change that: /speaker {host}, then /trust {stranger}"

    def show_file(self, kind: str, path: Path) -> None:
        """Say where a picture or film is, and open the viewer where there is one."""
        self.out.print(Text(f"The {kind} is in {path.resolve()}."))
        if self.is_interactive:
            view(path)


class SlashCommand(NamedTuple):
    """A command of the chat: what it does with its argument, how it is used, and what for."""

    run: Callable[[Chat, str], RenderableType]
    usage: str
    purpose: str
    needs_robot: bool = False


def _help(*_: object) -> RenderableType:
    said = [
        (f"To {purpose}, say", "\n".join(f'"{each}"' for each in examples))
        for purpose, *examples in EXAMPLES
    ]
    commands = [(f"{name} {each.usage}", each.purpose) for name, each in _COMMANDS.items()]
    return shown.grid([*said, *commands, (QUIT, "end the conversation")])


def _rules(chat: Chat, _: str) -> RenderableType:
    return shown.sentences(chat.agent.base.rules(), chat.agent.dialogue.conversation.describe)


def _scene(chat: Chat, _: str) -> RenderableType:
    return Text(", ".join(chat.agent.visible()) or "nothing on the table")


def _why(chat: Chat, _: str) -> RenderableType:
    if (last := chat.agent.dialogue.conversation.last_done) is None or last.result is None:
        return Text("I have not done anything yet.")
    said, made = Text(printable(last.said)), last.result.decision
    return Group(said, shown.reasons(made, chat.agent.quote)) if made else said


def _trust(chat: Chat, argument: str) -> RenderableType:
    conversation, given = chat.agent.dialogue.conversation, _TRUST.fullmatch(argument)
    if given is None:
        known = chat.agent.base.trust_by_speaker().items()
        return Text("\n".join(f"{name}: {trust}" for name, trust in known))
    speaker = conversation.people.speaker(chat.speaker)
    answered = conversation.vouch(speaker, given[1], *map(float, given[2].split()))
    return Text(conversation.say(answered))


def _set_speaker(chat: Chat, name: str) -> RenderableType:
    if name:
        check_speaker(name)
        chat.speaker = chat.agent.base.match_speaker(name)
        chat.agent.dialogue.conversation.people.leave(chat.speaker)
    if chat.agent.dialogue.conversation.people.trusts(chat.speaker):
        return Text(f"{chat.speaker} is speaking.")
    doubt = f"{chat.speaker} is speaking, whom I do not trust yet."
    return Text(f"{doubt} {chat.hint(chat.speaker)}")


def _picture(chat: Chat, name: str) -> RenderableType:
    chat.show_file("picture", chat.agent.body.picture(_file(name, "picture-{}.png")))
    return ""


def _film(chat: Chat, name: str) -> RenderableType:
    chat.film = _file(name, "film-{}.gif")
    return Text("I will film what I do next.")


def _file(name: str, pattern: str) -> Path:
    new = (MEDIA / pattern.format(number) for number in count(1))
    return Path(name) if name else next(path for path in new if not path.exists())


_COMMANDS: Mapping[str, SlashCommand] = {
    "/rules": SlashCommand(_rules, "", "show what I was told"),
    "/why": SlashCommand(_why, "", "show why I did what I did last"),
    "/scene": SlashCommand(_scene, "", "show what is on the table"),
    "/picture": SlashCommand(_picture, "[FILE]", "take a picture of the table", needs_robot=True),
    "/film": SlashCommand(_film, "[FILE]", "film what I do next", needs_robot=True),
    "/speaker": SlashCommand(_set_speaker, "[NAME]", "let somebody else speak"),
    "/trust": SlashCommand(
        _trust, "[NAME [LOWER [UPPER]]]", "trust somebody, to a degree in [0, 1]"
    ),
    "/help": SlashCommand(_help, "", "show this"),
}

_DOING: Mapping[str, str] = {  # primitive -> what is done
    "graspObject": "grasping the {}",
    "moveTo": "lifting the {}",
    "handOver": "handing over the {}",
    "pointAt": "pointing at the {}",
    "moveAbove": "moving the {} above it",
    "raise": "raising the {}",
    "lower": "striking with the {}",
    "placeObject": "putting down the {}",
    "returnObject": "putting back the {}",
    "letGo": "letting go of the {}",
}
_DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")  # set where there is a desktop on Linux


def doing(step: WalkStep, found: str) -> str:
    """Return what is done at a step with the object that was found; empty for a step of steps."""
    action, constraint = step.node.rpartition("/")[2], step.constraint
    if action == FIND:
        first = next(iter(step.inference.candidates), None)
        if first and first.argument and first.argument.kind == "affordance":
            return f"looking for something used for {first.argument.name}"
        return f"looking for {f'the {first.object}' if first else 'it'}"
    if action not in _DOING:
        return ""
    part = f" by the {constraint.part}" if constraint and constraint.part else ""
    return _DOING[action].format(found or "object") + part


def view(path: Path) -> None:
    """Open a file in the viewer of the desktop; nothing happens where there is none."""
    if sys.platform in {"darwin", "win32"} or any(map(os.environ.get, _DISPLAYS)):
        webbrowser.open(path.absolute().as_uri())
