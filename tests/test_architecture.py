"""The shape of the code: the tree, the direction of imports, names, and what the wheel holds."""

import ast
import importlib
import re
import subprocess
import sys
import zipfile
from collections import Counter, defaultdict
from collections.abc import Iterator
from pathlib import Path

import networkx as nx
import pytest

ROOT = Path(__file__).parents[1]
PACKAGES = ("agent", "inference", "kb", "nlu", "ontology", "sim")
TOP = ROOT / "agent" / "hilt"  # what is installed as `hilt` itself, above the six packages
MAY_IMPORT = {
    "ontology": set(),
    "kb": {"ontology"},
    "inference": {"kb", "ontology"},
    "nlu": {"ontology"},
    "sim": {"ontology"},
    "agent": {"inference", "kb", "nlu", "ontology", "sim"},
}
IMPORTED_IN = {  # a foreign package that may be exchanged one day, and where alone it is imported
    "jinja2": "agent.evaluation.reports",
    "lark": "nlu.grammar",
    "mcp": "agent.web",
    "pybullet": "sim.physics",
    "pyoxigraph": "kb.stores",
    "ray": "agent.evaluation.runners",
    "typer": "agent.cli",
    "uvicorn": "agent.web",
}
PAGE = ROOT / "agent" / "web" / "page"  # from which `make page` builds what is installed
MOST_MODULES = 15  # in one folder
TOP_LEVEL = {
    *PACKAGES, *("tests", "benchmarks", "examples", "docs", ".ci", "Makefile", ".gitignore"),
    "pyproject.toml", "requirements.lock", "README.md", "ARCHITECTURE.md", "CONTRIBUTING.md",
    "CHANGELOG.md", "LICENSE", "CITATION.cff", "SECURITY.md", ".github", "Dockerfile",
}  # fmt: skip


def read_modules() -> dict[str, Path]:
    """Dotted name ("kb.interval") and file of every module."""
    files = (path for package in PACKAGES for path in (ROOT / package).rglob("*.py"))
    return {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__"): path
        for path in files
        if path.parent != TOP
    }


MODULES = read_modules()
TREES = {name: ast.parse(path.read_text(encoding="utf-8")) for name, path in MODULES.items()}
SUBPACKAGES = sorted(name for name, path in MODULES.items() if path.name == "__init__.py")


def imported(name: str) -> Iterator[str]:
    """Names that a module imports anywhere but under TYPE_CHECKING, made dotted from the root."""
    package = MODULES[name].relative_to(ROOT).parent.parts
    todo: list[ast.AST] = [TREES[name]]
    while todo:
        node = todo.pop()
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
            todo.extend(node.orelse)
            continue
        todo.extend(ast.iter_child_nodes(node))
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = package[: len(package) - node.level + 1] if node.level else ()
            target = ".".join([*base, *([node.module] if node.module else [])])
            yield target
            yield from (f"{target}.{alias.name}" for alias in node.names)


IMPORTS = {name: set(imported(name)) for name in MODULES}


def importers(foreign: str) -> set[str]:
    """The modules that import a foreign package."""
    return {
        name
        for name, found in IMPORTS.items()
        if any(each.split(".")[0] == foreign for each in found)
    }


def read_layers() -> dict[str, list[set[str]]]:
    """The table of layers in ARCHITECTURE.md: a package, and its layers from the lowest up."""
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    rows = re.findall(r"^\| `([a-z.]+)` \| (`.*`) \|$", text, flags=re.MULTILINE)
    return {
        package: [set(re.findall(r"`([a-z_*]+)`", layer)) for layer in layers.split(" < ")]
        for package, layers in rows
    }


LAYERS = read_layers()


def layer_of(name: str, package: str) -> int:
    """The place of a module among the layers of its package; `*` takes the modules not named."""
    own = name.removeprefix(f"{package}.").split(".")[0] if name != package else "*"
    named = [place for place, layer in enumerate(LAYERS[package]) if own in layer]
    rest = [place for place, layer in enumerate(LAYERS[package]) if "*" in layer]
    return (named or rest)[0]


