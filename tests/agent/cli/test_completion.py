"""Shells complete the commands and options of `hilt`."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

BIN = Path(sys.executable).parent  # where the command `hilt` is
WORDS = {  # how each shell asks for what may follow "hilt ex", and "hilt rules --ob"
    "bash": [
        {"COMP_WORDS": "hilt ex", "COMP_CWORD": "1"},
        {"COMP_WORDS": "hilt rules --ob", "COMP_CWORD": "2"},
    ],
    "zsh": [{"_TYPER_COMPLETE_ARGS": "hilt ex"}, {"_TYPER_COMPLETE_ARGS": "hilt rules --ob"}],
    "fish": [
        {"_TYPER_COMPLETE_ARGS": typed, "_TYPER_COMPLETE_FISH_ACTION": "get-args"}
        for typed in ("hilt ex", "hilt rules --ob")
    ],
}


def printed(*command: str, **variables: str) -> str:
    """What a command prints, with variables of the environment."""
    path = f"{BIN}{os.pathsep}{os.environ['PATH']}"
    environment = {**os.environ, "PATH": path, **variables}
    return subprocess.run(
        command, env=environment, capture_output=True, text=True, check=True
    ).stdout


@pytest.mark.parametrize("shell", WORDS)
def test_script_is_printed(shell: str):
    """The script for a shell binds `hilt` to the function that it defines."""
    script = printed(
        "hilt", "--show-completion", shell, _TYPER_COMPLETE_TEST_DISABLE_SHELL_DETECTION="1"
    )

    assert f"_HILT_COMPLETE=complete_{shell}" in script
    assert "complete" in script and "hilt" in script.splitlines()[-1]


@pytest.mark.parametrize("shell", WORDS)
def test_commands_and_options_are_completed(shell: str):
    """The beginning of a command and of an option are completed."""
    command, option = (
        printed("hilt", _HILT_COMPLETE=f"complete_{shell}", **words) for words in WORDS[shell]
    )

    assert "export" in command and "explain" in command and "trust" not in command
    assert "--object" in option and "--part" not in option


def test_bash_completes_with_the_script():
    """What bash does at the key: it calls the function of the script."""
    key = "COMP_WORDS=(hilt ex); COMP_CWORD=1; _hilt_completion hilt; echo ${COMPREPLY[@]}"

    completed = printed("bash", "-c", f'eval "$(hilt --show-completion)"; {key}')

    assert {"export", "explain"} <= set(completed.split())
