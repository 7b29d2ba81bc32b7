"""Export of reports to files: an HTML page, JSON with counts and results, or CSV by case."""

from __future__ import annotations

import base64
import csv
import io
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from importlib.util import find_spec
from pathlib import Path
from typing import cast

from ....ontology.errors import DataError, MissingExtraError, StoreError
from ..experiment import Case, Experiment
from ..experiments.command_experiment import DecisionExperiment
from .html import EmbeddedPicture, render_page
from .summary import EvaluationReport

MAX_PICTURES = 40  # on a page
COLUMNS: Sequence[str] = ("key", "right", "kind", "principle", "found", "expected", "cpu_s")


def write_report(
    path: Path, experiment: Experiment, cases: Sequence[Case], report: EvaluationReport
) -> None:
    """Write the report of all cases, in their order, as .html, .json or .csv.

    Raises:
        DataError: there is no such format.
        MissingExtraError: a package for HTML pages is not installed.
        StoreError: the file cannot be written.
    """
    check_format(path)
    text = _FORMATS[path.suffix](experiment, cases, report)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise StoreError(f'"{path}" cannot be written: {error.strerror}.') from error


def check_format(path: Path) -> None:
    """Check before a long run that a report can be written.

    Raises:
        DataError: there is no such format.
        MissingExtraError: a package for HTML pages is not installed.
    """
    if path.suffix not in _FORMATS:
        raise DataError(f"expected a name that ends in {', '.join(_FORMATS)}.", source=str(path))
    for package in ("jinja2", "matplotlib") if path.suffix == ".html" else ():
        if find_spec(package) is None:
            raise MissingExtraError("report", package)


def _json(_: Experiment, __: Sequence[Case], report: EvaluationReport) -> str:
    document = report.as_json() | {"results": report.results}
    return json.dumps(document, default=vars, ensure_ascii=False, indent=1) + "\n"


def _csv(_: Experiment, __: Sequence[Case], report: EvaluationReport) -> str:
    table = io.StringIO()
    writer = csv.DictWriter(table, COLUMNS, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(vars(run.result) | {"cpu_s": round(run.cpu_s, 6)} for run in report.runs)
    return table.getvalue()


_FORMATS: Mapping[str, Callable[[Experiment, Sequence[Case], EvaluationReport], str]] = {
    ".html": lambda experiment, cases, report: render_page(
        experiment, cases, report, _pictures(experiment, cases)
    ),
    ".json": _json,
    ".csv": _csv,
}


def _pictures(experiment: Experiment, cases: Sequence[Case]) -> Iterator[EmbeddedPicture]:
    if not isinstance(experiment, DecisionExperiment) or not experiment.sim:
        return
    scenes: dict[tuple[str, ...], str] = {}
    for case in cases:
        scene = (*cast("list[str]", case.spec["scene"]), str(case.spec["seed"]))
        scenes.setdefault(scene, case.key.split("/")[1])
    for (*objects, seed), name in list(scenes.items())[:MAX_PICTURES]:
        caption = f"scene {name}, seed {seed}: {', '.join(objects) or 'nothing'}"
        with tempfile.TemporaryDirectory() as folder:
            picture = experiment.picture(objects, int(seed), Path(folder) / "scene.jpg")
            yield EmbeddedPicture(caption, base64.b64encode(picture.read_bytes()).decode())
