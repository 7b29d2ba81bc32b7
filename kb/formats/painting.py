# SPDX-License-Identifier: Apache-2.0
"""A picture of the rule graph as SVG, or as PNG where Pillow is installed."""

from __future__ import annotations

import io
from collections.abc import Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING
from xml.sax.saxutils import escape

from ...ontology.errors import MissingExtraError
from .drawing import BOX_HEIGHT, LINE, MARGIN, Arrow, NodeBox, Picture, Point

if TYPE_CHECKING:
    from PIL.ImageDraw import ImageDraw
    from PIL.ImageFont import FreeTypeFont, ImageFont

DASHES = {"plain": (), "together": (7, 4), "against": (2, 3)}  # drawn, left out, ... [px]
HEAD, FONT, STEPS = 7, 12, 24  # arrow head [px], font [px], pieces of a curve
SCALE = 2  # pixels of a PNG to one of the picture, so that letters are crisp
INK, EDGE = "#222222", "#888888"


def svg(picture: Picture) -> str:
    """The picture as an SVG document; it needs no font but the viewer's own."""
    lines = [
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{picture.width:.0f}" '
        f'height="{picture.height:.0f}" font-family="sans-serif" font-size="{FONT}">',
        '<rect width="100%" height="100%" fill="#ffffff"/>',
        *(line for arrow in picture.arrows for line in _svg_arrow(arrow)),
        *(line for box in picture.boxes for line in _svg_box(box)),
        *(line for at, name, colour in _legend(picture) for line in _svg_entry(at, name, colour)),
        "</svg>\n",
    ]
    return "\n".join(lines)


def png(picture: Picture) -> bytes:
    """The picture as a PNG.

    Raises:
        MissingExtraError: Pillow is not installed.
    """
    try:
        from PIL import Image, ImageDraw, ImageFont
    except ImportError as error:
        raise MissingExtraError("sim", "pillow") from error
    size = (round(picture.width * SCALE), round(picture.height * SCALE))
    image = Image.new("RGB", size, "#ffffff")
    pen, font = ImageDraw.Draw(image), ImageFont.load_default(FONT * SCALE)
    for arrow in picture.arrows:
        _paint_arrow(pen, font, arrow)
    for box in picture.boxes:
        _paint_box(pen, font, box)
    for (x, y), name, colour in _legend(picture):
        _paint_line(pen, [(x, y), (x + BOX_HEIGHT, y)], colour, ())
        pen.text(_scaled((x + BOX_HEIGHT + 8, y)), name, INK, font, anchor="lm")
    target = io.BytesIO()
    image.save(target, "PNG")
    return target.getvalue()


def _svg_arrow(arrow: Arrow) -> Iterator[str]:
    (x, y), (bx, by), (ex, ey) = arrow.start, arrow.bend, arrow.end
    (ax, ay), (cx, cy) = arrow.controls
    dashes = " ".join(map(str, DASHES[arrow.style]))
    dashed = f' stroke-dasharray="{dashes}"' if dashes else ""
    yield (
        f'<path d="M{x:.1f} {y:.1f} L{bx:.1f} {by:.1f} C{ax:.1f} {ay:.1f} {cx:.1f} {cy:.1f} '
        f'{ex:.1f} {ey:.1f}" fill="none" stroke="{arrow.colour}" stroke-width="1.5"{dashed}/>'
    )
    corners = " ".join(f"{px:.1f},{py:.1f}" for px, py in _head(arrow))
    yield f'<polygon points="{corners}" fill="{arrow.colour}"/>'
    at = f'x="{x + 6:.1f}" y="{y - 4:.1f}"'
    yield f'<text {at} fill="{arrow.colour}">{escape(arrow.label)}</text>'


def _svg_box(box: NodeBox) -> Iterator[str]:
    yield (
        f'<rect x="{box.x:.1f}" y="{box.y:.1f}" width="{box.width:.1f}" height="{box.height:.1f}" '
        f'rx="5" fill="{box.fill}" stroke="{EDGE}"/>'
    )
    middle = (box.x + box.width / 2, box.y + box.height / 2 + FONT / 3)
    yield (
        f'<text x="{middle[0]:.1f}" y="{middle[1]:.1f}" text-anchor="middle" fill="{INK}">'
        f"{escape(box.name)}</text>"
    )


