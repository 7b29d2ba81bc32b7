"""Plots of curves with confidence bands, as SVG for embedding in HTML."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence

from ....ontology.errors import extra_required
from ...execution.outcome import Json

SIZE = (6.4, 3.2)  # [in]
# Colours that are distinguishable with colour vision deficiency (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("-", "--", ":", "-.")  # for lines that coincide


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
