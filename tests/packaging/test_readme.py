"""The installation that the README shows, word for word, in fresh environments."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest

from .environments import ROOT, TOOLS, find_python, fresh_variables, run

pytestmark = [pytest.mark.install, pytest.mark.timeout(600)]
README = (ROOT / "README.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```sh\n(.*?)^```", README, flags=re.DOTALL | re.MULTILINE)
ACTIVATION = ". .venv/bin/activate\n"
NEWEST = "pip"
CASES = [  # Python, pip, with the simulator
    ("3.10", "pip==23.0", True),
    ("3.11", "pip==24.0", True),
    ("3.12", NEWEST, False),
    ("3.13", NEWEST, False),
]


def test_installation_stands_before_the_first_command():
    """Who reads from the top has `hilt` when it is first used."""
    assert README.index('pip install ".[sim]"') < re.search(r"^\$ hilt ", README, re.M).start()


@pytest.mark.parametrize(("python", "pip", "simulated"), CASES)
def test_blocks_install_hilt(
    python: str, pip: str, simulated: bool, checkout: Path, tmp_path: Path
):
    """The lines work with this Python as `python3`, and with this pip once `.venv` is active."""
    (tmp_path / "bin").mkdir()
    (tmp_path / "bin" / "python3").symlink_to(find_python(python))
    variables = fresh_variables(tmp_path / "home", tmp_path / "bin")
    with_simulator, without = BLOCKS
    preparation = with_simulator.partition(ACTIVATION)[0] + ACTIVATION
    block = with_simulator if simulated else preparation + without
    script = block.replace(ACTIVATION, f"{ACTIVATION}pip install -q {pip!r}\n", 1)

    run(["sh", "-e", "-c", script], checkout, variables)
    active = f"{ACTIVATION}hilt do --json 'pass me the knife' {'' if simulated else '--no-sim'}"
    printed = run(["sh", "-e", "-c", active], checkout, variables)

    assert f'"executed": {str(simulated).lower()}' in printed


@pytest.mark.parametrize("tool", ["uv tool", "pipx"])
def test_tool_installs_the_command(tool: str, checkout: Path, tmp_path: Path):
    """The lines for uv and pipx work as the README has them."""
    (line,) = re.findall(rf"`({tool} install .*?)`", README)
    python = find_python("3.11")
    (tmp_path / "bin").mkdir()
    shutil.copy(TOOLS / tool.split(maxsplit=1)[0], tmp_path / "bin")
    home = fresh_variables(tmp_path / "home", tmp_path / "bin", Path(python).parent)
    variables = {**home, "PIPX_DEFAULT_PYTHON": str(python)}

    run(["sh", "-e", "-c", line], checkout, variables)
    printed = run([tmp_path / "home" / ".local" / "bin" / "hilt", "--version"], tmp_path, variables)

    assert printed.startswith("hilt ")
