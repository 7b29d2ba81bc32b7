"""The report of a run as a self-contained HTML page: no scripts, fonts or separate pictures.

It contains counts, curves, pictures of simulated scenes, all cases, and their explanations. Equal
explanations are shown once, and the cases link to them. The template is `page.html`.
"""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from platform import python_version
from typing import cast

from ....ontology.errors import extra_required
from ...execution.outcome import Json
from ..case import Case
from ..experiment import Experiment
from .plots import plot_curve
from .summary import EvaluationReport, as_text

TEMPLATE = Path(__file__).with_name("page.html")
COUNTS = ("runs", "right", "unique", "ties", "none", "executed", "succeeded", "grasps")


@dataclass(frozen=True)
class EmbeddedPicture:
    """A picture with its caption, embedded in a page as base64 of a JPEG."""

    caption: str
    data: str


def render_page(
    experiment: Experiment,
    cases: Sequence[Case],
    report: EvaluationReport,
    pictures: Iterable[EmbeddedPicture] = (),
) -> str:
    """Return the HTML page of the report of all cases, in their order, with pictures of scenes.

    Raises:
        MissingExtraError: jinja2 or matplotlib is not installed.
    """
    with extra_required("report", "jinja2"):
        from jinja2 import Environment, StrictUndefined

    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True
    )
    explanations: dict[str, int] = {}  # text -> its number on the page
    rows = [
        (result, text and explanations.setdefault(text, len(explanations) + 1))
        for case, result in zip(cases, report.results, strict=True)
        for text in [experiment.explain(case, result)]
    ]
    counts = report.as_json()
    principles = cast("dict[str, dict[str, int]]", counts["by_principle"])
    summary = {name: value for name, value in report.summary.items() if name != "curves"}
    return environment.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        name=report.name,
        made=f"{datetime.now(UTC):%d %B %Y %H:%M} UTC, Hilt {version('hilt')}, "
        f"Python {python_version()}",
        options=", ".join(f"{name} {json.dumps(value)}" for name, value in report.options.items()),
        counts={n: counts[n] for n in COUNTS if counts[n] or n in {"runs", "right"}},
        principles=[(n, each["runs"], each["right"]) for n, each in principles.items()],
        summary=[(name.replace("_", " "), as_text(value)) for name, value in summary.items()],
        curves=list(_curves(cast("list[Json]", report.summary.get("curves", [])))),
        pictures=list(pictures),
        cases=rows,
        explanations=list(explanations),
    )


def _curves(curves: Sequence[Json]) -> Iterator[Json]:
    for curve in curves:
        label, lines = str(curve["label"]), cast("dict[str, list[Json]]", curve["lines"])
        measure = str(curve.get("measure", "accuracy"))
        columns = list(next(iter(lines.values()))[0])
        yield {
            "name": curve["curve"],
            "label": label,
            "measure": measure,
            "svg": plot_curve(label, lines, measure),
            "head": ("line", *columns),
            "rows": [
                (line, *(point[column] for column in columns))
                for line, points in lines.items()
                for point in points
            ],
        }
