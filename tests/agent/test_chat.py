"""A conversation on a terminal: who speaks, slash commands, prompt, history, completion."""

import os
import pty
import sys
import time
import webbrowser
from collections.abc import Generator
from contextlib import contextmanager
from io import StringIO
from pathlib import Path

import pytest
from prompt_toolkit.application import create_app_session
from prompt_toolkit.input import create_pipe_input
from prompt_toolkit.output import DummyOutput
from rich.console import Console

from hilt.agent import Agent, AgentConfig
from hilt.agent.chat import EXAMPLES, Chat, doing, read_lines, run, view
from hilt.sim.robot.interruption import Interruption


def conversation(keys: list[bytes], home: Path) -> str:
    """What a terminal shows when these keys are typed into `hilt chat`."""
    child, terminal = pty.fork()
    if child == 0:  # the process behind the terminal
        os.environ |= {"XDG_STATE_HOME": str(home), "TERM": "xterm", "COLUMNS": "100"}
        os.environ["PROMPT_TOOLKIT_NO_CPR"] = "1"  # this terminal does not say where its cursor is
        options = "'chat --no-sim --kb memory: --speaker sam'"
        code = f"from hilt.agent.cli import main; main({options}.split())"
        os.execv(sys.executable, [sys.executable, "-W", "ignore", "-c", code])
    shown = b""
    for key in keys:
        shown += _until_prompt(terminal)
        os.write(terminal, key)
    shown += _rest(terminal)
    os.waitpid(child, 0)
    os.close(terminal)
    return shown.decode(errors="replace")


def test_who_watches_sees_that_something_is_done():
    """On a terminal, until the answer is there."""
    child, terminal = pty.fork()
    if child == 0:
        code = (
            "from hilt.agent.cli import main; main(['do', '--no-sim', '--kb', 'memory:', 'hello'])"
        )
        os.environ["TERM"] = "xterm"
        os.execv(sys.executable, [sys.executable, "-W", "ignore", "-c", code])
    shown = _rest(terminal).decode(errors="replace")
    os.waitpid(child, 0)
    os.close(terminal)

    assert "⠋" in shown
    assert shown.rindex("Hello.") > shown.rindex("⠋")


def _until_prompt(terminal: int) -> bytes:
    shown = b""
    end = time.monotonic() + 30
    while b"sam>" not in shown and time.monotonic() < end:
        shown += os.read(terminal, 4096)
    return shown


def _rest(terminal: int) -> bytes:
    shown = b""
    while True:
        try:
            more = os.read(terminal, 4096)
        except OSError:
            return shown
        if not more:
            return shown
        shown += more


@contextmanager
def keys_typed(keys: str) -> Generator[None]:
    """These keys are typed on a terminal, whose prompt nobody sees."""
    with create_pipe_input() as terminal, create_app_session(terminal, DummyOutput()):
        terminal.send_text(keys)
        yield


def test_ctrl_c_drops_the_line_and_nothing_else(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """What is done is interrupted, and the next line is heard; only the end of input ends it."""
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    interrupted = list[str]()

    with keys_typed("good\x03hello\r\x04"):
        lines = list(read_lines(lambda: "> ", set, lambda: interrupted.append("once")))

    assert lines == ["hello"]
    assert interrupted == ["once"]


@pytest.mark.parametrize(
    ("typed", "completed"), [("the Ham\t", "the hammer"), ("ha\t", "ha"), ("/sc\t", "/scene")]
)
def test_words_are_completed_by_their_beginning(typed: str, completed: str):
    """Upper or lower case, as far as it is clear which one is meant."""
    words = {"handle", "hammer", "mug", "/scene"}

    with keys_typed(f"{typed}\r\x04"):
        assert list(read_lines(lambda: "> ", lambda: words)) == [completed]


def test_lines_are_read_where_no_history_can_be_kept(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    """The folder may be read-only."""
    (tmp_path / "hilt").write_text("a file")
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))

    with keys_typed("hello\r\x04"):
        assert list(read_lines(lambda: "> ", set)) == ["hello"]


