"""Models of objects: built once, kept, and never half written."""

import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from pathlib import Path

import pytest

from hilt.ontology.errors import SimulationError
from hilt.ontology.objects import load_objects
from hilt.sim.models import object_models
from hilt.sim.models.object_models import object_model

KNIFE = load_objects()["knife"]


def test_model_is_built_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """The second time, the files of the first are used."""
    first = object_model(KNIFE, cache=tmp_path)
    monkeypatch.setattr(object_models, "write_model", lambda *_: pytest.fail("built again"))

    second = object_model(KNIFE, cache=tmp_path)

    assert second.urdf == first.urdf
    assert (second.points == first.points).all()


def test_other_processes_use_the_same_files(tmp_path: Path):
    """What one process has built is found by another, whatever its hashes are."""
    program = (
        "from hilt.ontology.objects import load_objects\n"
        "from hilt.sim.models.object_models import object_model\n"
        "print(object_model(load_objects()['knife']).urdf)"
    )

    found = {
        subprocess.run(
            [sys.executable, "-c", program],
            env={**os.environ, "HILT_CACHE": str(tmp_path), "PYTHONHASHSEED": seed},
            capture_output=True,
            text=True,
            check=True,
        ).stdout
        for seed in ("1", "2")
    }

    assert len(found) == 1


def test_changed_object_is_another_model(tmp_path: Path):
    """A knife whose handle is heavier has files of its own."""
    heavier = replace(KNIFE.part("handle"), mass=0.5)
    other = replace(KNIFE, parts={**KNIFE.parts, "handle": heavier})

    assert object_model(other, cache=tmp_path).urdf != object_model(KNIFE, cache=tmp_path).urdf


def test_builders_at_the_same_time_agree(tmp_path: Path):
    """Several that build the same model at once all get it, and leave no drafts behind."""
    with ThreadPoolExecutor(4) as pool:
        built = list(pool.map(lambda _: object_model(KNIFE, cache=tmp_path), range(4)))

    assert len({model.urdf for model in built}) == 1
    assert len(list((tmp_path / "objects").iterdir())) == 1


def test_failed_build_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """When building fails half way, no folder looks like a model."""

    def fail(_kind: object, folder: Path) -> None:
        folder.mkdir()
        (folder / "model.urdf").write_text("half", encoding="utf-8")
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(object_models, "write_model", fail)

    with pytest.raises(SimulationError, match=r"No space left on device. Set HILT_CACHE"):
        object_model(KNIFE, cache=tmp_path)
    assert not list((tmp_path / "objects").iterdir())


def test_folder_that_cannot_be_written_is_told(tmp_path: Path):
    """A cache that is a file is told, with the way out."""
    (tmp_path / "objects").write_text("", encoding="utf-8")

    with pytest.raises(SimulationError, match=r"cannot be written.*Set HILT_CACHE"):
        object_model(KNIFE, cache=tmp_path)


def test_silhouette_is_about_what_it_covers():
    """Lying on a table, a knife shows its sides foreshortened: half to all of its area."""
    silhouette = object_model(KNIFE).silhouette

    assert 0.5 * 0.0085 < silhouette < 0.0085
