"""The distributions that the tests of the package install."""

from __future__ import annotations

from pathlib import Path

import pytest

from .environments import ROOT, TOOLS, copy_checkout, fresh_variables, run


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of the checkout, as `git clone` gives it."""
    return copy_checkout(tmp_path / "checkout")


@pytest.fixture(scope="session")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the wheel and the sdist, built as for a release, without any warning."""
    folder = tmp_path_factory.mktemp("distributions")
    variables = fresh_variables(folder / "home", TOOLS) | {"PYTHONWARNINGS": "error"}
    make = ["make", "-s", "dist", f"DIST={folder / 'dist'}", "READY="]  # .venv stays as it is
    printed = run(make, ROOT, variables)
    assert "warning" not in printed.lower()
    return folder / "dist"