def _svg_entry(at: Point, name: str, colour: str) -> Iterator[str]:
    x, y = at
    yield (
        f'<line x1="{x}" y1="{y:.1f}" x2="{x + BOX_HEIGHT}" y2="{y:.1f}" stroke="{colour}" '
        'stroke-width="3"/>'
    )
    yield f'<text x="{x + BOX_HEIGHT + 8}" y="{y + 4:.1f}" fill="{INK}">{escape(name)}</text>'


def _legend(picture: Picture) -> Iterator[tuple[Point, str, str]]:
    top = picture.height - MARGIN - LINE * (len(picture.legend) - 0.5)
    for row, (name, colour) in enumerate(picture.legend):
        yield (float(MARGIN), top + row * LINE), name, colour


def _head(arrow: Arrow) -> tuple[Point, Point, Point]:
    """The corners of the arrow's head; every arrow arrives level."""
    x, y = arrow.end
    return (x, y), (x - HEAD, y - HEAD / 2), (x - HEAD, y + HEAD / 2)


def _paint_arrow(pen: ImageDraw, font: FreeTypeFont | ImageFont, arrow: Arrow) -> None:
    _paint_line(pen, [arrow.start, *_curve(arrow)], arrow.colour, DASHES[arrow.style])
    pen.polygon([_scaled(corner) for corner in _head(arrow)], fill=arrow.colour)
    at = (arrow.start[0] + 6, arrow.start[1] - 3)
    pen.text(_scaled(at), arrow.label, arrow.colour, font, anchor="ls")


def _paint_box(pen: ImageDraw, font: FreeTypeFont | ImageFont, box: NodeBox) -> None:
    corners = [_scaled((box.x, box.y)), _scaled((box.x + box.width, box.y + box.height))]
    pen.rounded_rectangle(corners, 5 * SCALE, box.fill, EDGE, SCALE)
    middle = (box.x + box.width / 2, box.y + box.height / 2)
    pen.text(_scaled(middle), box.name, INK, font, anchor="mm")


def _paint_line(
    pen: ImageDraw, points: Sequence[Point], colour: str, dashes: tuple[int, ...]
) -> None:
    """A line through points; Pillow draws none with dashes, so it is cut into them."""
    width = round(1.5 * SCALE)
    if not dashes:
        pen.line([_scaled(point) for point in points], colour, width, joint="curve")
        return
    for start, end in _dashed(points, *dashes):
        pen.line([_scaled(start), _scaled(end)], colour, width)


def _dashed(points: Sequence[Point], drawn: int, left_out: int) -> Iterator[tuple[Point, Point]]:
    """The drawn pieces of a line through points, each at most a pixel long."""
    gone = 0.0
    for (ax, ay), (bx, by) in pairwise(points):
        length = ((bx - ax) ** 2 + (by - ay) ** 2) ** 0.5
        pieces = max(1, round(length))
        for i in range(pieces):
            if (gone + i * length / pieces) % (drawn + left_out) < drawn:
                one, two = i / pieces, (i + 1) / pieces
                yield (
                    (ax + (bx - ax) * one, ay + (by - ay) * one),
                    (ax + (bx - ax) * two, ay + (by - ay) * two),
                )
        gone += length


def _curve(arrow: Arrow) -> Iterator[Point]:
    """Points of the Bezier curve from the bend to the end."""
    corners = (arrow.bend, *arrow.controls, arrow.end)
    for step in range(STEPS + 1):
        t = step / STEPS
        weights = ((1 - t) ** 3, 3 * t * (1 - t) ** 2, 3 * t**2 * (1 - t), t**3)
        x, y = (sum(w * corner[i] for w, corner in zip(weights, corners, strict=True))
                for i in (0, 1))  # fmt: skip
        yield x, y


def _scaled(point: Point) -> Point:
    return point[0] * SCALE, point[1] * SCALE
