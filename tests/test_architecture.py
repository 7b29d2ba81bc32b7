# SPDX-License-Identifier: Apache-2.0
"""The shape of the code: the tree, the direction of imports, and what the wheel holds."""

import ast
import subprocess
import sys
import zipfile
from collections.abc import Iterator
from pathlib import Path

import networkx as nx
import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("agent", "inference", "kb", "nlu", "ontology", "sim")
MAY_IMPORT = {
    "ontology": set(),
    "kb": {"ontology"},
    "inference": {"kb", "ontology"},
    "nlu": {"ontology"},
    "sim": {"ontology"},
    "agent": {"inference", "kb", "nlu", "ontology", "sim"},
}
TOP_LEVEL = {
    *PACKAGES, *("tests", "benchmarks", "examples", "docs", ".ci", "Makefile", ".gitignore"),
    "pyproject.toml", "requirements.lock", "README.md", "ARCHITECTURE.md", "CONTRIBUTING.md",
    "CHANGELOG.md", "LICENSE",
}  # fmt: skip


def modules() -> dict[str, Path]:
    """Dotted name ("kb.interval") and file of every module."""
    files = (path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in files
    }


def imported(path: Path, *, at_load: bool = False) -> Iterator[str]:
    """Names that a module imports, relative ones made dotted from the root."""
    package = path.relative_to(ROOT).parent.parts
    tree = ast.parse(path.read_text(encoding="utf-8"))
    nodes = tree.body if at_load else list(ast.walk(tree))
    for node in nodes:
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            target = ".".join([*base, *([node.module] if node.module else [])])
            yield target
            yield from (f"{target}.{alias.name}" for alias in node.names)


def importers(name: str) -> set[str]:
    """The modules that import a foreign package."""
    return {
        module
        for module, path in modules().items()
        if any(found.split(".")[0] == name for found in imported(path))
    }


def test_top_level_holds_what_the_design_lists():
    """Git tracks nothing at the top level besides the fixed tree."""
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )

    assert {line.split("/")[0] for line in listed.stdout.splitlines()} <= TOP_LEVEL


@pytest.mark.parametrize("package", PACKAGES)
def test_imports_point_one_way(package: str):
    """No package imports one that stands above or beside it."""
    paths = [path for name, path in modules().items() if name.split(".")[0] == package]

    found = {name.split(".")[0] for path in paths for name in imported(path)}

    assert found & set(PACKAGES) - {package} <= MAY_IMPORT[package]


def test_modules_import_each_other_relatively():
    """No module of Hilt names itself absolutely."""
    assert importers("hilt") == set()


@pytest.mark.parametrize(
    ("foreign", "package"),
    [("pybullet", "sim"), ("pyoxigraph", "kb"), ("lark", "nlu")],
)
def test_foreign_engine_is_imported_in_one_module(foreign: str, package: str):
    """What may be exchanged one day is known to one module only."""
    assert [name.split(".")[0] for name in importers(foreign)] == [package]


def test_no_import_cycles():
    """Modules form an acyclic graph."""
    known = modules()
    graph = nx.DiGraph(
        (name, target)
        for name, path in known.items()
        for target in imported(path, at_load=True)
        if target in known and not f"{name}.".startswith(f"{target}.")
    )

    assert list(nx.simple_cycles(graph)) == []


@pytest.mark.parametrize("name", sorted(modules()))
def test_module_opens_with_licence_and_docstring(name: str):
    """Every module says under which licence it stands and what is in it."""
    text = modules()[name].read_text(encoding="utf-8")

    assert text.startswith("# SPDX-License-Identifier: Apache-2.0\n")
    assert ast.get_docstring(ast.parse(text))


def test_wheel_holds_only_hilt(tmp_path: Path):
    """The wheel installs one name, with the data that the code reads."""
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", tmp_path, ROOT],
        check=True,
        capture_output=True,
    )

    names = zipfile.ZipFile(next(tmp_path.glob("*.whl"))).namelist()

    assert {name.split("/")[0] for name in names} == {"hilt", "hilt-0.1.0.dist-info"}
    for package in PACKAGES:
        data = (
            p
            for p in (ROOT / package).rglob("*")
            if p.suffix in {".yaml", ".ttl", ".rq", ".lark", ".typed"}
        )
        assert {f"hilt/{p.relative_to(ROOT).as_posix()}" for p in data} <= set(names)
