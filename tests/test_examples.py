"""Every example runs as it stands."""

import os
import runpy
import shutil
import subprocess
import sys
import wave
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from hilt.ontology.objects import load_objects
from hilt.sim.models.object_models import object_model

ROOT = Path(__file__).parents[1]
EXAMPLES = sorted(path for path in (ROOT / "examples").iterdir() if path.suffix in {".py", ".yaml"})


def output(*arguments: str | Path) -> str:
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


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Callable[..., tuple[str, str]]:
    """Runs commands of Hilt where the example of plug-ins is installed; what they print."""
    folder = tmp_path_factory.mktemp("workshop")
    shutil.copytree(ROOT / "examples" / "workshop", folder / "source")
    offline = ("--no-deps", "--no-build-isolation", "--no-index", "--disable-pip-version-check")
    output("-m", "pip", "install", *offline, "--target", folder / "site", folder / "source")
    variables = {"PYTHONPATH": str(folder / "site"), "HILT_KB": str(folder / "kb")}

    def run(*arguments: str) -> tuple[str, str]:
        program = "from hilt.agent.cli import main; main()"
        found = subprocess.run(
            [sys.executable, "-c", program, *arguments],
            capture_output=True,
            text=True,
            check=False,
            cwd=folder,
            env=os.environ | variables,
        )
        return found.stdout, found.stderr

    with wave.open(str(folder / "x.wav"), "wb") as sound:
        sound.setparams((1, 2, 16_000, 0, "NONE", ""))
        sound.writeframes((40 * b"\x00\x20" + 40 * b"\x00\xe0") * 200)  # one second of 200 Hz
    run("tell", "To pass a knife grab the knife by the blade")
    return run


def test_vision_and_motion_are_plugged_in(workshop: Callable[..., tuple[str, str]]):
    """The camera sees what the scene names, the arm grasps by the part that was told."""
    eyes = ("--vision", "workshop-camera", "--scene", "objects:knife")

    moved = workshop("do", "pass me the knife", *eyes, "--motion", "workshop-arm")
    only_seen = workshop("do", "pass me the knife", *eyes)
    unseen = workshop("do", "pass me the mug", *eyes)

    assert "Here is the knife. I'm holding it by the blade" in moved[0]
    assert moved[1] == "panda: grasp knife by the blade\n"
    assert "I would pass the knife by the blade." in only_seen[0]
    assert "I don't see a mug." in unseen[0]


def test_store_is_plugged_in(workshop: Callable[..., tuple[str, str]]):
    """A file of N-Quads is a base."""
    workshop("export", "kb.nq")

    assert workshop("rules", "--json", "--kb", "quads:kb.nq") == workshop("rules", "--json")
    assert workshop("rules", "--kb", "quads:no.nq")[1] == (
        'hilt: "no.nq" cannot be read: No such file or directory.\n'
    )


def test_robot_is_plugged_in(workshop: Callable[..., tuple[str, str]]):
    """Its name is known beside those that come with Hilt."""
    pass_it = ("do", "pass me the mug", "--kb", "memory:", "--robot")

    assert "There is no robot" not in workshop(*pass_it, "pointer")[1]
    assert 'Did you mean "pointer"? Known: kuka, panda, pointer' in workshop(*pass_it, "pointr")[1]


@pytest.mark.parametrize(
    ("command", "error"),
    [
        (
            ("listen", "x.wav", "--recogniser", "workshop-vosk:none"),
            "hilt: none: expected the folder of a model of Vosk.",
        ),
        (("listen", "x.wav", "--recogniser", "ear"), "Known: workshop-vosk."),
    ],
)
def test_recogniser_is_plugged_in(
    workshop: Callable[..., tuple[str, str]], command: tuple[str, ...], error: str
):
    """It gets what stands behind its name; without its model it says so in a line."""
    pytest.importorskip("pocketsphinx", reason='the extra "speech" is not installed')

    printed = workshop(*command)[1]

    assert error in printed
    assert len(printed.splitlines()) == 1


@pytest.mark.parametrize(
    ("options", "error"),
    [
        (("--vision", "camera"), "Known: learned, learned:FILE, mask, workshop-camera."),
        (("--motion", "workshop-arm"), "a motion needs a vision that is a plug-in too."),
        (("--vision", "workshop-camera", "--motion", "leg"), "Known: workshop-arm."),
        (("--kb", "triples:x"), "expected memory:, a folder, or http(s)://... (plug-ins: quads)"),
    ],
)
def test_unknown_plugin_lists_what_there_is(
    workshop: Callable[..., tuple[str, str]], options: tuple[str, ...], error: str
):
    """In one line."""
    printed = workshop("do", "pass me the knife", *options)[1]

    assert error in printed
    assert len(printed.splitlines()) == 1


