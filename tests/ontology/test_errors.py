"""Hilt without the packages of its simulator."""

import sys

import pytest

from hilt.agent import AgentConfig
from hilt.agent.cli import main
from hilt.agent.execution.embodiment import Embodiment
from hilt.ontology.errors import SIMULATOR_PACKAGES, MissingExtraError, check_simulator


def test_nothing_is_missing_where_the_extra_is_installed():
    """As here, where the other tests simulate."""
    check_simulator()


@pytest.mark.parametrize("module", SIMULATOR_PACKAGES)
def test_each_package_is_missed(monkeypatch: pytest.MonkeyPatch, module: str):
    """By the name under which pip knows it."""
    monkeypatch.setitem(sys.modules, module, None)

    with pytest.raises(MissingExtraError, match=f'"{SIMULATOR_PACKAGES[module]}" is not installed'):
        check_simulator()


def test_no_body_is_made(monkeypatch: pytest.MonkeyPatch):
    """Programs hear of it, too, before anything is loaded."""
    monkeypatch.setitem(sys.modules, "pybullet", None)

    with pytest.raises(MissingExtraError, match=r"hilt\[sim\]"):
        Embodiment.from_config(AgentConfig()).open_body()


@pytest.mark.parametrize(
    "command",
    [
        "do hello",
        "demo",
        "scene show",
        "chat",
        "evaluate paper --sim",
        "evaluate noise --sim",
        "evaluate grasps",
    ],
)
def test_commands_say_what_to_install_before_they_start(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], command: str
):
    """In one line, which also tells how to do without."""
    monkeypatch.setitem(sys.modules, "pybullet", None)

    with pytest.raises(SystemExit) as ended:
        main(command.split())

    out, err = capsys.readouterr()
    assert (ended.value.code, out, err.count("\n")) == (1, "", 1)
    assert "hilt[sim]" in err and "--no-sim" in err
