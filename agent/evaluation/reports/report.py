"""The results of a run, counted, and their export: an HTML page, JSON, or CSV by case.

The page is self-contained: no scripts, fonts or separate pictures. It contains counts, curves,
pictures of simulated scenes, all cases, and their explanations. Equal explanations are shown once,
and the cases link to them. The template is `page.html`.
"""

import base64
import csv
import io
import json
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from datetime import datetime, timezone
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from platform import python_version
from typing import Any, cast

from rich.table import Table

from ....ontology.disk_cache import write_atomically
from ....ontology.errors import DataError, MissingExtraError, StoreError
from ...presentation.console import table, yes_or_no
from ..experiment import Case, CaseResult, Experiment, Json, TimedResult
from ..experiments.decisions import DecisionExperiment

FORMATS = (".html", ".json", ".csv")
MAX_PICTURES = 40  # on a page
COLUMNS: Sequence[str] = ("key", "right", "kind", "principle", "found", "expected", "cpu_s")
TEMPLATE = Path(__file__).with_name("page.html")
SIZE = (6.4, 3.2)  # [in]
# Colours that are distinguishable with colour vision deficiency (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("-", "--", ":", "-.")  # for lines that coincide
COUNTS = ("runs", "right", "unique", "ties", "none", "executed", "succeeded", "grasps")


@dataclass(frozen=True)
class EvaluationReport:
    """The results of an experiment with its options; `runs` are in the order of the cases."""

    name: str
    options: Mapping[str, object]
    runs: tuple[TimedResult, ...]
    summary: Json = field(default_factory=dict[str, Any])

    @classmethod
    def from_runs(cls, experiment: Experiment, runs: Sequence[TimedResult]) -> "EvaluationReport":
        """Return the report of a run of an experiment."""
        summary = experiment.summary([run.result for run in runs])
        return cls(experiment.name, experiment.options, tuple(runs), summary)

    @property
    def results(self) -> tuple[CaseResult, ...]:
        """The results without processor times."""
        return tuple(run.result for run in self.runs)

    @property
    def is_right(self) -> bool:
        """Whether every case is right."""
        return all(result.right for result in self.results)

    def as_json(self) -> Json:
        """Return the JSON object that `hilt evaluate --json` prints."""
        return self.counts() | {"cpu_s": round(sum(run.cpu_s for run in self.runs), 3)}

    def counts(self) -> Json:
        """Return the values that are equal in every run of the experiment."""
        kinds = Counter(result.kind for result in self.results)
        wrong = [result for result in self.results if not result.right]
        grasps = [r.facts["right_part"] for r in self.results if "right_part" in r.facts]
        executed = [r.facts["success"] for r in self.results if "success" in r.facts]
        # The principles are about decisions, not about their execution.
        right = Counter(r.principle for r in self.results if r.facts.get("decided", r.right))
        asked = Counter(r.principle for r in self.results if r.principle)
        return {
            "name": self.name,
            "runs": len(self.results),
            "right": len(self.results) - len(wrong),
            "by_principle": {str(n): {"runs": asked[n], "right": right[n]} for n in sorted(asked)},
            "unique": kinds["unique"],
            "ties": kinds["tie"],
            "none": kinds["none"],
            "errors": kinds["error"] + kinds["lost"],
            "executed": len(executed),
            "succeeded": sum(bool(each) for each in executed),
            "grasps": len(grasps),
            "right_part": sum(bool(each) for each in grasps),
            "wrong": [f"{r.key}: {r.found}; expected {r.expected}" for r in wrong],
            "seed": self.options.get("seed", 0),
            "options": dict(self.options),
            **self.summary,
        }

    def table(self) -> Table:
        """Return a table of the cases."""
        rows = ((r.key, r.found, r.expected, yes_or_no(r.right)) for r in self.results)
        return table(("case", "chosen", "expected", "right"), rows)

    def lines(self) -> list[str]:
        """Return the summary as lines of text: wrong cases, quantities, and last the count."""
        counts = self.counts()
        right, runs = counts["right"], counts["runs"]
        principles = counts["by_principle"].items()
        summary = {name: value for name, value in self.summary.items() if name != "curves"}
        return [
            *(f"wrong: {each}" for each in counts["wrong"]),
            *(f"principle {n}: {each['right']} of {each['runs']} right" for n, each in principles),
            *(f"{name.replace('_', ' ')}: {as_text(value)}" for name, value in summary.items()),
            f"{self.name}: {right} of {runs} right (seed {counts['seed']})",
        ]

    def points(self) -> Table | None:
        """Return a table of the points of the curves; None if there are none."""
        rows: list[Sequence[object]] = []
        for curve in self.summary.get("curves", ()):
            measure, form = curve.get("measure", "accuracy"), ".2f" if "measure" in curve else ".1%"
            for line, points in curve["lines"].items():
                for at in points:
                    band = f"{at['lower']:{form}} to {at['upper']:{form}}"
                    shown = (f"{at['x']:g}", f"{at[measure]:{form}}", band, at["decisions"])
                    rows.append((curve["curve"], line, *shown))
        columns = ("curve", "line", "at", "mean", "95 % interval", "decisions")
        return table(columns, rows) if rows else None