def test_terminal_completes_words_and_keeps_history(tmp_path: Path):
    """Tab completes a known word; what was typed is there in the next session."""
    taught = conversation([b"A screwd\t is used for cutting\r", b"/rules\r", b"/quit\r"], tmp_path)

    assert "I learned: a screwdriver is used for cutting." in taught
    assert "A screwdriver is used for cutting.  " in taught
    assert "A screwdriver is used for cutting" in (tmp_path / "hilt" / "history").read_text()


def piped(read_lines: list[str], speaker: str | None = "sam") -> str:
    """What is shown when these lines come down a pipe."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        return said_to(agent, read_lines, speaker)


def said_to(agent: Agent, lines: list[str], speaker: str | None = None) -> str:
    """What is shown when these lines come down a pipe to this agent."""
    shown = StringIO()
    run(agent, Console(file=shown, width=200), StringIO("\n".join(lines)), speaker)
    return shown.getvalue()


class Terminal(StringIO):
    """A source of lines that is a terminal."""

    def isatty(self) -> bool:
        """It is."""
        return True


def typed(agent: Agent, lines: list[str]) -> str:
    """What a terminal shows when these lines are typed, and then the input ends."""
    shown = StringIO()
    with keys_typed("".join(f"{line}\r" for line in lines) + "\x04"):
        run(agent, Console(file=shown, width=200), Terminal())
    return shown.getvalue()


@pytest.mark.parametrize("answer", ["Tessa Ünal", "my name is Tessa Ünal", " Tessa Ünal "])
def test_first_conversation_asks_for_the_name(agent: Agent, answer: str):
    """Who answers is the owner from then on, is believed, and is not asked again."""
    shown = typed(agent, [answer, "A knife is used for cutting"])

    assert "Hello Tessa Ünal. I will believe what you tell me." in shown
    assert [rule.speaker for rule in agent.base.rules()] == ["Tessa Ünal"]
    assert "What is your name?" not in typed(agent, ["A mug is used for containing"])
    assert {rule.speaker for rule in agent.base.rules()} == {"Tessa Ünal"}


def test_account_names_who_only_presses_enter(agent: Agent, monkeypatch: pytest.MonkeyPatch):
    """A name that nobody can have is asked for again."""
    monkeypatch.setenv("USER", "ada")

    typed(agent, ["<>", "", "A knife is used for cutting"])

    assert [rule.speaker for rule in agent.base.rules()] == ["Ada"]


def test_nobody_owns_a_base_without_a_name(agent: Agent):
    """Where the input ends at the question, the next one is asked."""
    typed(agent, [])

    assert agent.dialogue.conversation.people.owner is None
    assert agent.base.speakers() == ("sam",)


def test_speaker_who_is_named_first_is_trusted(agent: Agent):
    """Only in the first conversation; a second stranger has to be vouched for."""
    said_to(agent, ["A knife is used for cutting"], "Tessa")
    shown = said_to(agent, ["A mug is used for containing"], "Ben")

    assert [rule.object for rule in agent.base.rules()] == ["knife"]
    assert "Tessa may change that: /speaker Tessa, then /trust Ben" in shown


def test_owner_lets_others_teach():
    """By a slash command or a sentence, to a degree; strangers cannot help themselves."""
    lesson = "A mug is used for containing"
    shown = piped(
        [
            "/speaker Ben", "/trust Ben", lesson, "/speaker Tessa", "/trust Ben 0.5",
            "/speaker Ben", lesson, "/trust", "/trust Ben 0.9", "/trust Kim 2",
        ],
        "Tessa",
    )  # fmt: skip

    assert "Ben is speaking, whom I do not trust yet." in shown
    assert shown.count("How far I trust Ben is not for you to say.") == 2
    assert shown.count("with some doubt: a mug is used for containing") == 1
    assert "Ben: [0.50, 1.00]" in shown
    assert "is not an interval" in shown


def test_slash_command_ends_an_introduction():
    """Who was introduced speaks no longer."""
    lines = [
        "You can trust Anna",
        "My name is Anna",
        "/speaker sam",
        "A mug is used for containing",
    ]

    shown = piped([*lines, "/rules"])

    assert "A mug is used for containing.  Sam" in shown


def test_examples_of_the_help_are_understood(agent: Agent):
    """What it offers can be said."""
    for _, *texts in EXAMPLES:
        for text in texts:
            agent.hear("To pass a knife, grab it by the blade")
            assert agent.hear(text).understanding.kind != "error", text


def test_slash_commands_speak_plain_english():
    """Neither symbols nor figures."""
    lessons = ["A knife is used for cutting", "A spoon is rarely used for cutting"]
    order = "pass me something used for cutting"
    shown = piped(["/why", *lessons, "/rules", order, "/why", "pass me the mug", "/why"])

    words = "\n".join(line for line in shown.splitlines() if "(sam" not in line)
    assert "I have not done anything yet." in words
    assert "A spoon is rarely used for cutting.  Sam" in words
    assert 'not the spoon  Sam said: "A spoon is rarely used for cutting"' in words
    assert "the mug  that is what was asked for" in words
    assert not {"λ", "[", "=>", "lambda", "object:"} & {*words.replace(":", ": ").split()}


def test_help_names_every_slash_command():
    """With what it is for."""
    shown = piped(["/help"])

    for name in ("/rules", "/why", "/scene", "/picture", "/film", "/speaker", "/trust", "/quit"):
        assert f"\n{name} " in shown


def test_without_a_robot_there_is_nothing_to_film():
    """It says why, and the conversation goes on."""
    assert piped(["/picture", "/film", "hello"]).count("There is no robot to be seen") == 2


@pytest.mark.sim
def test_steps_and_files_are_told_while_the_arm_moves(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
):
    """A line a step; pictures and films are numbered, and nothing of the kind comes down a pipe."""
    monkeypatch.chdir(tmp_path)
    shown_to = list[Path]()
    monkeypatch.setattr("hilt.agent.chat.view", shown_to.append)
    with Agent.open("memory:", AgentConfig(scene="objects:knife")) as agent:
        lines = ["Tessa", "/picture", "/film", "point to the knife", "/picture"]
        shown = typed(agent, lines)
        piped = said_to(agent, ["point to the knife"])

    folder = tmp_path / "out" / "chat"
    files = [folder / name for name in ("picture-1.png", "film-1.gif", "picture-2.png")]
    assert [path.resolve() for path in shown_to] == files
    assert all(path.exists() and str(path) in shown for path in files)
    assert "... looking for the knife" in shown
    assert "... pointing at the knife" in shown
    assert "..." not in piped


def test_several_people_speak_in_one_conversation():
    """Each is trusted as far as the base says."""
    lesson = "A mug is used for containing"

    shown = piped(["/speaker kim", lesson, "/speaker sam", lesson, "/rules"])

    assert "kim is speaking, whom I do not trust yet." in shown
    assert "because I have no reason to trust Kim" in shown
    assert "I learned: a mug is used for containing." in shown


@pytest.mark.parametrize("last", ["/quit", "/exit", "quit", "exit"])
def test_conversation_ends_as_on_other_terminals(last: str):
    """Nothing after it is heard."""
    assert "Hello" not in piped([last, "hello"])


def test_what_cannot_be_said_ends_no_conversation():
    """It is told, and the next line is heard."""
    shown = piped(["/nothing", "/speaker !", "hello \udcff", "", "hello"])

    assert "There is no /nothing." in shown
    assert "is no speaker's name" in shown
    assert "The text is no Unicode" in shown
    assert "Hello." in shown


def test_stop_is_obeyed_while_a_command_runs(monkeypatch: pytest.MonkeyPatch):
    """On a terminal the next line is taken at once; lines that wait are not carried out."""
    monkeypatch.setattr("hilt.agent.chat.PATIENCE", 0.05)
    shown = StringIO()
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        chat = Chat(agent, Console(file=shown, width=200), "sam", is_interactive=True)
        agent.goals.watchers.append(lambda _: wait_for(agent.interruption))

        for line in ("pass me the knife", "pass me the mug", "stop!"):
            chat.handle_line(line)
        chat.close()

    assert shown.getvalue().count("Hilt:") == 1
    assert "Hilt: I stopped." in shown.getvalue()


def wait_for(interruption: Interruption) -> None:
    """Return when somebody has asked to stop."""
    while not interruption.is_stopped:
        time.sleep(0.001)


# --- What who watches is told, and shown on the desktop -------------------------------------


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
