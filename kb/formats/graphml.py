"""Rules as a graph: of networkx, as GraphML, and as a picture, SVG or PNG.

Atoms are nodes, each rule is an edge between them. An edge leads from each feature of a rule to its
argument, with all that the rule says as attributes; the id of the rule is its key. A rule without
features starts at its contexts, one without an argument ends at a node for its functor. All
attributes are plain texts and numbers, so that GraphML and other tools carry them, and the rules
can be read back.

In the picture features are on the left, consequents on the right. Each rule is an arrow with its
interval, coloured by its context; a dotted one speaks against its consequent, a dashed one needs
another feature besides. Boxes stand in columns in the order that keeps the arrows short (the
barycentre heuristic of Sugiyama, Tagawa and Toda 1981), and each arrow has its own place at a box,
so that no label covers another. All lengths are in points.
"""

from __future__ import annotations

import io
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from statistics import fmean
from typing import TYPE_CHECKING, Any, NamedTuple

from ...ontology.errors import DataError, HiltError, extra_required
from ..rule import Rule
from . import value_notation
from .value_notation import COLUMNS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.transforms import Bbox
    from networkx import MultiDiGraph

ANY_CONTEXT = "any context"
_OPTIONAL = frozenset({"speaker", "status", "time"})
_MARGIN, _LETTER, _ROW, _GAP, _CURVE = 18, 5.6, 16, 10, 130  # [pt]; of an 9 pt font
_LEGEND_ROW = 13.5  # [pt]
_SWEEPS = 8  # how often the columns are ordered; more changes nothing
_PIXELS_PER_INCH = 160  # of a PNG

# Colours that people who see few colours can tell apart (Okabe and Ito 2008).
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5c00")
_NO_CONTEXT = "#555555"
_FILLS = {
    "object": "#dcecf7", "property": "#fdf1d6", "part": "#e3f1de", "affordance": "#f5e1ee",
}  # fmt: skip
_OTHER_FILL = "#eeeeee"
_STYLES: dict[str, Any] = {
    "supports": "-", "needs another feature": (0, (6, 3)), "speaks against": (0, (1.5, 2)),
}  # fmt: skip
_Point = tuple[float, float]


class _Arrow(NamedTuple):
    start: str
    end: str
    label: str
    context: str
    style: str


def graph_of(rules: Iterable[Rule]) -> MultiDiGraph[str]:
    """Return the graph of rules.

    >>> from hilt.kb import Interval, grasping
    >>> graph = graph_of([grasping("knife", "blade", "pass", interval=Interval(0.95, 1))])
    >>> [(a, b, data["lower"]) for a, b, data in graph.edges(data=True)]
    [('object:knife', 'part:blade', 0.95)]

    Nodes have `kind` and `name`; edges have `rule`, `label`, `functor`, `argument`, `features`,
    `contexts`, `lower`, `upper`, `speaker`, `status` and `time`.
    """
    import networkx as nx  # half a second to import

    graph: MultiDiGraph[str] = nx.MultiDiGraph()
    for rule in rules:
        end = str(rule.argument) if rule.argument else f"functor:{rule.functor}"
        texts = dict(zip(COLUMNS, value_notation.write_texts(rule, bare=False), strict=True))
        said = {key: texts.pop(key) for key in ("functor", "argument")}  # these come first in files
        bounds = {"lower": rule.interval.lower, "upper": rule.interval.upper}
        label = str(rule.interval)
        for start in sorted(rule.features or rule.contexts):
            graph.add_node(str(start), kind=start.kind, name=start.name)
            graph.add_node(end, kind=end.partition(":")[0], name=end.partition(":")[2])
            graph.add_edge(
                str(start), end, key=rule.id, rule=rule.id, label=label, **said, **texts | bounds
            )
    return graph


def rules_of_graph(graph: MultiDiGraph[str], *, source: str = "<graph>") -> Iterator[Rule]:
    """Iterate over the rules of a graph's edges, each once; DataError if one lacks an attribute."""
    seen: set[str] = set()
    for start, end, attributes in graph.edges(data=True):
        try:
            given = {key: value for key, value in attributes.items() if value is not None}
            given = {**dict.fromkeys(_OPTIONAL, ""), **given}
            rule = value_notation.read_rule([str(given[key]) for key in COLUMNS])
        except (HiltError, KeyError, TypeError, ValueError) as error:
            problem = f"it has no {error}." if isinstance(error, KeyError) else str(error)
            raise DataError(f"the edge {start} -> {end}: {problem}", source=source) from error
        if rule.id not in seen:
            seen.add(rule.id)
            yield rule