def test_top_level_holds_what_the_design_lists():
    """Git tracks nothing at the top level besides the fixed tree."""
    listed = subprocess.run(
        ["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True
    )

    assert {line.split("/")[0] for line in listed.stdout.splitlines()} <= TOP_LEVEL


@pytest.mark.parametrize("package", PACKAGES)
def test_packages_import_in_one_direction(package: str):
    """No package imports one that stands above or beside it."""
    names = [name for name in MODULES if name.split(".")[0] == package]

    found = {each.split(".")[0] for name in names for each in IMPORTS[name]}

    assert found & set(PACKAGES) - {package} <= MAY_IMPORT[package]


@pytest.mark.parametrize("package", sorted(LAYERS))
def test_subpackages_import_in_the_order_of_the_table(package: str):
    """A module imports its own layer and lower ones, as the table in ARCHITECTURE.md lists them."""
    upward = [
        f"{name} imports {target}"
        for name in MODULES
        for target in IMPORTS[name] & MODULES.keys()
        if f"{name}.".startswith(f"{package}.") and f"{target}.".startswith(f"{package}.")
        if target != package and layer_of(target, package) > layer_of(name, package)
    ]

    assert upward == []


def test_every_subpackage_stands_in_the_table():
    """The table of layers lists every sub-package, and nothing that does not exist."""
    listed = {
        f"{package}.{name}" for package, layers in LAYERS.items() for name in set().union(*layers)
    }

    assert {name for name in SUBPACKAGES if "." in name} <= listed
    assert {name for name in listed if not name.endswith("*")} <= MODULES.keys()


def test_the_map_lists_every_module():
    """The tree in ARCHITECTURE.md names each folder with the modules that are in it."""
    text = (ROOT / "ARCHITECTURE.md").read_text(encoding="utf-8")
    block = re.findall(r"^```text\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)[0]
    listed: dict[str, set[str]] = {}
    folder: list[str] = []
    for line in block.splitlines():
        if found := re.match(r"( *)([a-z_]+)/", line):
            folder = [*folder[: len(found[1]) // 2], found[2]]
            listed[".".join(folder)] = set()
        else:
            listed[".".join(folder)] |= set(line.split())

    assert set(SUBPACKAGES) <= listed.keys()
    modules = {name for name in MODULES if name not in SUBPACKAGES}
    assert {f"{folder}.{name}" for folder, names in listed.items() for name in names} == modules


def test_modules_import_each_other_relatively():
    """No module of Hilt names itself absolutely."""
    assert importers("hilt") == set()


@pytest.mark.parametrize("foreign", sorted(IMPORTED_IN))
def test_foreign_package_is_imported_in_one_place(foreign: str):
    """What may be exchanged one day is known to one sub-package only."""
    places = {
        name if name in SUBPACKAGES else name.rpartition(".")[0] for name in importers(foreign)
    }

    assert places == {IMPORTED_IN[foreign]}


def test_pybullet_is_imported_in_one_module():
    """One module owns the physics client."""
    assert len(importers("pybullet")) == 1


def test_no_import_cycles():
    """Modules form an acyclic graph, imports inside functions included."""
    graph = nx.DiGraph(
        (name, target)
        for name, found in IMPORTS.items()
        for target in found & MODULES.keys()
        if not f"{name}.".startswith(f"{target}.")
    )

    assert [group for group in nx.strongly_connected_components(graph) if len(group) > 1] == []


def test_folders_hold_few_modules():
    """No folder is a bag of modules."""
    held = Counter(path.parent for path in MODULES.values() if path.name != "__init__.py")

    assert {str(folder) for folder, count in held.items() if count > MOST_MODULES} == set()


def test_public_class_names_are_unique():
    """One name stands for one class; a protocol may share its name with what implements it."""
    homes: dict[str, list[str]] = defaultdict(list)
    for name, tree in TREES.items():
        for node in tree.body:
            if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
                homes[node.name].append(name)

    shared = {
        name: [home for home in found if not home.endswith("protocols")]
        for name, found in homes.items()
    }
    assert {name: found for name, found in shared.items() if len(found) > 1} == {}


def test_modules_open_with_a_docstring():
    """Every module says what is in it."""
    assert [name for name in MODULES if not ast.get_docstring(TREES[name])] == []


@pytest.mark.parametrize("name", SUBPACKAGES)
def test_subpackage_exports_what_it_lists(name: str):
    """Every public name of a package can be imported from it."""
    package = importlib.import_module(f"hilt.{name}")

    assert [each for each in getattr(package, "__all__", []) if not hasattr(package, each)] == []


def test_wheel_holds_only_hilt(tmp_path: Path):
    """The wheel installs one name, with the data that the code reads."""
    subprocess.run(
        [sys.executable, "-m", "build", "--wheel", "--no-isolation", "--outdir", tmp_path, ROOT],
        check=True,
        capture_output=True,
    )

    names = zipfile.ZipFile(next(tmp_path.glob("*.whl"))).namelist()

    assert {re.split("[-/]", name)[0] for name in names} == {"hilt"}
    kinds = {
        ".py",
        ".pyi",
        ".yaml",
        ".json",
        ".ttl",
        ".rq",
        ".lark",
        ".typed",
        ".npz",
        ".html",
        ".jinja",
        ".js",
        ".css",
        ".svg",
    }
    for package in PACKAGES:
        files = (
            path
            for path in (ROOT / package).rglob("*")
            if path.suffix in kinds and PAGE not in path.parents
        )
        paths = {f"hilt/{p.relative_to(ROOT).as_posix()}" for p in files}
        assert {path.replace("hilt/agent/hilt/", "hilt/") for path in paths} <= set(names)
