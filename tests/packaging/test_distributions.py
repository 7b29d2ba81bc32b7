"""What a user gets: the wheel and the sdist, in environments made for each test."""

from __future__ import annotations

import re
import zipfile
from email.parser import BytesParser
from pathlib import Path

import pytest

from .environments import ROOT, TOOLS, fresh_variables, install, make_environment, run

pytestmark = [pytest.mark.install, pytest.mark.timeout(600)]
KINDS = ("*.whl", "*.tar.gz")
LESSON = "A knife is used for cutting"
QUESTION = "what is a knife used for?"


def declared_version() -> str:
    """The version in the source."""
    text = (ROOT / "agent" / "hilt" / "__init__.py").read_text(encoding="utf-8")
    return re.findall(r'^__version__ = "(.+)"$', text, flags=re.MULTILINE)[0]


def files_below(folder: Path) -> set[str]:
    """The paths of all files and folders in a folder, but for the caches of Python itself."""
    paths = (str(path.relative_to(folder)) for path in folder.rglob("*"))
    return {path for path in paths if "__pycache__" not in path or "hilt" in path}


def test_package_index_accepts_the_distributions(distributions: Path):
    """The metadata is complete, and the README can be shown."""
    run([TOOLS / "twine", "check", "--strict", *distributions.iterdir()], ROOT, {})


def test_links_of_the_description_are_absolute(distributions: Path):
    """On the page of the package index every link leads to a file of the source."""
    with zipfile.ZipFile(next(distributions.glob("*.whl"))) as wheel:
        name = next(name for name in wheel.namelist() if name.endswith("/METADATA"))
        metadata = BytesParser().parsebytes(wheel.read(name))
    source = dict(line.split(", ") for line in metadata.get_all("Project-URL", []))["Source"]
    links = re.findall(r"\]\(([^)]+)\)", metadata.get_payload())

    files = [re.sub(rf"^{source}/(blob|raw)/HEAD/", "", link) for link in links]

    assert len(files) > 10
    assert [file for file in files if not (ROOT / file).is_file()] == []


@pytest.mark.parametrize("kind", KINDS)
def test_distribution_installs_learns_and_leaves_nothing(
    kind: str, distributions: Path, tmp_path: Path
):
    """Without the simulator: the commands, the version, a lesson, and no file after removal."""
    bins = make_environment(tmp_path / "env", "pip")
    variables = fresh_variables(tmp_path / "home", bins)
    before = files_below(tmp_path / "env")
    install(bins, next(distributions.glob(kind)))
    installed = files_below(tmp_path / "env")

    version = run(["hilt", "--version"], tmp_path, variables)
    as_module = run(["python", "-m", "hilt", "--version"], tmp_path, variables)
    imported = run(["python", "-c", "import hilt; print(hilt.__version__)"], tmp_path, variables)
    listed = run(["hilt", "--help"], tmp_path, variables)
    run(["hilt", "tell", LESSON], tmp_path, variables)
    answer = run(["hilt", "ask", QUESTION], tmp_path, variables)
    run(["pip", "uninstall", "-q", "-y", "hilt"], tmp_path, variables)

    assert version == as_module == f"hilt {declared_version()}\n"
    assert imported == f"{declared_version()}\n"
    assert "Usage: hilt" in listed
    assert f"Hilt  {LESSON}." in answer
    left = files_below(tmp_path / "env") - before
    assert any("hilt" in path for path in installed - before)
    assert [path for path in left if "hilt" in path] == []