def write_graphml(rules: Iterable[Rule]) -> bytes:
    """Return the graph of rules as GraphML."""
    import networkx as nx

    target = io.BytesIO()
    nx.write_graphml_xml(graph_of(rules), target, named_key_ids=True, edge_id_from_attribute=None)
    return target.getvalue()


def read_graphml(text: bytes, *, source: str) -> Iterator[Rule]:
    """Iterate over the rules of a GraphML text with the attributes that `write_graphml` writes.

    DataError if it is no GraphML, or an edge lacks an attribute of a rule.
    """
    import networkx as nx

    try:
        graph: Any = nx.read_graphml(io.BytesIO(text), force_multigraph=True)
    except Exception as error:  # the reader raises whatever its XML parser does
        raise DataError(f"is no GraphML: {error}.", source=source) from error
    yield from rules_of_graph(graph, source=source)


def draw_graph(graph: MultiDiGraph[str], form: str) -> bytes:
    """Draw a graph of rules as "svg" or "png"; MissingExtraError if matplotlib is not installed."""
    with extra_required("report", "matplotlib"):
        import matplotlib as mpl
        from matplotlib.figure import Figure

    arrows = sorted(_arrow(*edge) for edge in graph.edges(data=True))
    columns = _ordered_columns(graph)
    order = {node: i for column in columns for i, node in enumerate(column)}
    ends = _grouped(sorted(arrows, key=lambda one: (order[one.start], one.start, one.label)), "end")
    starts = _grouped(sorted(arrows, key=lambda one: (order[one.end], one.end, one.label)), "start")
    most = {node: max(len(starts[node]), len(ends[node]), 1) for node in graph}
    heights = {node: rows * _ROW + _ROW / 2 for node, rows in most.items()}
    boxes, width, height = _placed(columns, arrows, heights)
    colours = _colours(arrows)
    kinds = sorted({_kind(node) for node in graph})
    below = _LEGEND_ROW * max(len(colours), len(_STYLES), len(kinds)) + _MARGIN if arrows else 0
    width = max(width, 420) if arrows else width
    with mpl.rc_context({"svg.hashsalt": "hilt", "svg.fonttype": "none", "font.size": 9}):
        figure = Figure(figsize=(width / 72, (height + below) / 72))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set_xlim(0, width)
        axes.set_ylim(-below, height)
        axes.set_axis_off()
        for node, box in boxes.items():
            _draw_box(axes, box, node)
        for arrow in arrows:
            start, end = boxes[arrow.start], boxes[arrow.end]
            tail = start.x1, _port(start, starts[arrow.start], arrow)
            head = end.x0, _port(end, ends[arrow.end], arrow)
            _draw_arrow(axes, arrow, tail, head, colours[arrow.context])
        if arrows:
            _draw_legend(axes, colours, kinds)
        stream = io.BytesIO()
        metadata = {"Date": None} if form == "svg" else None
        figure.savefig(stream, format=form, dpi=_PIXELS_PER_INCH, metadata=metadata)
    return stream.getvalue()


def _arrow(start: str, end: str, data: Mapping[str, Any]) -> _Arrow:
    contexts = ", ".join(_name(one) for one in data["contexts"].split("; ") if one)
    if data["lower"] + data["upper"] <= 1:
        style = "speaks against"
    else:
        style = "needs another feature" if "; " in data["features"] else "supports"
    label = f"{contexts} {data['label']}".strip()
    return _Arrow(start, end, label, contexts or ANY_CONTEXT, style)


def _name(node: str) -> str:
    return node.partition(":")[2]


def _kind(node: str) -> str:
    return node.partition(":")[0]


def _ordered_columns(graph: MultiDiGraph[str]) -> list[list[str]]:
    import networkx as nx

    columns: list[list[str]] = [[], [], []]
    for node in sorted(graph):
        has_in, has_out = graph.in_degree(node) > 0, graph.out_degree(node) > 0
        columns[0 if not has_in else 1 if has_out else 2].append(node)
    columns = [column for column in columns if column]
    edges = graph.to_undirected(as_view=True).edges
    components = sorted(nx.weakly_connected_components(graph), key=min)
    component = {node: number for number, nodes in enumerate(components) for node in nodes}
    for _ in range(_SWEEPS):
        for column in columns:
            height = {node: i / len(one) for one in columns for i, node in enumerate(one)}
            mean = {node: fmean(height[other] for _, other in edges(node)) for node in column}
            column.sort(key=lambda node: (component[node], mean[node], node))
    return columns


