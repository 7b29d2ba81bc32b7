# SPDX-License-Identifier: Apache-2.0
"""A decision's proof as a picture: a tree of boxes in SVG, the conclusion on top.

The picture is laid out by widths alone: a step stands above the middle of what it rests on. It
needs no other program and no font but the viewer's own.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from textwrap import wrap
from xml.sax.saxutils import escape

from ...inference.proof import LEAVES, Proof
from ..execution.outcome import Decision

BOX_WIDTH, BOX_HEIGHT = 210, 74  # [px]
GAP_X, GAP_Y, MARGIN = 18, 34, 20  # [px]
LINE, LETTERS, MOST_LINES = 14, 32, 3
_FILLS = {"told": "#fdf1d6", "seen": "#dcecf7", "given": "#e3f1de", "unknown": "#eeeeee"}
_OPERATOR_FILL = "#ffffff"


@dataclass(frozen=True)
class _Box:
    """One step with its place: left edge and row."""

    proof: Proof
    x: float
    row: int
    inputs: tuple[_Box, ...]

    def __iter__(self) -> Iterator[_Box]:
        yield self
        for each in self.inputs:
            yield from each


def svg(decision: Decision) -> str:
    """The proofs of the chosen object and part, side by side, as an SVG document."""
    boxes: list[_Box] = []
    left = float(MARGIN)
    for proof in decision.proofs():
        box, width = _placed(proof, left, 0)
        boxes.append(box)
        left += width + GAP_X
    rows = 1 + max((each.row for box in boxes for each in box), default=0)
    height = 2 * MARGIN + rows * BOX_HEIGHT + (rows - 1) * GAP_Y
    drawn = "\n".join(line for box in boxes for each in box for line in _drawn(each))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{left + MARGIN:.0f}" '
        f'height="{height}" font-family="sans-serif" font-size="11">\n'
        f'<rect width="100%" height="100%" fill="#ffffff"/>\n{drawn}\n</svg>\n'
    )


def _placed(proof: Proof, left: float, row: int) -> tuple[_Box, float]:
    """A step with all below it, and how wide they are together."""
    inputs: list[_Box] = []
    at = left
    for each in proof.inputs:
        box, width = _placed(each, at, row + 1)
        inputs.append(box)
        at += width + GAP_X
    width = max(at - GAP_X - left, BOX_WIDTH) if inputs else BOX_WIDTH
    return _Box(proof, left + (width - BOX_WIDTH) / 2, row, tuple(inputs)), width


def _top(box: _Box) -> float:
    return MARGIN + box.row * (BOX_HEIGHT + GAP_Y)


def _drawn(box: _Box) -> Iterator[str]:
    middle = box.x + BOX_WIDTH / 2
    for each in box.inputs:
        yield (
            f'<line x1="{each.x + BOX_WIDTH / 2:.1f}" y1="{_top(each)}" x2="{middle:.1f}" '
            f'y2="{_top(box) + BOX_HEIGHT}" stroke="#888888"/>'
        )
    fill = _FILLS[box.proof.step] if box.proof.step in LEAVES else _OPERATOR_FILL
    yield (
        f'<rect x="{box.x:.1f}" y="{_top(box)}" width="{BOX_WIDTH}" height="{BOX_HEIGHT}" '
        f'rx="6" fill="{fill}" stroke="#555555"/>'
    )
    head = f"{box.proof.interval}  {box.proof.step}"
    about = wrap(box.proof.about, LETTERS, max_lines=MOST_LINES, placeholder=" …")
    for number, line in enumerate((head, *about)):
        weight = ' font-weight="bold"' if number == 0 else ""
        y = _top(box) + LINE * (number + 1) + 3
        yield (f'<text x="{middle:.1f}" y="{y}" text-anchor="middle"{weight}>{escape(line)}</text>')
