"""Every example runs as it stands."""

import runpy
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
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


@pytest.fixture(scope="module")
def training() -> dict[str, Any]:
    """What the example that trains the recogniser defines."""
    return runpy.run_path(str(ROOT / "examples" / "train_recognition.py"))


def rings(count: int, seed: int, noise: float = 0.4) -> tuple[np.ndarray, np.ndarray]:
    """Points on three rings round each other, which no straight line separates."""
    rng = np.random.default_rng(seed)
    classes = rng.integers(0, 3, count)
    angle, radius = rng.uniform(0, 2 * np.pi, count), 1.0 + classes + rng.normal(0, noise, count)
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)]), classes


def test_training_learns_rings_with_calibrated_probabilities(training: dict[str, Any]):
    """Clean rings are told apart; of noisy ones the expected calibration error is small."""
    pytest.importorskip("sklearn")
    how = {"count": 3, "units": 24, "epochs": 60}
    first, second = (
        training["train_classifier"](*rings(3000, 0), **how, rng=np.random.default_rng(1))
        for _ in range(2)
    )
    clean, clean_classes = rings(500, 2, noise=0.05)
    inputs, classes = rings(4000, 4)

    probabilities = training["calibrated"](first, *rings(2000, 3)).probabilities(inputs)

    assert (first.hidden == second.hidden).all()  # the same seed
    assert (first.probabilities(clean).argmax(axis=1) == clean_classes).mean() > 0.97
    sure, right = probabilities.max(axis=1), probabilities.argmax(axis=1) == classes
    bins = np.minimum((sure * 10).astype(int), 9)
    errors = [abs(sure[bins == b].mean() - right[bins == b].mean()) for b in np.unique(bins)]
    assert np.average(errors, weights=np.bincount(bins)[np.unique(bins)]) < 0.05


def test_one_outlier_does_not_widen_what_is_known(training: dict[str, Any]):
    """Known inputs keep their confidence; a class without held-out inputs has a limit as well."""
    rng = np.random.default_rng(7)
    classes = np.repeat(np.arange(3), 60)
    inputs, held = (9.0 * np.eye(3)[classes] + rng.normal(0, 0.2, (180, 3)) for _ in range(2))
    held[0] = 50.0
    kept = classes < 2

    novelty = training["fit_novelty"](inputs, classes, held[kept], classes[kept], count=30)

    known = [novelty.confidence(*pair) == 1.0 for pair in zip(inputs, classes, strict=True)]
    assert np.mean(known) > 0.95
    assert 0 < novelty.limit.min() <= novelty.limit.max() < 1.3 * np.median(novelty.limit)
    assert novelty.confidence(np.full(3, 4.5), 2) < 0.05
