"""Drawing of the proof of a decision: a tree of boxes in SVG, the conclusion on top."""

from __future__ import annotations

from collections.abc import Iterator
from io import StringIO
from itertools import chain
from textwrap import wrap
from typing import NamedTuple

from ...inference.proof import LEAVES, Proof
from ...ontology.errors import extra_required
from ..execution.outcome import Decision

WIDTH, HEIGHT = 2.6, 1.2  # of the place of one box, with the space around it [inch]
COLUMNS, MOST_LINES = 32, 3  # of the text about a step
_COLOURS = {
    "told": "#fdf1d6",
    "seen": "#dcecf7",
    "given": "#e3f1de",
    "unknown": "#eeeeee",
    "experienced": "#eadff2",
}
_LEGEND = {
    "told": "taught rule",
    "seen": "observation",
    "given": "context",
    "unknown": "ignorance",
    "experienced": "experience",
}


class _Box(NamedTuple):
    proof: Proof
    column: float
    row: int
    inputs: tuple[_Box, ...]

    def boxes(self) -> Iterator[_Box]:
        yield self
        for each in self.inputs:
            yield from each.boxes()


def draw_svg(decision: Decision) -> str:
    """Return the proofs of the chosen object and part, side by side, as an SVG document.

    Raises:
        MissingExtraError: matplotlib is not installed.
    """
    with extra_required("report", "matplotlib"):
        from matplotlib import rc_context
        from matplotlib.figure import Figure
        from matplotlib.patches import Patch
    roots: list[_Box] = []
    columns = 0
    for proof in decision.proofs():
        root, width = _place(proof, columns, 0)
        roots.append(root)
        columns += width
    boxes = list(chain.from_iterable(root.boxes() for root in roots))
    rows = 1 + max((box.row for box in boxes), default=0)
    columns = max(columns, 2)  # room for the legend
    figure = Figure(figsize=(WIDTH * columns, HEIGHT * (rows + 0.5)))
    axes = figure.add_axes((0, 0, 1, 1), xlim=(-0.5, columns - 0.5), ylim=(rows, -0.5))
    axes.set_axis_off()
    for box in boxes:
        for each in box.inputs:
            axes.plot([box.column, each.column], [box.row, each.row], color="#888888", zorder=1)
        colour = _COLOURS[box.proof.step] if box.proof.step in LEAVES else "white"
        style = {"boxstyle": "round,pad=0.5", "facecolor": colour, "edgecolor": "#555555"}
        axes.text(
            box.column, box.row, _text(box.proof), bbox=style, ha="center", va="center", size=8
        )
    used = {box.proof.step for box in boxes}
    keys = [
        Patch(facecolor=_COLOURS[step], edgecolor="#555555", label=label)
        for step, label in _LEGEND.items()
        if step in used
    ]
    axes.legend(handles=keys, loc="lower left", ncol=len(keys) or 1, frameon=False, fontsize=8)
    drawing = StringIO()
    with rc_context({"svg.fonttype": "none", "svg.hashsalt": "proof"}):
        figure.savefig(drawing, format="svg", metadata={"Date": None})
    return drawing.getvalue()


def _place(proof: Proof, column: float, row: int) -> tuple[_Box, int]:
    """A step with all steps below it, and how many columns they take."""
    inputs: list[_Box] = []
    width = 0
    for each in proof.inputs:
        box, taken = _place(each, column + width, row + 1)
        inputs.append(box)
        width += taken
    width = max(width, 1)
    return _Box(proof, column + (width - 1) / 2, row, tuple(inputs)), width


def _text(proof: Proof) -> str:
    about = wrap(proof.about, COLUMNS, max_lines=MOST_LINES, placeholder=" …")
    return "\n".join((f"{proof.interval}  {proof.step}", *about))
