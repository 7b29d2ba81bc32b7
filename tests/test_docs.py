"""What the documents show is what happens."""

import doctest
import importlib
import re
import runpy
import shlex
from pathlib import Path

import pytest

from hilt.agent.cli import main

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
DOCUMENTS = [ROOT / "README.md", ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md"]
DOCUMENTS += sorted((ROOT / "docs").glob("*.md"))
PACKAGES = ("agent", "inference", "kb", "nlu", "ontology", "sim")


def blocks(text: str, language: str) -> list[str]:
    """The fenced code blocks of a language."""
    return re.findall(rf"^```{language}\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


SESSIONS = [  # those that print what they show
    page for page in DOCUMENTS if page.stem in {"README", "actions", "inference", "norms"}
]


@pytest.mark.parametrize("page", SESSIONS, ids=lambda path: path.name)
def test_commands_print_what_the_page_shows(
    page: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """Every console line of a page runs and gives the output below it, one after the other."""
    monkeypatch.setenv("HILT_KB", str(tmp_path))
    monkeypatch.setenv("COLUMNS", "120")
    monkeypatch.chdir(ROOT)
    session = "".join(blocks(page.read_text(encoding="utf-8"), "console"))

    for command, expected in re.findall(r"^\$ hilt (.*)\n((?:(?!\$ ).*\n)*)", session, re.M):
        capfd.readouterr()
        with pytest.raises(SystemExit):
            main(shlex.split(command))
        printed = "\n".join(line.rstrip() for line in capfd.readouterr().out.splitlines())
        assert printed == expected.rstrip("\n")


def test_readme_program_prints_what_its_comment_says(capfd: pytest.CaptureFixture[str]):
    """The Python block of the README runs."""
    (program,) = blocks(README, "python")

    exec(compile(program, "README.md", "exec"), {})  # noqa: S102 - our own README

    said = re.findall(r"print\(.*\)  # (.*)", program)
    assert capfd.readouterr().out.splitlines() == said


@pytest.mark.parametrize("document", DOCUMENTS[1:], ids=lambda path: path.name)
def test_programs_in_documents_run(document: Path):
    """The Python blocks of a page run, one after the other."""
    program = "\n".join(blocks(document.read_text(encoding="utf-8"), "python"))

    exec(compile(program, document.name, "exec"), {})  # noqa: S102 - our own documents


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document: Path):
    """Every relative link of a document points at a file that is there."""
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", document.read_text(encoding="utf-8"))

    assert [link for link in links if not (document.parent / link).exists()] == []


def test_page_of_commands_is_fresh():
    """Every command with every option is documented as it is now (`make docs`)."""
    page = (ROOT / "docs" / "commands.md").read_text(encoding="utf-8")
    reference = runpy.run_path(str(ROOT / "docs" / "commands.py"))["reference"]

    assert page == reference()


@pytest.mark.parametrize("package", PACKAGES)
def test_package_exports_what_it_lists(package: str):
    """Every name in `__all__` is there; that it is sorted, the linter sees to."""
    module = importlib.import_module(f"hilt.{package}")

    assert all(hasattr(module, name) for name in getattr(module, "__all__", []))


DOCTESTED = sorted(
    ".".join(("hilt", *path.relative_to(ROOT).with_suffix("").parts)).removesuffix(".__init__")
    for package in PACKAGES
    for path in (ROOT / package).rglob("*.py")
    if ">>>" in path.read_text(encoding="utf-8")
)


@pytest.mark.parametrize("name", DOCTESTED)
def test_docstring_examples_run(name: str):
    """Every example in a docstring gives what stands below it."""
    module = importlib.import_module(name)

    result = doctest.testmod(module, optionflags=doctest.ELLIPSIS)

    assert result.failed == 0
    assert result.attempted > 0