@pytest.mark.sim
def test_gymnasium_takes_the_environment_for_one():
    """Its checker finds nothing; only the proper part of the proper thing is rewarded."""
    checker = pytest.importorskip("gymnasium.utils.env_checker", reason="the extra is missing")
    environment = runpy.run_path(str(ROOT / "examples" / "gym_environment.py"))["HandOver"]()

    checker.check_env(environment, skip_render_check=True)

    seen, _ = environment.reset(seed=7)
    proper = environment.choices.index(("hammer", "head"))
    rewards = [environment.step(np.int64(action))[1] for action in (proper, proper - 1)]
    environment.close()
    assert seen["instruction"] == "pass me something used for pounding"
    assert rewards == [1.0, 0.0]


@pytest.mark.sim
@pytest.mark.parametrize(
    ("thing", "part", "robot"),
    [("knife", "blade", "panda"), ("mug", "handle", "panda"), ("screwdriver", "shaft", "kuka")],
)
def test_other_simulator_holds_what_hilt_held(thing: str, part: str, robot: str):
    """MuJoCo brings it up, too; it slides and turns no more in the hand than Hilt allows."""
    pytest.importorskip("mujoco", reason='the extra "bench" is not installed')
    example = runpy.run_path(str(ROOT / "examples" / "mujoco_witness.py"))

    seen = example["main"](thing, part, robot)

    assert seen.held
    assert seen.height_m > 0.30
    assert seen.slip_m < 0.01
    assert seen.turn_deg < 15


@pytest.mark.parametrize("example", EXAMPLES, ids=lambda path: path.name)
def test_example_is_listed(example: Path):
    """The table of examples names each."""
    assert f"[{example.name}]" in (ROOT / "examples" / "README.md").read_text(encoding="utf-8")


@pytest.fixture(scope="module")
def training() -> dict[str, Any]:
    """What the example that trains the recogniser defines."""
    return runpy.run_path(str(ROOT / "examples" / "train_recognition.py"))


@pytest.mark.sim
@pytest.mark.parametrize("name", ["knife", "mug", "block"])
def test_resized_object_keeps_its_form(name: str, training: dict[str, Any]):
    """Its bounds are as many times as far from the origin in each direction."""
    kind = load_objects()[name]
    larger = training["resized"](kind, 1.3)

    bounds, plain = (
        np.array([np.min(points, axis=0), np.max(points, axis=0)])
        for points in (object_model(larger).points, object_model(kind).points)
    )

    assert bounds == pytest.approx(1.3 * plain, abs=1e-5)


def test_resized_nail_stands_in_its_resized_block(training: dict[str, Any]):
    """What stands in another object has its factor, and so have its place and depth there."""
    objects = load_objects()

    seen = [training["varied"](objects, np.random.default_rng(seed)) for seed in range(8)]

    tops = [each["block"].parts["body"].shape[0].form.size[2] for each in seen]
    assert [each["nail"].mount.at[2] for each in seen] == pytest.approx(tops)
    assert len(set(tops)) > 2


@pytest.mark.sim
@pytest.mark.parametrize("seed", range(6))
def test_random_object_can_be_made(seed: int, training: dict[str, Any]):
    """It has a surface, and is of a size that a table can carry."""
    rng, size = np.random.default_rng(seed), np.array([0.2, 0.05, 0.03])

    kind = training["random_object"]("other", [(0.5, 0.5, 0.5)], [size], rng)

    assert 0.02 < np.ptp(object_model(kind).points, axis=0).max() < 0.7


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


def test_joined_networks_give_the_mean_of_their_logits(training: dict[str, Any]):
    """Two networks side by side are one of twice the units."""
    pytest.importorskip("sklearn")
    how = {"count": 3, "units": 5, "epochs": 1, "rng": np.random.default_rng(1)}
    networks = [training["train_classifier"](*rings(300, 0), **how) for _ in range(2)]
    inputs, _ = rings(10, 2)

    mean = np.mean([each.logits(inputs) for each in networks], axis=0)

    assert training["joined"](networks).logits(inputs) == pytest.approx(mean)


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
