# SPDX-License-Identifier: Apache-2.0
"""Curves with confidence bands as SVG, to stand in a page of HTML."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

from ...execution.outcome import Json

WIDTH, HEIGHT = 560, 300  # [px]
LEFT, RIGHT, TOP, BOTTOM = 52, 150, 16, 46  # margins [px]; the legend stands on the right
TICKS = 5  # of accuracy
# Colours that people who see colours differently can tell apart (Okabe & Ito 2008).
COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9")
DASHES = ("", "6 3", "2 3", "8 3 2 3")  # where lines lie upon each other


@dataclass(frozen=True)
class _Frame:
    """Where a point of the plane (x in [0, most], y in [0, 1]) is drawn."""

    most: float

    def x(self, value: float) -> float:
        return LEFT + value / self.most * (WIDTH - LEFT - RIGHT)

    def y(self, value: float) -> float:
        return TOP + (1 - value) * (HEIGHT - TOP - BOTTOM)


def curve_svg(label: str, lines: Mapping[str, Sequence[Json]]) -> str:
    """Accuracy over one quantity, a line each.

    Args:
        label: of the horizontal axis.
        lines: name -> points, each with `x`, `accuracy`, `lower` and `upper`.
    """
    points = [number(point, "x") for each in lines.values() for point in each]
    frame = _Frame(max(points, default=1.0) or 1.0)
    drawn = [*_axes(frame, label, sorted({*points}))]
    for i, (name, each) in enumerate(lines.items()):
        drawn += _line(frame, each, COLOURS[i % len(COLOURS)], DASHES[i % len(DASHES)])
        if len(lines) > 1:
            drawn += _legend(i, name)
    inside = "\n".join(drawn)
    return (
        f'<svg role="img" aria-label="accuracy against {escape(label)}" '
        f'viewBox="0 0 {WIDTH} {HEIGHT}" width="{WIDTH}" height="{HEIGHT}">\n{inside}\n</svg>'
    )


def number(point: Json, name: str) -> float:
    """A number of a point."""
    return float(str(point[name]))


def _axes(frame: _Frame, label: str, measured: Sequence[float]) -> Iterator[str]:
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    for i in range(TICKS + 1):
        share, y = i / TICKS, frame.y(i / TICKS)
        yield f'<line class="grid" x1="{LEFT}" y1="{y:.1f}" x2="{right}" y2="{y:.1f}"/>'
        yield f'<text x="{LEFT - 8}" y="{y + 4:.1f}" text-anchor="end">{share:.0%}</text>'
    for value in measured:
        x = frame.x(value)
        yield f'<text x="{x:.1f}" y="{bottom + 16}" text-anchor="middle">{value:g}</text>'
    middle = (LEFT + right) / 2
    yield f'<text x="{middle}" y="{HEIGHT - 8}" text-anchor="middle">{escape(label)}</text>'


def _line(frame: _Frame, points: Sequence[Json], colour: str, dash: str) -> Iterator[str]:
    def at(name: str, which: Sequence[Json]) -> str:
        pairs = ((frame.x(number(p, "x")), frame.y(number(p, name))) for p in which)
        return " ".join(f"{x:.1f},{y:.1f}" for x, y in pairs)

    band = f"{at('upper', points)} {at('lower', points[::-1])}"
    yield f'<polygon points="{band}" fill="{colour}" fill-opacity="0.13"/>'
    yield (
        f'<polyline points="{at("accuracy", points)}" fill="none" stroke="{colour}" '
        f'stroke-width="2" stroke-dasharray="{dash}"/>'
    )
    for point in points:
        x, y = frame.x(number(point, "x")), frame.y(number(point, "accuracy"))
        shown = (
            f"{number(point, 'accuracy'):.1%} [{number(point, 'lower'):.1%}, "
            f"{number(point, 'upper'):.1%}] at {number(point, 'x'):g}"
        )
        yield (
            f'<circle cx="{x:.1f}" cy="{y:.1f}" r="3" fill="{colour}">'
            f"<title>{shown}</title></circle>"
        )


def _legend(place: int, name: str) -> Iterator[str]:
    x, y = WIDTH - RIGHT + 18, TOP + 14 + place * 20
    colour, dash = COLOURS[place % len(COLOURS)], DASHES[place % len(DASHES)]
    yield (
        f'<line x1="{x}" y1="{y - 4}" x2="{x + 26}" y2="{y - 4}" stroke="{colour}" '
        f'stroke-width="2" stroke-dasharray="{dash}"/>'
    )
    yield f'<text x="{x + 34}" y="{y}">{escape(name)}</text>'
