"""`benchmarks/mutation.py` on a small program with gaps in its tests that are known."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

TOOL = Path(__file__).parents[2] / "benchmarks" / "mutation.py"
PROGRAM = """\
PRICE = 3
ROUNDING = 2

def is_adult(age):
    return age >= 18

def is_free(age):
    return age < 6

def reduced():
    return PRICE - 1

class Ticket:
    @property
    def price(self):
        return PRICE * 2 if is_adult(20) else 0
"""
TESTS = """\
from inference.planted import PRICE, Ticket, is_adult, is_free

def test_adult():
    assert is_adult(18) and not is_adult(17)

def test_free():
    assert is_free(3) and not is_free(30)

def test_price():
    assert (PRICE, Ticket().price) == (3, 6)
"""
SURVIVORS = """\
survives: inference/planted.py:2 2 -> 3
survives: inference/planted.py:8 age < 6 -> age <= 6
survives: inference/planted.py:8 6 -> 7
survives: inference/planted.py:11 PRICE - 1 -> PRICE + 1
survives: inference/planted.py:11 1 -> 2
survives: inference/planted.py:16 is_adult(20) -> True
survives: inference/planted.py:16 20 -> 21
survives: inference/planted.py:16 0 -> 1
"""


@pytest.fixture
def tree(tmp_path: Path) -> Path:
    """A tree with the tool, a program and its tests."""
    for name, text in {
        "inference/planted.py": PROGRAM,
        "tests/inference/test_it.py": TESTS,
    }.items():
        path = tmp_path / name
        path.parent.mkdir(parents=True)
        path.write_text(text)
    (tmp_path / "benchmarks").mkdir()
    shutil.copy(TOOL, tmp_path / "benchmarks")
    return tmp_path


def run(tree: Path) -> subprocess.CompletedProcess[str]:
    """Run the tool on all of the program."""
    command = [sys.executable, "benchmarks/mutation.py", "--tests", "tests/inference"]
    environment = {**os.environ, "PYTHONPATH": str(tree)}
    return subprocess.run(command, cwd=tree, env=environment, capture_output=True, text=True)


def test_survivors_are_the_changes_that_no_test_notices(tree: Path):
    """Constants, operators and conditions survive where nothing is asserted, and nowhere else."""
    done = run(tree)

    *survivors, summary = done.stdout.splitlines(keepends=True)
    assert sorted(survivors) == sorted(SURVIVORS.splitlines(keepends=True)), done.stderr
    assert summary == "10 of 18 mutants were killed\n"
    assert done.returncode == 1


def test_nothing_is_judged_by_tests_that_fail_without_a_mutant(tree: Path):
    """Where a test fails in any case, no mutant counts as killed."""
    with (tree / "tests/inference/test_it.py").open("a") as tests:
        tests.write("\ndef test_wrong():\n    assert is_free(30)\n")

    done = run(tree)

    assert "fails without any mutant" in done.stderr
    assert (done.returncode, done.stdout) == (1, "")