def as_text(value: object) -> str:
    """Return a JSON value as readable text."""
    if isinstance(value, dict):
        pairs = cast("Json", value).items()
        return "; ".join(f"{name.replace('_', ' ')}: {as_text(each)}" for name, each in pairs)
    if isinstance(value, list):
        return ", ".join(map(as_text, cast("list[object]", value))) or "none"
    if isinstance(value, bool):
        return "yes" if value else "no"
    return f"{value:,}" if isinstance(value, int) else str(value)


def write_report(
    path: Path, experiment: Experiment, cases: Sequence[Case], report: EvaluationReport
) -> None:
    """Write the report of all cases, in their order; StoreError if that cannot be.

    The file ends in .html, .json or .csv, else DataError, or MissingExtraError.
    """
    check_format(path)
    match path.suffix:
        case ".json":
            document = report.as_json() | {"results": report.results}
            text = json.dumps(document, default=vars, ensure_ascii=False, indent=1) + "\n"
        case ".csv":
            table = io.StringIO()
            writer = csv.DictWriter(table, COLUMNS, extrasaction="ignore", lineterminator="\n")
            writer.writeheader()
            rows = (vars(each.result) | {"cpu_s": round(each.cpu_s, 6)} for each in report.runs)
            writer.writerows(rows)
            text = table.getvalue()
        case _:
            text = render_page(experiment, cases, report, _pictures(experiment, cases))
    try:
        write_atomically(path, text)
    except OSError as error:
        raise StoreError(f'"{path}" cannot be written: {error.strerror}.') from error


def check_format(path: Path) -> None:
    """Check before a long run that a report can be written; else DataError or MissingExtraError."""
    if path.suffix not in FORMATS:
        raise DataError(f"expected a name that ends in {', '.join(FORMATS)}.", source=str(path))
    for package in ("jinja2", "matplotlib") if path.suffix == ".html" else ():
        if find_spec(package) is None:
            raise MissingExtraError("report", package)


def _pictures(experiment: Experiment, cases: Sequence[Case]) -> Iterator[tuple[str, str]]:
    if not isinstance(experiment, DecisionExperiment) or not experiment.sim:
        return
    scenes: dict[tuple[str, ...], str] = {}
    for case in cases:
        scenes.setdefault((*case.spec["scene"], str(case.spec["seed"])), case.key.split("/")[1])
    for (*objects, seed), name in list(scenes.items())[:MAX_PICTURES]:
        caption = f"scene {name}, seed {seed}: {', '.join(objects) or 'nothing'}"
        with tempfile.TemporaryDirectory() as folder:
            picture = experiment.picture(objects, int(seed), Path(folder) / "scene.jpg")
            yield caption, base64.b64encode(picture.read_bytes()).decode()


def render_page(
    experiment: Experiment,
    cases: Sequence[Case],
    report: EvaluationReport,
    pictures: Iterable[tuple[str, str]] = (),
) -> str:
    """Return the HTML page of the report of all cases, in their order.

    Pictures of scenes are captions with the base64 of a JPEG.
    """
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
    summary = {name: value for name, value in report.summary.items() if name != "curves"}
    return environment.from_string(TEMPLATE.read_text(encoding="utf-8")).render(
        name=report.name,
        made=f"{datetime.now(timezone.utc):%d %B %Y %H:%M} UTC, Hilt {version('hilt')}, "
        f"Python {python_version()}",
        options=", ".join(f"{name} {json.dumps(value)}" for name, value in report.options.items()),
        counts={n: counts[n] for n in COUNTS if counts[n] or n in {"runs", "right"}},
        principles=[(n, each["runs"], each["right"]) for n, each in counts["by_principle"].items()],
        summary=[(name.replace("_", " "), as_text(value)) for name, value in summary.items()],
        curves=report.summary.get("curves", ()),
        plot=plot_curve,
        pictures=list(pictures),
        cases=rows,
        explanations=list(explanations),
    )


def plot_curve(label: str, lines: Mapping[str, Sequence[Json]], measure: str = "accuracy") -> str:
    """Return the SVG element of a plot of a measure against the quantity of the label.

    A line is a list of points, each with `x`, the measure, `lower` and `upper`.
    """
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
        axes.set_ylabel(measure)
        if measure == "accuracy":
            axes.yaxis.set_major_formatter(PercentFormatter(1))
        axes.grid(axis="y", color="#e3e7ed")
        axes.spines[["top", "right", "left"]].set_visible(False)
        axes.tick_params(length=0, colors="#3d4755")
        if len(lines) > 1:
            axes.legend(loc="center left", bbox_to_anchor=(1, 0.5), frameon=False)
        file, metadata = io.StringIO(), dict.fromkeys(["Creator", "Date", "Format", "Type"])
        figure.savefig(file, format="svg", metadata=metadata)
    svg = file.getvalue()
    return svg[svg.index("<svg") :]