def _grouped(arrows: Sequence[_Arrow], by: str) -> dict[str, list[_Arrow]]:
    found: dict[str, list[_Arrow]] = defaultdict(list)
    for arrow in arrows:
        found[getattr(arrow, by)].append(arrow)
    return found


def _placed(
    columns: Sequence[Sequence[str]], arrows: Sequence[_Arrow], heights: Mapping[str, float]
) -> tuple[dict[str, Bbox], float, float]:
    from matplotlib.transforms import Bbox

    totals = [sum(heights[node] + _GAP for node in column) - _GAP for column in columns]
    height = max(totals, default=0) + 2 * _MARGIN
    labels = _LETTER * max((len(arrow.label) for arrow in arrows), default=0)
    channel = labels + _CURVE + min(height, 3000) / 10
    boxes: dict[str, Bbox] = {}
    x = float(_MARGIN)
    for column, own in zip(columns, totals, strict=True):
        width = _LETTER * max(len(_name(node)) for node in column) + 2 * _MARGIN
        y = (height + own) / 2
        for node in column:
            y -= heights[node]
            boxes[node] = Bbox.from_bounds(x, y, width, heights[node])
            y -= _GAP
        x += width + channel
    return boxes, (x - channel + _MARGIN if columns else 2 * _MARGIN), height


def _port(box: Bbox, arrows: Sequence[_Arrow], arrow: _Arrow) -> float:
    place = next(i for i, one in enumerate(arrows) if one is arrow)
    return box.y0 + box.height * (1 - (place + 0.5) / len(arrows))


def _colours(arrows: Sequence[_Arrow]) -> dict[str, str]:
    contexts = sorted({arrow.context for arrow in arrows} - {ANY_CONTEXT})
    colours = {name: _COLOURS[i % len(_COLOURS)] for i, name in enumerate(contexts)}
    if any(arrow.context == ANY_CONTEXT for arrow in arrows):
        colours[ANY_CONTEXT] = _NO_CONTEXT
    return colours


def _draw_box(axes: Axes, box: Bbox, node: str) -> None:
    from matplotlib.patches import FancyBboxPatch

    axes.add_patch(
        FancyBboxPatch(
            box.min, box.width, box.height,
            boxstyle="round,pad=0,rounding_size=5", facecolor=_FILLS.get(_kind(node), _OTHER_FILL),
            edgecolor="#888888", linewidth=0.8,
        )
    )  # fmt: skip
    axes.text(
        (box.x0 + box.x1) / 2, (box.y0 + box.y1) / 2, _name(node),
        ha="center", va="center_baseline", color="#222222", parse_math=False,
    )  # fmt: skip


def _draw_arrow(axes: Axes, arrow: _Arrow, tail: _Point, head: _Point, colour: str) -> None:
    from matplotlib.patches import FancyArrowPatch
    from matplotlib.path import Path

    (left, start), (right, end) = tail, head
    bend = left + _LETTER * len(arrow.label) + 6
    reach = max(abs(right - bend) / 2, _CURVE / 3)
    path = Path(
        [tail, (bend, start), (bend + reach, start), (right - reach, end), head],
        [Path.MOVETO, Path.LINETO, Path.CURVE4, Path.CURVE4, Path.CURVE4],
    )
    axes.add_patch(
        FancyArrowPatch(
            path=path, arrowstyle="-|>,head_length=5,head_width=2.2", mutation_scale=1,
            color=colour, linestyle=_STYLES[arrow.style], linewidth=1.1,
            shrinkA=0, shrinkB=0, capstyle="butt",
        )
    )  # fmt: skip
    axes.text(
        left + 4, start + 2, arrow.label, va="bottom", fontsize=8, color=colour, parse_math=False
    )


def _draw_legend(axes: Axes, colours: Mapping[str, str], kinds: Sequence[str]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    grey = "#333333"
    columns = (
        [Line2D([], [], color=colour, label=name) for name, colour in colours.items()],
        [Line2D([], [], color=grey, linestyle=s, label=name) for name, s in _STYLES.items()],
        [
            Patch(facecolor=_FILLS.get(one, _OTHER_FILL), edgecolor="#888888", label=one)
            for one in kinds
        ],
    )
    longest, blank = max(map(len, columns)), Line2D([], [], linestyle="none", label=" ")
    axes.legend(
        handles=[one for some in columns for one in (*some, *[blank] * (longest - len(some)))],
        ncols=len(columns), loc="upper left", bbox_to_anchor=(_MARGIN, 4), frameon=False,
        bbox_transform=axes.transData, fontsize=8, borderpad=0, borderaxespad=0, handlelength=2.6,
        labelspacing=0.55,
    )  # fmt: skip
