# SPDX-License-Identifier: Apache-2.0
"""The rule graph as a picture: what is seen on the left, what follows on the right.

Each rule is an arrow with its interval, coloured by its context; a dotted one speaks against its
conclusion, a dashed one needs another feature besides. Boxes stand in columns in the order that
keeps the arrows short (the barycentre heuristic of Sugiyama, Tagawa and Toda 1981), and each arrow
has a place of its own at the box, so that no label covers another.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import astuple, dataclass
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from networkx import MultiDiGraph

MARGIN, LETTER, LINE = 24, 7, 18  # [px]; of a 12 px font
BOX_HEIGHT, GAP_Y, CURVE = 28, 14, 150  # [px]
SWEEPS = 8  # how often the columns are put in order; more changes nothing
ANY_CONTEXT = "any context"

# Colours that people who see few colours can tell apart (Okabe and Ito 2008).
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5c00")
_NO_CONTEXT = "#555555"
_FILLS = {
    "object": "#dcecf7", "property": "#fdf1d6", "part": "#e3f1de", "affordance": "#f5e1ee",
}  # fmt: skip
_OTHER_FILL = "#eeeeee"

Point = tuple[float, float]


@dataclass(frozen=True)
class NodeBox:
    """A node: left upper corner and size [px], its name and the colour of its kind."""

    x: float
    y: float
    width: float
    height: float
    name: str
    fill: str


@dataclass(frozen=True)
class Arrow:
    """A rule: from its start straight under its label, then in a curve to its end [px]."""

    start: Point
    bend: Point
    end: Point
    label: str
    colour: str
    style: str

    @property
    def controls(self) -> tuple[Point, Point]:
        """The control points of the curve: it leaves and arrives level."""
        reach = max(abs(self.end[0] - self.bend[0]) / 2, CURVE / 3)
        return (self.bend[0] + reach, self.bend[1]), (self.end[0] - reach, self.end[1])


@dataclass(frozen=True)
class Picture:
    """What is drawn, and its size [px].

    Attributes:
        legend: contexts with their colours.
    """

    width: float
    height: float
    boxes: tuple[NodeBox, ...]
    arrows: tuple[Arrow, ...]
    legend: tuple[tuple[str, str], ...]


@dataclass(frozen=True)
class _Edge:
    """A rule between two nodes, as far as drawing goes."""

    start: str
    end: str
    label: str
    context: str
    style: str


def picture_of(graph: MultiDiGraph[str]) -> Picture:
    """The picture of a graph that `graph_of` made."""
    edges = sorted((_edge(*each) for each in graph.edges(data=True)), key=astuple)
    columns = _ordered(_columns(graph), edges, graph)
    out, into = _ports(columns, edges)
    rows = {node: max(len(out[node]), len(into[node]), 1) for node in graph}
    boxes, width = _placed(columns, edges, rows)
    colours = _palette(edges)
    arrows = _arrows(edges, boxes, out, into, colours)
    bottom = max((box.y + box.height for box in boxes.values()), default=MARGIN)
    legend = tuple(colours.items())
    height = bottom + GAP_Y + LINE * len(legend) + MARGIN
    return Picture(width, height, tuple(boxes.values()), tuple(arrows), legend)


def _edge(start: str, end: str, data: dict[str, Any]) -> _Edge:
    contexts = ", ".join(part.partition(":")[2] for part in data["contexts"].split("; ") if part)
    if data["lower"] + data["upper"] <= 1:
        style = "against"
    else:
        style = "together" if "; " in data["features"] else "plain"
    label = f"{contexts} {data['label']}".strip()
    return _Edge(start, end, label, contexts or ANY_CONTEXT, style)


def _columns(graph: MultiDiGraph[str]) -> list[list[str]]:
    """Nodes that only lead somewhere, those between, and those that are only led to."""
    starts = [n for n in graph if not graph.in_degree(n)]
    ends = [n for n in graph if graph.in_degree(n) and not graph.out_degree(n)]
    between = [n for n in graph if graph.in_degree(n) and graph.out_degree(n)]
    return [sorted(column) for column in (starts, between, ends) if column]


def _ordered(
    columns: list[list[str]], edges: Iterable[_Edge], graph: MultiDiGraph[str]
) -> list[list[str]]:
    """The columns, each node at the mean height of its neighbours; what hangs together stays so."""
    import networkx as nx

    near: dict[str, list[str]] = defaultdict(list)
    for edge in edges:
        near[edge.start].append(edge.end)
        near[edge.end].append(edge.start)
    parts = sorted(nx.weakly_connected_components(graph), key=min)
    part = {node: number for number, nodes in enumerate(parts) for node in nodes}
    for _ in range(SWEEPS):
        for column in columns:
            height = {node: i / len(each) for each in columns for i, node in enumerate(each)}
            column.sort(key=lambda node: (part[node], _mean(node, near, height), node))
    return columns


def _mean(node: str, near: dict[str, list[str]], height: dict[str, float]) -> float:
    heights = [height[other] for other in near[node]]
    return sum(heights) / len(heights) if heights else height[node]


def _ports(
    columns: Sequence[Sequence[str]], edges: Sequence[_Edge]
) -> tuple[dict[str, list[_Edge]], dict[str, list[_Edge]]]:
    """The arrows out of and into each node, from top to bottom, so that few of them cross."""
    order = {node: i for column in columns for i, node in enumerate(column)}
    out: dict[str, list[_Edge]] = defaultdict(list)
    into: dict[str, list[_Edge]] = defaultdict(list)
    for edge in sorted(edges, key=lambda one: (order[one.end], one.end, one.label)):
        out[edge.start].append(edge)
    for edge in sorted(edges, key=lambda one: (order[one.start], one.start, one.label)):
        into[edge.end].append(edge)
    return out, into


def _placed(
    columns: Sequence[Sequence[str]], edges: Iterable[_Edge], rows: dict[str, int]
) -> tuple[dict[str, NodeBox], float]:
    """Where each box stands, and how wide all of it is."""
    channel = LETTER * max((len(edge.label) for edge in edges), default=0) + CURVE
    heights = [sum(_height(rows[node]) + GAP_Y for node in column) for column in columns]
    boxes: dict[str, NodeBox] = {}
    x = float(MARGIN)
    for column, height in zip(columns, heights, strict=True):
        width = LETTER * max(len(_name(node)) for node in column) + MARGIN
        y = MARGIN + (max(heights) - height) / 2
        for node in column:
            fill = _FILLS.get(node.partition(":")[0], _OTHER_FILL)
            boxes[node] = NodeBox(x, y, width, _height(rows[node]), _name(node), fill)
            y += boxes[node].height + GAP_Y
        x += width + channel
    return boxes, x - channel + MARGIN if columns else 2.0 * MARGIN


def _height(rows: int) -> float:
    return max(BOX_HEIGHT, rows * LINE + LINE / 2)


def _name(node: str) -> str:
    return node.partition(":")[2]


def _arrows(
    edges: Iterable[_Edge],
    boxes: dict[str, NodeBox],
    out: dict[str, list[_Edge]],
    into: dict[str, list[_Edge]],
    colours: dict[str, str],
) -> Iterable[Arrow]:
    starts = {id(e): y for node, some in out.items() for e, y in _levels(boxes[node], some)}
    ends = {id(e): y for node, some in into.items() for e, y in _levels(boxes[node], some)}
    for edge in edges:
        box, target = boxes[edge.start], boxes[edge.end]
        x, y = box.x + box.width, starts[id(edge)]
        bend = (x + LETTER * len(edge.label) + 8, y)
        end = (target.x, ends[id(edge)])
        yield Arrow((x, y), bend, end, edge.label, colours[edge.context], edge.style)


def _levels(box: NodeBox, edges: Sequence[_Edge]) -> Iterable[tuple[_Edge, float]]:
    """Each arrow at a box with its height, evenly spread."""
    step = box.height / max(len(edges), 1)
    return ((edge, box.y + step * (i + 0.5)) for i, edge in enumerate(edges))


def _palette(edges: Iterable[_Edge]) -> dict[str, str]:
    contexts = sorted({edge.context for edge in edges} - {ANY_CONTEXT})
    colours = {name: _COLOURS[i % len(_COLOURS)] for i, name in enumerate(contexts)}
    if any(edge.context == ANY_CONTEXT for edge in edges):
        colours[ANY_CONTEXT] = _NO_CONTEXT
    return colours
