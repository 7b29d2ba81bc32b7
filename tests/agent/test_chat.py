"""A conversation on a terminal: prompt, history, completion."""

import os
import pty
import sys
import time
from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from hilt.agent import Agent, AgentConfig
from hilt.agent.chat import Chat, completions, read_lines, run
from hilt.sim.robot.interruption import Interruption


def test_words_are_completed_by_their_beginning():
    """Upper or lower case, sorted; nothing is offered for nothing."""
    assert completions("Ha", {"handle", "hammer", "mug"}) == ["hammer", "handle"]
    assert completions("", {"handle"}) == []


def conversation(keys: list[bytes], home: Path) -> str:
    """What a terminal shows when these keys are typed into `hilt chat`."""
    child, terminal = pty.fork()
    if child == 0:  # the process behind the terminal
        os.environ |= {"XDG_STATE_HOME": str(home), "TERM": "xterm", "COLUMNS": "100"}
        code = "from hilt.agent.cli import main; main(['chat', '--no-sim', '--kb', 'memory:'])"
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
    while b"sam> " not in shown and time.monotonic() < end:
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


def test_ctrl_c_drops_the_line_and_nothing_else(monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """The next line is heard; only the end of input ends it."""
    typed = iter([KeyboardInterrupt(), "hello", EOFError()])

    def answer(_: str) -> str:
        key = next(typed)
        if isinstance(key, BaseException):
            raise key
        return key

    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    monkeypatch.setattr("builtins.input", answer)

    assert list(read_lines(lambda: "> ", set)) == ["hello"]


def test_terminal_completes_words_and_keeps_history(tmp_path: Path):
    """Tab completes a known word; what was typed is there in the next session."""
    taught = conversation([b"A screwd\t is used for cutting\r", b"/rules\r", b"/quit\r"], tmp_path)

    assert "I learned: a screwdriver is used for cutting." in taught
    assert "usedFor" in taught
    assert "A screwdriver is used for cutting" in (tmp_path / "hilt" / "history").read_text()


def piped(read_lines: list[str]) -> str:
    """What is shown when these lines come down a pipe."""
    shown = StringIO()
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        run(agent, Console(file=shown, width=200), StringIO("\n".join(read_lines)), "sam")
    return shown.getvalue()


def test_several_people_speak_in_one_conversation():
    """Each is trusted as far as the base says."""
    lesson = "A mug is used for containing"

    shown = piped(["/speaker kim", lesson, "/speaker sam", lesson, "/rules"])

    assert "kim is speaking now, whom I do not trust yet." in shown
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
