"""The distributions that the tests of the package install."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from .environments import copy_checkout, fresh_variables, run


@pytest.fixture
def checkout(tmp_path: Path) -> Path:
    """A copy of the checkout, as `git clone` gives it."""
    return copy_checkout(tmp_path / "checkout")


@pytest.fixture(scope="session")
def distributions(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder with the wheel and the sdist, built with every warning an error."""
    folder = tmp_path_factory.mktemp("distributions")
    variables = fresh_variables(folder / "home") | {"PYTHONWARNINGS": "error"}
    build = [sys.executable, "-W", "error", "-m", "build", "--no-isolation"]
    printed = run(build, copy_checkout(folder / "checkout"), variables)
    assert "warning" not in printed.lower()
    return folder / "checkout" / "dist"
