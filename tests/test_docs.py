"""What the documents show is what happens."""

import doctest
import importlib
import re
import runpy
import shlex
from pathlib import Path

import numpy as np
import pytest
from PIL import Image
from sybil import Example, Sybil
from sybil.parsers.myst import CodeBlockParser, PythonCodeBlockParser

from hilt.agent.cli import main

ROOT = Path(__file__).parents[1]
README = ROOT / "README.md"
DOCUMENTS = [README, ROOT / "ARCHITECTURE.md", ROOT / "CONTRIBUTING.md"]
DOCUMENTS += sorted((ROOT / "docs").rglob("*.md"))
PACKAGES = ("agent", "inference", "kb", "nlu", "ontology", "sim")
MOST_BYTES = 300_000  # of one picture or film of the gallery


def run_session(example: Example) -> None:
    """Run each command of a block, which must print what stands below it; "..." is anything."""
    capture = example.namespace["capture"]
    for command, expected in re.findall(
        r"^\$ hilt (.*)\n((?:(?!\$ ).*\n?)*)", example.parsed, flags=re.MULTILINE
    ):
        capture.readouterr()
        with pytest.raises(SystemExit):
            main(shlex.split(command))
        printed = "\n".join(line.rstrip() for line in capture.readouterr().out.splitlines())
        pattern = ".*".join(map(re.escape, expected.rstrip("\n").split("...")))
        assert re.fullmatch(pattern, printed, flags=re.DOTALL), f"$ hilt {command}\n{printed}"


def write_file(example: Example) -> None:
    """Write a block that opens with a file name, "# mine.yaml", into the working folder."""
    if named := re.match(r"(?:#|<!--) ([\w.]+)(?: -->)?\n", example.parsed):
        Path(named[1]).write_text(example.parsed, encoding="utf-8")


BLOCKS = Sybil(
    [
        PythonCodeBlockParser(),
        CodeBlockParser("console", run_session),
        CodeBlockParser("sparql", write_file),
        CodeBlockParser("xml", write_file),
        CodeBlockParser("yaml", write_file),
    ]
)


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda path: path.name)
def test_blocks_of_page_run(
    page: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
):
    """Programs and commands of a page run in turn, and print what it shows."""
    monkeypatch.setenv("HILT_KB", str(tmp_path / "base"))
    monkeypatch.setenv("COLUMNS", "120")
    for name in ("docs", "examples", "tests"):  # what is read; what is written stays apart
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    document = BLOCKS.parse(page)
    document.namespace["capture"] = capfd

    for example in document.examples():
        example.evaluate()


@pytest.mark.parametrize("page", DOCUMENTS, ids=lambda path: path.name)
def test_sessions_hold_commands_of_hilt_only(page: Path):
    """Each line with a prompt is one that is run."""
    blocks = re.findall(r"^```console\n(.*?)^```", page.read_text("utf-8"), re.DOTALL | re.M)

    assert all(block.startswith("$ hilt ") for block in blocks)
    assert not re.findall(r"^\$ (?!hilt )", "".join(blocks), re.M)


def test_readme_program_prints_what_its_comment_says(capfd: pytest.CaptureFixture[str]):
    """The Python block of the README runs."""
    (program,) = re.findall(r"^```python\n(.*?)^```", README.read_text("utf-8"), re.DOTALL | re.M)

    exec(compile(program, "README.md", "exec"), {})  # noqa: S102 - our own README

    said = re.findall(r"print\(.*\)  # (.*)", program)
    assert capfd.readouterr().out.splitlines() == said != []


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_links_lead_somewhere(document: Path):
    """Every relative link of a document points at a file that is there."""
    links = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", document.read_text(encoding="utf-8"))

    assert [link for link in links if not (document.parent / link).exists()] == []


GALLERY = runpy.run_path(str(ROOT / "docs" / "gallery.py"))


def test_gallery_shows_every_picture_with_its_commands():
    """Each picture of the documents is small, made by the script, and stands on the page."""
    page = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    files = {path.name: path for path in (ROOT / "docs" / "images").iterdir()}

    assert files.keys() == GALLERY["PICTURES"].keys() | GALLERY["PAGE_PICTURES"].keys()
    assert all(files[name].stat().st_size < MOST_BYTES for name in GALLERY["PAGE_PICTURES"])
    for name, commands in GALLERY["PICTURES"].items():
        assert files[name].stat().st_size < MOST_BYTES
        assert f"(images/{name})" in page
        assert "\n".join(f"hilt {command}" for command in commands) in page


@pytest.mark.parametrize("name", ["derivation.svg", "proof.svg"])
def test_drawing_of_the_gallery_is_fresh(name: str, tmp_path: Path):
    """What the script draws is what the documents show."""
    drawn = GALLERY["make"](name, tmp_path)

    assert drawn.read_bytes() == (ROOT / "docs" / "images" / name).read_bytes()


@pytest.mark.sim
def test_film_of_the_gallery_shows_the_tinted_part(tmp_path: Path):
    """The knife is passed in many pictures, and its blade is blue in some of them."""
    tinted = []
    with Image.open(GALLERY["make"]("pass.gif", tmp_path)) as film:
        for index in range(film.n_frames):
            film.seek(index)
            pixels = np.asarray(film.convert("RGB")).astype(int)
            red, green, blue = np.moveaxis(pixels, -1, 0)
            tinted.append(np.sum((blue > 180) & (blue - red > 90) & (blue - green > 50)))

    assert len(tinted) > 15
    assert tinted[0] == 0 < max(tinted)


@pytest.mark.parametrize(
    ("made", "by"),
    [
        ("commands.md", "commands.py"),
        ("formats.md", "formats.py"),
        ("schemas/options.schema.json", "options.py"),
        ("vocabulary.md", "vocabulary.py"),
    ],
)
def test_page_made_from_code_or_data_is_fresh(made: str, by: str):
    """Commands, options, formats and terms are documented as they are now (`make docs`)."""
    page = (ROOT / "docs" / made).read_text(encoding="utf-8")

    assert page == runpy.run_path(str(ROOT / "docs" / by))["reference"]()


FILE = re.compile(r"`([a-z_]+/[\w/.-]+\.(?:py|yaml|jsonl?|ttl|rq|lark|md|tsv))`")


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.name)
def test_files_that_are_named_are_there(document: Path):
    """A path of the repository in a document is the path of a file."""
    named = FILE.findall(document.read_text(encoding="utf-8"))

    assert [name for name in named if not (ROOT / name).exists()] == []


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
