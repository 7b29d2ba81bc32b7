"""The report of a run as a self-contained HTML page: no scripts, fonts or separate pictures.

It contains counts, curves, pictures of simulated scenes, all cases, and their explanations. Equal
explanations are shown once, and the cases link to them. The template is `page.html`.
"""

from __future__ import annotations

import io
import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime, timezone
from importlib.metadata import version
from pathlib import Path
from platform import python_version
from typing import cast

from ....ontology.errors import extra_required
from ...execution.outcome import Json
from ..experiment import Case, Experiment
from .summary import EvaluationReport, as_text

TEMPLATE = Path(__file__).with_name("page.html")
SIZE = (6.4, 3.2)  # [in]
# Colours that are distinguishable with colour vision deficiency (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("-", "--", ":", "-.")  # for lines that coincide
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
        made=f"{datetime.now(timezone.utc):%d %B %Y %H:%M} UTC, Hilt {version('hilt')}, "
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


def plot_curve(label: str, lines: Mapping[str, Sequence[Json]], measure: str = "accuracy") -> str:
    """Return the SVG element of a plot of a measure against the quantity of the label.

    A line is a list of points, each with `x`, the measure, `lower` and `upper`.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    with extra_required("report", "matplotlib"):
        from matplotlib import rc_context
        from matplotlib.figure import Figure
        from matplotlib.ticker import PercentFormatter

    # Text stays text in the font of the page; identifiers are reproducible and unique to the plot.
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": label, "font.size": 9}):
        figure = Figure(figsize=SIZE, layout="constrained")
        axes = figure.add_subplot()
        for i, (name, points) in enumerate(lines.items()):
            x, mean, lower, upper = (
                [float(str(point[key])) for point in points]
                for key in ("x", measure, "lower", "upper")
            )
            colour, dash = COLOURS[i % len(COLOURS)], DASHES[i % len(DASHES)]
            axes.plot(x, mean, dash, color=colour, label=name, marker="o", markersize=4)
            axes.fill_between(x, lower, upper, color=colour, alpha=0.13, linewidth=0)
        axes.set_xlabel(label)
        if measure == "accuracy":
            axes.set_ylim(-0.02, 1.02)
            axes.yaxis.set_major_formatter(PercentFormatter(1))
        else:
            axes.set_ylabel(measure)
        axes.grid(axis="y", color="#e3e7ed")
        axes.spines[["top", "right", "left"]].set_visible(False)
        axes.tick_params(length=0, colors="#3d4755")
        if len(lines) > 1:
            axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
        file, metadata = io.StringIO(), dict.fromkeys(["Creator", "Date", "Format", "Type"])
        figure.savefig(file, format="svg", metadata=metadata)
    svg = file.getvalue()
    return svg[svg.index("<svg") :]
