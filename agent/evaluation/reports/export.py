# SPDX-License-Identifier: Apache-2.0
"""Reports as files: a page of HTML, JSON with counts and results, or a CSV line a case."""

from __future__ import annotations

import base64
import csv
import io
import json
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import cast

from ....ontology.errors import DataError, StoreError
from ..case import Case
from ..experiment import Experiment
from ..experiments.decisions import Decisions
from .html import EmbeddedPicture, page
from .summary import EvaluationReport

MOST_PICTURES = 40  # in one page
COLUMNS = ("key", "right", "kind", "principle", "found", "expected", "cpu_s")


def write_report(
    path: Path, experiment: Experiment, cases: Sequence[Case], report: EvaluationReport
) -> None:
    """Write a report; the end of the file's name says in which form.

    Args:
        path: .html, .json or .csv.
        experiment: what was run.
        cases: all of its cases.
        report: what came of them, in the same order.

    Raises:
        DataError: there is no such form.
        StoreError: the file cannot be written.
    """
    check_form(path)
    text = _FORMS[path.suffix](experiment, cases, report)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")
    except OSError as error:
        raise StoreError(f'"{path}" cannot be written: {error.strerror}.') from error


def check_form(path: Path) -> None:
    """Refuse the name of a report that says no form, before hours are spent on it.

    Raises:
        DataError: there is no such form.
    """
    if path.suffix not in _FORMS:
        raise DataError(f"expected a name that ends in {', '.join(_FORMS)}.", source=str(path))


def _html(experiment: Experiment, cases: Sequence[Case], report: EvaluationReport) -> str:
    return page(experiment, cases, report, _pictures(experiment, cases))


def _json(_: Experiment, __: Sequence[Case], report: EvaluationReport) -> str:
    results = [each.result.as_json() for each in report.done]
    return json.dumps(report.as_json() | {"results": results}, ensure_ascii=False, indent=1) + "\n"


def _csv(_: Experiment, __: Sequence[Case], report: EvaluationReport) -> str:
    table = io.StringIO()
    writer = csv.writer(table, lineterminator="\n")
    writer.writerow(COLUMNS)
    for done in report.done:
        row = done.result.as_json() | {"cpu_s": round(done.cpu_s, 6)}
        writer.writerow([row[column] for column in COLUMNS])
    return table.getvalue()


_FORMS: Mapping[str, Callable[[Experiment, Sequence[Case], EvaluationReport], str]] = {
    ".html": _html,
    ".json": _json,
    ".csv": _csv,
}


def _pictures(experiment: Experiment, cases: Sequence[Case]) -> Iterator[EmbeddedPicture]:
    """Each scene of a simulated run as it lay on the table, at most so many."""
    if not isinstance(experiment, Decisions) or not experiment.sim:
        return
    scenes: dict[tuple[str, ...], str] = {}
    for case in cases:
        scene = (*cast("list[str]", case.spec["scene"]), str(case.spec["seed"]))
        scenes.setdefault(scene, case.key.split("/")[1])
    for (*objects, seed), name in list(scenes.items())[:MOST_PICTURES]:
        caption = f"scene {name}, seed {seed}: {', '.join(objects) or 'nothing'}"
        with tempfile.TemporaryDirectory() as folder:
            picture = experiment.picture(objects, int(seed), Path(folder) / "scene.jpg")
            yield EmbeddedPicture(caption, base64.b64encode(picture.read_bytes()).decode(), "jpeg")
