"""A slice of `benchmarks/grasping.py`: every setting, and the tables that are made of it."""

from __future__ import annotations

import importlib
from dataclasses import replace
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from hilt.ontology.objects import load_objects

pytestmark = pytest.mark.sim

OBJECTS = load_objects()
BENCHMARKS = Path(__file__).parents[3] / "benchmarks"


@pytest.fixture
def measure(monkeypatch: pytest.MonkeyPatch) -> ModuleType:
    """The module that measures."""
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    return importlib.import_module("grasping")


@pytest.mark.parametrize(
    ("setting", "name", "part"),
    [
        ("alone", "hammer", "head"),
        ("alone", "spoon", "bowl"),
        ("eight", "screwdriver", "handle"),
        ("twelve", "mug", "barrel"),
        ("noise", "shoe", "sole"),
        ("learned", "knife", "blade"),
        ("kuka", "mug", "handle"),
    ],
)
def test_object_is_grasped_by_the_part_and_handed_over(
    measure: ModuleType, setting: str, name: str, part: str
):
    """Every closing is on the part, the object is handed over, and no neighbour moves."""
    episode = measure.run(measure.SETTINGS[setting], name, part, 905, objects=OBJECTS)

    assert episode.ok and episode.given
    assert (episode.wrong, episode.last.touched, episode.bumped) == (0, (part,), ())


@pytest.mark.parametrize(("setting", "part"), [("alone", "handle"), ("free", "")])
def test_free_part_faces_the_receiver(measure: ModuleType, setting: str, part: str):
    """The hammer's head leads to the receiver, also where the hand chose the handle."""
    episode = measure.run(measure.SETTINGS[setting], "hammer", part, 52000, objects=OBJECTS)

    assert episode.last.touched == ("handle",)
    assert episode.facing_deg < 45


def test_heap_lies_on_one_place_and_is_the_same_again(measure: ModuleType):
    """Eight objects lie in reach, most of them on one another, at the same poses for a seed."""
    scenes = importlib.import_module("grasping_scenes")
    scene = scenes.scene_of("heap", "knife", seed=907, objects=OBJECTS)

    first, again = (scenes.heap(scene, OBJECTS) for _ in range(2))

    at = np.array([pose[:3, 3] for pose in first.values()])
    assert np.median(np.linalg.norm(at[:, :2] - np.median(at[:, :2], axis=0), axis=1)) < 0.12
    assert all(np.array_equal(pose, again[name]) for name, pose in first.items())


def test_recoloured_object_differs_in_its_colours_only(measure: ModuleType):
    """Each part has another colour, and no piece of it keeps its own."""
    mug = OBJECTS["mug"]

    other = importlib.import_module("grasping_scenes").recoloured(mug, seed=908)

    assert all(part.colour != mug.parts[name].colour for name, part in other.parts.items())
    assert all(solid.colour is None for part in other.parts.values() for solid in part.shape)
    assert (other.mass, other.rests) == (mug.mass, mug.rests)


def test_tables_show_parts_times_and_failures(measure: ModuleType):
    """One free episode fills a row of each table, and the times add up to the whole."""
    free = measure.SETTINGS["free"]
    episode = measure.run(free, "knife", "", 906, objects=OBJECTS, bare=True)
    facing = [replace(episode, facing_deg=angle) for angle in (44.0, 46.0)]

    assert sum(episode.shares.values()) == pytest.approx(episode.cpu_s)
    assert 0 < episode.bare_s < episode.cpu_s
    assert "| knife | 1 |" in measure.pair_table([episode])
    assert "| free | 2 |" in (table := measure.summary_table({"free": facing}))
    assert "| 1/2 = 50.0 % |" in table
    assert "stepping" in measure.time_table({"free": [episode]})
    assert "1/1 = 100.0 %" in measure.contrast_table([episode])
