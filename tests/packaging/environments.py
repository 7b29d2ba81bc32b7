"""Fresh copies of the checkout, fresh environments, and what is run in them."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
TOOLS = Path(sys.executable).parent  # where the development tools are
KEPT = ("PIP_", "SSL_", "REQUESTS_", "UV_")  # variables: how this machine reaches its index
SYSTEM = "/usr/local/bin:/usr/bin:/bin"


def find_python(version: str) -> str:
    """Return the interpreter of a version ("3.10"), or skip the test where there is none."""
    pyenv = Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")) / "versions"
    found = [shutil.which(f"python{version}"), *map(str, pyenv.glob(f"{version}.*/bin/python3"))]
    for path in filter(None, found):
        works = subprocess.run([path, "-m", "ensurepip", "--version"], capture_output=True)
        if works.returncode == 0:  # a name on the path may be a shim with nothing behind it
            return path
    pytest.skip(f"this machine has no Python {version}")


def fresh_variables(home: Path, *bins: Path) -> dict[str, str]:
    """Return the environment variables of a new user's shell, which finds `bins` first."""
    home.mkdir(exist_ok=True)
    kept = {name: value for name, value in os.environ.items() if name.startswith(KEPT)}
    cache = os.environ.get("UV_CACHE_DIR", str(Path.home() / ".cache" / "uv"))
    path = os.pathsep.join([*map(str, bins), SYSTEM])
    own = {"HOME": str(home), "PATH": path, "LANG": "C.UTF-8", "COLUMNS": "120"}
    own["PIP_NO_COMPILE"] = "1"  # bytecode is made where it is used: half of the time saved
    return {**kept, "UV_CACHE_DIR": cache, "UV_PYTHON_DOWNLOADS": "never", **own}


def run(command: Sequence[str | Path], cwd: Path, variables: Mapping[str, str]) -> str:
    """Run a command that must end well, and return all that it printed."""
    ended = subprocess.run(
        command,
        cwd=cwd,
        env=variables,
        text=True,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
    )
    assert ended.returncode == 0, f"{' '.join(map(str, command))}\n{ended.stdout}"
    return ended.stdout


def copy_checkout(folder: Path) -> Path:
    """Copy the files of the checkout that git does not ignore, and return the folder."""
    listed = ["git", "ls-files", "-z", "--cached", "--others", "--exclude-standard"]
    for name in filter(None, run(listed, ROOT, os.environ).split("\0")):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(ROOT / name, folder / name)
    return folder


def make_environment(folder: Path, *packages: str | Path, python: str = sys.executable) -> Path:
    """Make a virtual environment, install packages, and return its folder of commands."""
    variables = fresh_variables(folder.parent / "home")
    run([TOOLS / "uv", "venv", "--quiet", "--python", python, folder], ROOT, variables)
    install(folder / "bin", *packages)
    return folder / "bin"


def install(bins: Path, *packages: str | Path) -> None:
    """Install packages with uv into the environment that has this folder of commands."""
    variables = fresh_variables(bins.parents[1] / "home")
    command = [TOOLS / "uv", "pip", "install", "--quiet", "--python", bins / "python"]
    run([*command, *packages], ROOT, variables)
