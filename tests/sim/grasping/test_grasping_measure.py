"""A slice of `benchmarks/grasping.py`: every setting, and the tables that are made of it."""

from __future__ import annotations

import importlib
from pathlib import Path
from types import ModuleType

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
        ("crowd", "screwdriver", "handle"),
        ("noise", "shoe", "sole"),
        ("kuka", "mug", "handle"),
    ],
)
def test_object_is_grasped_by_the_part_and_handed_over(
    measure: ModuleType, setting: str, name: str, part: str
):
    """Every closing is on the part, the object is handed over, and no neighbour moves."""
    episode = measure.run(measure.SETTINGS[setting], name, part, 905, objects=OBJECTS)

    assert episode.ok and episode.given
    assert (episode.wrong, episode.last.touched, episode.last.bumped) == (0, (part,), ())


def test_tables_show_parts_times_and_failures(measure: ModuleType):
    """One free episode fills a row of each table, and the times add up to the whole."""
    free = measure.SETTINGS["free"]
    episode = measure.run(free, "knife", "", 906, objects=OBJECTS, bare=True)

    assert sum(episode.shares.values()) == pytest.approx(episode.cpu_s)
    assert 0 < episode.bare_s < episode.cpu_s
    assert "| knife | 1 |" in measure.pair_table([episode])
    assert "| free | 1 |" in measure.summary_table({"free": [episode]})
    assert "stepping" in measure.time_table({"free": [episode]})
    assert "1/1 = 100.0 %" in measure.contrast_table([episode])
