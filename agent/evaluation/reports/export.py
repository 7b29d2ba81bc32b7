"""Export of reports to files: an HTML page, JSON with counts and results, or CSV by case.

The page is self-contained: no scripts, fonts or separate pictures. It contains counts, curves,
pictures of simulated scenes, all cases, and their explanations. Equal explanations are shown once,
and the cases link to them. The template is `page.html`.
"""

import base64
import csv
import io
import json
import tempfile
from collections.abc import Iterable, Iterator, Mapping, Sequence
from datetime import datetime, timezone
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path
from platform import python_version

from ....ontology.disk_cache import write_atomically
from ....ontology.errors import DataError, MissingExtraError, StoreError, extra_required
from ..experiment import Case, Experiment, Json
from ..experiments.decisions import DecisionExperiment
from .summary import EvaluationReport, as_text

FORMATS = (".html", ".json", ".csv")
MAX_PICTURES = 40  # on a page
COLUMNS: Sequence[str] = ("key", "right", "kind", "principle", "found", "expected", "cpu_s")
TEMPLATE = Path(__file__).with_name("page.html")
SIZE = (6.4, 3.2)  # [in]
# Colours that are distinguishable with colour vision deficiency (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("-", "--", ":", "-.")  # for lines that coincide
COUNTS = ("runs", "right", "unique", "ties", "none", "executed", "succeeded", "grasps")


def write_report(
    path: Path, experiment: Experiment, cases: Sequence[Case], report: EvaluationReport
) -> None:
    """Write the report of all cases, in their order, as .html, .json or .csv.

    DataError if there is no such format; MissingExtraError if a package for HTML pages is not
    installed; StoreError if the file cannot be written.
    """
    check_format(path)
    match path.suffix:
        case ".json":
            document = report.as_json() | {"results": report.results}
            text = json.dumps(document, default=vars, ensure_ascii=False, indent=1) + "\n"
        case ".csv":
            text = _csv(report)
        case _:
            text = render_page(experiment, cases, report, _pictures(experiment, cases))
    try:
        write_atomically(path, text)
    except OSError as error:
        raise StoreError(f'"{path}" cannot be written: {error.strerror}.') from error


def check_format(path: Path) -> None:
    """Check before a long run that a report can be written.

    DataError if there is no such format; MissingExtraError if a package for HTML pages is not
    installed.
    """
    if path.suffix not in FORMATS:
        raise DataError(f"expected a name that ends in {', '.join(FORMATS)}.", source=str(path))
    for package in ("jinja2", "matplotlib") if path.suffix == ".html" else ():
        if find_spec(package) is None:
            raise MissingExtraError("report", package)


def _csv(report: EvaluationReport) -> str:
    table = io.StringIO()
    writer = csv.DictWriter(table, COLUMNS, extrasaction="ignore", lineterminator="\n")
    writer.writeheader()
    writer.writerows(vars(run.result) | {"cpu_s": round(run.cpu_s, 6)} for run in report.runs)
    return table.getvalue()


def _pictures(experiment: Experiment, cases: Sequence[Case]) -> Iterator[tuple[str, str]]:
    if not isinstance(experiment, DecisionExperiment) or not experiment.sim:
        return
    scenes: dict[tuple[str, ...], str] = {}
    for case in cases:
        scene = (*case.spec["scene"], str(case.spec["seed"]))
        scenes.setdefault(scene, case.key.split("/")[1])
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
    """Return the HTML page of the report of all cases, in their order, with pictures of scenes.

    A picture is its caption and the base64 of a JPEG. MissingExtraError if jinja2 or matplotlib is
    not installed.
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

    A line is a list of points, each with `x`, the measure, `lower` and `upper`. MissingExtraError
    if matplotlib is not installed.
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
