"""The steps of the Dockerfile, carried out in a folder in place of a container."""

from __future__ import annotations

import json
import os
import re
import shlex
import subprocess
from pathlib import Path

import pytest

from .environments import ROOT, find_python, fresh_variables, run

pytestmark = [pytest.mark.install, pytest.mark.timeout(600)]
LINES = (ROOT / "Dockerfile").read_text(encoding="utf-8").replace("\\\n", "")
STAGES = re.split(r"^FROM .*\n", LINES, flags=re.MULTILINE)[1:]


def instructions(stage: str, name: str) -> list[str]:
    """What stands behind an instruction, each time that it occurs in a stage."""
    return re.findall(rf"^{name} +(.*)$", stage, re.MULTILINE)


def read_only(root: Path, command: str) -> list[str]:
    """The command where nothing can be written but the base and a temporary folder."""
    mounts = [f"mount --bind {folder} {folder}" for folder in (root / "base", root / "tmp")]
    script = "\n".join([*mounts, "mount -o remount,bind,ro /", f"exec {command}"])
    return ["unshare", "--mount", "sh", "-e", "-c", script]


def can_mount() -> bool:
    """Whether this user may make a view of the file system of their own."""
    return subprocess.run(["unshare", "--mount", "true"], capture_output=True).returncode == 0


def copy_files(stage: str, source: Path) -> None:
    """Carry out the COPY instructions of a stage."""
    for copied in instructions(stage, "COPY"):
        *names, target = copied.split()
        (source / target).mkdir(parents=True, exist_ok=True)
        paths = [f"{ROOT / name}{'/.' * (ROOT / name).is_dir()}" for name in names]
        run(["cp", "-r", *paths, source / target], ROOT, os.environ)


@pytest.fixture
def image(tmp_path: Path) -> Path:
    """The folder in which the first stage is built, with those that the container writes to."""
    build = STAGES[0]
    for folder in ("base", "tmp", "bin"):
        (tmp_path / folder).mkdir()
    (tmp_path / "bin" / "python").symlink_to(find_python(re.findall(r"python:(3\.\d+)", LINES)[0]))
    copy_files(build, tmp_path / "source")
    variables = fresh_variables(tmp_path / "home", tmp_path / "bin")
    for step in instructions(build, "RUN"):
        steps = step.replace("/opt/hilt", str(tmp_path / "opt" / "hilt"))
        run(["sh", "-e", "-c", steps], tmp_path / "source", variables)
    return tmp_path


def start(image: Path, *words: str) -> str:
    """What the container prints for a command; only the base and `tmp` can be written."""
    variables = fresh_variables(image / "tmp", image / "opt" / "hilt" / "bin")
    command = read_only(image, shlex.join(words)) if can_mount() else words
    return run(command, image, variables | {"HILT_KB": str(image / "base")})


def test_image_runs_on_a_read_only_system(image: Path):
    """What is copied is enough to install; a lesson, a command and the health check work."""
    final = STAGES[1]
    entry = json.loads(instructions(final, "ENTRYPOINT")[0])
    (health,) = re.findall(r"^HEALTHCHECK .* CMD (.*)$", final, re.MULTILINE)

    told = start(image, *entry, "tell", "To pass a knife grab the knife by the blade")
    done = start(image, *entry, "do", "pass me the knife", "--json")
    checked = start(image, *json.loads(health))

    assert "I learned" in told
    assert json.loads(done)["world"]["executed"] is True
    assert "blade" in checked


def test_image_runs_as_a_user_of_its_own():
    """Not as root, with the base in a volume that this user owns, as the variables say."""
    final = STAGES[-1]
    (user,) = instructions(final, "USER")

    assert any(f"--uid {user}" in step for step in instructions(final, "RUN"))
    assert instructions(final, "VOLUME") == re.findall(r"HILT_KB=(\S+)", final)
