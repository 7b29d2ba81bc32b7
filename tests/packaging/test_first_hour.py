"""A newcomer's first hour: an empty home, a fresh checkout, and only what the README says."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from .environments import ROOT, find_python, fresh_variables, run

pytestmark = [pytest.mark.install, pytest.mark.timeout(900)]
README = (ROOT / "README.md").read_text(encoding="utf-8")
STEPS = (  # what the README must show how to do, as a command of it
    "make demo",
    "hilt trust anna",
    "hilt tell --speaker anna",
    "hilt do .*--record pass.png",
    "hilt explain",
    "hilt export rules.ttl",
)


def blocks(language: str) -> str:
    """The fenced blocks of a language, one after the other."""
    return "".join(re.findall(rf"^```{language}\n(.*?)^```", README, re.DOTALL | re.MULTILINE))


def commands() -> list[str]:
    """The commands in the order of the README: the demonstration, and all after its prompts."""
    demonstration = re.findall(r"^    (make demo)\b", README, re.MULTILINE)
    return [*demonstration, *re.findall(r"^\$ (.*)$", blocks("console"), re.MULTILINE)]


@pytest.mark.parametrize("step", STEPS)
def test_readme_shows_each_step(step: str):
    """No step of the first hour needs what stands elsewhere."""
    assert any(re.match(step, command) for command in commands())


def test_first_hour(checkout: Path, tmp_path: Path):
    """The demonstration, lessons by Anna, a picture, reasons, an export, types, and removal."""
    variables = fresh_variables(tmp_path / "home", Path(find_python("3.11")).parent)
    activation = re.findall(r"^\. .*activate$", blocks("sh"), re.MULTILINE)[0]
    (checkout / "program.py").write_text(blocks("python"), encoding="utf-8")
    demonstration, *session = commands()

    shown = run(["sh", "-e", "-c", demonstration], checkout, variables)
    said = run(["sh", "-e", "-c", "\n".join([activation, *session])], checkout, variables)
    for use in ("python program.py", "pyright program.py", "mypy --strict program.py"):
        run(["sh", "-e", "-c", f"{activation}\n{use}"], checkout, variables)
    removal = f"{activation}\npip uninstall -y hilt\n! python -c 'import hilt.agent'\n! hilt"
    run(["sh", "-e", "-c", removal], checkout, variables)

    assert "warning" not in shown.lower()
    assert list((checkout / "out" / "demo").iterdir())
    assert "as Anna told me" in said
    assert (checkout / "pass.png").read_bytes().startswith(b"\x89PNG")
    assert "hilt:" in (checkout / "rules.ttl").read_text()
