"""Type checkers find the types of an installed Hilt, of a wheel and of an editable checkout."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from .environments import ROOT, TOOLS, copy_checkout, fresh_variables, make_environment, run

pytestmark = [pytest.mark.install, pytest.mark.timeout(600)]
HERE = Path(__file__).parent
PROGRAM = (HERE / "typed_program.py").read_text(encoding="utf-8")
# What numpy itself says of every array: its number of dimensions is open.
ARRAY = re.compile(r"ndarray\[tuple\[Any, \.\.\.\], ")
STRICT = ("--config-settings", "editable_mode=strict")  # as in the Makefile


@pytest.fixture(scope="module", params=["wheel", "editable"])
def project(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder of a user's project, with Hilt in its `.venv` and the user's program."""
    folder = tmp_path_factory.mktemp("project")
    if request.param == "wheel":
        wheel = next(request.getfixturevalue("distributions").glob("*.whl"))
        packages = [f"hilt[sim] @ {wheel.as_uri()}"]
    else:
        packages = [*STRICT, "--editable", f"{copy_checkout(folder / 'checkout')}[sim]"]
    make_environment(folder / ".venv", *packages)
    (folder / "program.py").write_text(PROGRAM, encoding="utf-8")
    settings = {"venvPath": ".", "venv": ".venv", "typeCheckingMode": "strict"}
    (folder / "pyrightconfig.json").write_text(json.dumps(settings), encoding="utf-8")
    return folder


def checked(project: Path, checker: str, program: str) -> str:
    """What a type checker in strict mode says of a program, in which it finds no mistake."""
    variables = fresh_variables(project / "home", project / ".venv" / "bin")
    cache = ROOT / ".venv" / ".mypy_cache"
    options = [
        "--strict",
        "--python-executable",
        project / ".venv/bin/python",
        "--cache-dir",
        cache,
    ]
    return run(
        [TOOLS / checker, *(options if checker == "mypy" else []), program], project, variables
    )


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
def test_program_has_no_type_errors(checker: str, project: Path):
    """Both checkers follow every import of the user's program."""
    said = checked(project, checker, "program.py")

    assert "no issues found" in said or "0 errors, 0 warnings" in said


def test_program_runs(project: Path):
    """It prints what it decided, and the package runs as a module."""
    variables = fresh_variables(project / "home", project / ".venv" / "bin")

    printed = run(["python", "program.py"], project, variables)

    version = run(["python", "-m", "hilt", "--version"], project, variables)
    assert printed.startswith(f"{version.strip().title()}: ")
    assert "2 lessons, 2 rules\nknife\nI would pass the knife by the blade.\n" in printed


@pytest.mark.parametrize("checker", ["mypy", "pyright"])
@pytest.mark.parametrize("project", ["wheel"], indirect=True)
def test_public_names_have_types(checker: str, project: Path):
    """The type of no public name or member is Any or unknown."""
    variables = fresh_variables(project / "home", project / ".venv" / "bin")
    program = run(["python", HERE / "list_public_names.py"], project, variables)
    (project / "names.py").write_text(program, encoding="utf-8")

    said = checked(project, checker, "names.py").splitlines()

    revealed = [
        ARRAY.sub("ndarray[", line) for line in said if ": Revealed" in line or " Type of " in line
    ]
    assert len(revealed) == program.count("reveal_type(")
    assert [line for line in revealed if re.search(r"\b(Any|Unknown)\b", line)] == []
