"""The files that forges, indexes and citing authors read: valid, and of one version."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
import yaml

from .environments import ROOT, TOOLS, run

FORMS = sorted((ROOT / ".github" / "ISSUE_TEMPLATE").glob("*.yml"))
WORKFLOWS = sorted((ROOT / ".github" / "workflows").glob("*.yml"))
SCHEMAS = [
    ("citation-file-format", ROOT / "CITATION.cff"),
    *(("github-workflows", path) for path in WORKFLOWS),
    *(("github-issue-forms", path) for path in FORMS if path.stem != "config"),
    ("github-issue-config", ROOT / ".github" / "ISSUE_TEMPLATE" / "config.yml"),
]


def found(pattern: str, name: str) -> str:
    """What a pattern finds first in a file."""
    return re.findall(pattern, (ROOT / name).read_text(encoding="utf-8"), re.MULTILINE)[0]


def test_all_files_name_the_same_version():
    """The package, its metadata, the citation and the newest release of the changelog agree."""
    declared = found(r'^__version__ = "(.+)"$', "agent/hilt/__init__.py")

    assert found(r'^version = "(.+)"$', "pyproject.toml") == declared
    assert found(r"^version: (.+)$", "CITATION.cff") == declared
    assert found(r"^## (\d\S*) - ", "CHANGELOG.md") == declared


def test_release_has_the_date_of_its_citation():
    """The changelog and the citation have one date."""
    assert found(r"^## \d\S* - (.+)$", "CHANGELOG.md") == found(
        r"^date-released: (.+)$", "CITATION.cff"
    )


@pytest.mark.parametrize(("schema", "path"), SCHEMAS, ids=lambda value: getattr(value, "name", ""))
def test_file_is_valid(schema: str, path: Path):
    """The file has the form that its readers demand."""
    run(
        [TOOLS / "check-jsonschema", "--builtin-schema", f"vendor.{schema}", path], ROOT, os.environ
    )


def test_container_file_has_no_lint():
    """The linter of container files finds nothing, however small."""
    assert run([TOOLS / "hadolint", "Dockerfile"], ROOT, os.environ) == ""


@pytest.mark.parametrize("workflow", WORKFLOWS, ids=lambda path: path.name)
def test_workflow_calls_what_there_is(workflow: Path):
    """Every target of make that a workflow names is in the Makefile."""
    jobs = yaml.safe_load(workflow.read_text(encoding="utf-8"))["jobs"].values()
    lines = [step["run"] for job in jobs for step in job["steps"] if "run" in step]
    named = {target for line in lines if line.startswith("make ") for target in line.split()[1:]}

    targets = re.findall(r"^([a-z-]+):", (ROOT / "Makefile").read_text(), re.MULTILINE)

    assert named <= {*targets}
