# SPDX-License-Identifier: Apache-2.0
"""Every example runs as it stands."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted(path for path in (ROOT / "examples").iterdir() if path.suffix in {".py", ".yaml"})


def output(*arguments: str) -> str:
    """What a Python process prints, which must end well."""
    command = [sys.executable, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT).stdout


def test_own_robot_is_told_what_to_do_and_what_it_cannot():
    """The arm grasps by the blade; pointing is declined in a sentence."""
    out = output("examples/own_robot.py")

    assert "arm: grasp knife by the blade\narm: lift\narm: hand over\n" in out
    assert "sam: scalpel!\nhilt: At your service. Here is the knife. I'm holding it by the" in out
    assert (
        "hilt: Alas. I would point to the knife, but my body can't do that yet: it lacks pointAt"
        in out
    )


def test_knowledge_part_runs_without_the_simulator():
    """Neither PyBullet nor what only the simulator needs is imported."""
    code = (
        "import sys, runpy\n"
        "for name in ('pybullet', 'scipy', 'trimesh', 'imageio', 'PIL'): sys.modules[name] = None\n"
        "runpy.run_path('examples/own_robot.py', run_name='__main__')"
    )

    assert "arm: hand over" in output("-c", code)


def test_kitchen_cuts_with_what_the_general_rules_conclude():
    """Which thing cutWith(X, bread) follows of depends on where the robot is, and is proved."""
    anywhere, kitchen = output("examples/kitchen.py").split("--- place:kitchen")

    assert "hilt: I would cut the bread with the spatula." in anywhere
    assert "hilt: I would cut the bread with the knife." in kitchen
    assert "[0.81, 1.00]  modus ponens  knife affords cutWith(object:bread)" in kitchen
    assert "I was told that a knife won't do." in kitchen
    assert "hilt: I would serve the knife by the blade." in anywhere
    assert "hilt: I would serve the knife by the handle." in kitchen


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example_is_listed(example: Path):
    """The table of examples names each."""
    assert f"[{example.name}]" in (ROOT / "examples" / "README.md").read_text(encoding="utf-8")
