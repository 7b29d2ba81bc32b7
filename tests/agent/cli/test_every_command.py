"""Every command, also a new one, is called in the wrong way: none ends with a traceback."""

import json
import os
import shlex
import subprocess
import sys
from collections.abc import Iterator
from io import BytesIO, TextIOWrapper
from pathlib import Path
from shutil import copytree
from typing import Any

import pytest
import typer

from hilt.agent import Agent, AgentConfig
from hilt.agent.cli import app, main

LESSONS = ("A knife is used for cutting", "To pass a knife, grab it by the blade")
LONG = {"evaluate": "evaluate grasps"}  # what stands for an example that takes long


def _commands(group: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], Any]]:
    for name, each in group.commands.items():
        if hasattr(each, "commands"):
            yield (*path, name), each if each.invoke_without_command else None
            yield from _commands(each, (*path, name))
        else:
            yield (*path, name), each


COMMANDS = {" ".join(path): each for path, each in _commands(typer.main.get_command(app))}
LEAVES = {name: each for name, each in COMMANDS.items() if not hasattr(each, "commands") and each}


class Outcome:
    """How a command ended: its exit code, and what it printed."""

    def __init__(self, arguments: list[str], capfd: pytest.CaptureFixture[str]) -> None:
        capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main(arguments)
        self.code = ended.value.code or 0
        self.out, self.err = capfd.readouterr()

    @property
    def told(self) -> list[str]:
        """The lines about what is wrong."""
        return [line for line in self.err.splitlines() if line.startswith("hilt: ")]


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base with two rules."""
    folder = tmp_path_factory.mktemp("taught") / "kb"
    with Agent.open(str(folder), AgentConfig(simulate=False)) as agent:
        for lesson in LESSONS:
            agent.hear(lesson)
    return folder


@pytest.fixture(autouse=True)
def _without_the_simulator(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In an empty folder, over an empty base, without the extra, and with nothing to read."""
    monkeypatch.setitem(sys.modules, "pybullet", None)
    monkeypatch.setenv("HILT_KB", str(tmp_path / "kb"))
    monkeypatch.setenv("XDG_CONFIG_HOME", str(tmp_path))
    monkeypatch.setattr(sys, "stdin", TextIOWrapper(BytesIO()))
    monkeypatch.setattr("time.sleep", _interrupt)  # of `hilt watch`, which has no other end
    monkeypatch.chdir(tmp_path)


def _interrupt(_: float) -> None:
    raise KeyboardInterrupt


@pytest.mark.parametrize("name", COMMANDS)
def test_command_without_arguments(name: str, capfd: pytest.CaptureFixture[str]):
    """It does what it does, or one line says what is missing; a group shows its help."""
    ended = Outcome(name.split(), capfd)

    assert ended.code in {0, 1, 2}
    assert len(ended.told) == (ended.code != 0 and COMMANDS[name] is not None)
    assert ended.out.startswith("Usage: ") == (COMMANDS[name] is None)


@pytest.mark.parametrize("arguments", ["--frobnicate", "x x x x x x x x x"])
@pytest.mark.parametrize("name", LEAVES)
def test_command_with_wrong_arguments(name: str, arguments: str, capfd: pytest.CaptureFixture[str]):
    """One line, and exit code 2."""
    ended = Outcome([*name.split(), *arguments.split()], capfd)

    assert (ended.code, ended.out) == (2, "")
    assert ended.told == ended.err.splitlines()
    assert len(ended.told) == 1


@pytest.mark.parametrize(
    "name", [name for name, each in LEAVES.items() if "as_json" in str(each.params)]
)
def test_errors_are_json_where_results_are(name: str, capfd: pytest.CaptureFixture[str]):
    """One document on stderr, with what is wrong."""
    ended = Outcome([*name.split(), "--json", "--frobnicate"], capfd)

    (error,) = json.loads(ended.err)["errors"]
    assert ended.out == ""
    assert "No such option" in error["message"]


@pytest.mark.parametrize("name", LEAVES)
def test_command_at_40_columns(
    name: str, taught: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """Its own example, where two rules are known."""
    monkeypatch.setenv("COLUMNS", "40")
    copytree(taught, "kb")
    shown = LONG.get(name) or LEAVES[name].epilog.partition("hilt ")[2].partition(" > ")[0]

    ended = Outcome(shlex.split(shown), capfd)

    assert ended.code in {0, 1, 2}
    assert len(ended.told) <= 1
    assert "─┬" not in ended.out or max(map(len, ended.out.splitlines())) <= 40


def test_commands_with_closed_input(tmp_path: Path):
    """Nothing is heard, and nothing is broken."""
    commands = ("tell -", "do - --no-sim", "ask -", "parse -", "chat --no-sim", "import -")
    commands += ("validate -", "query -", "update -")
    code = (
        "import sys; from hilt.agent.cli import main\n"
        "for each in sys.argv[1:]:\n"
        "    try: main(each.split())\n"
        "    except SystemExit as ended: print(each, ended.code or 0)"
    )

    ended = subprocess.run(
        ["sh", "-c", '"$@" <&-', "sh", sys.executable, "-c", code, *commands],
        capture_output=True,
        text=True,
        check=True,
        env=os.environ | {"HILT_KB": str(tmp_path / "kb")},
    )

    codes = dict(line.rsplit(" ", 1) for line in ended.stdout.splitlines() if line[-1:].isdigit())
    assert {name: codes[name] for name in commands} == {
        **dict.fromkeys(commands[:7], "0"), "query -": "2", "update -": "2",
    }  # fmt: skip
    assert "Traceback" not in ended.stderr
