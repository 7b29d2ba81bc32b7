# SPDX-License-Identifier: Apache-2.0
"""A conversation on a terminal: prompt, history, completion."""

import os
import pty
import sys
import time
from pathlib import Path

from hilt.agent.prompt import completions


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


def test_terminal_completes_words_and_keeps_history(tmp_path: Path):
    """Tab completes a known word; what was typed is there in the next session."""
    taught = conversation([b"A screwd\t is used for cutting\r", b"/rules\r", b"/quit\r"], tmp_path)

    assert "I learned: a screwdriver is used for cutting (0.95, from Sam)." in taught
    assert "usedFor" in taught
    assert "A screwdriver is used for cutting" in (tmp_path / "hilt" / "history").read_text()
