"""Rules as a graph: of networkx, as GraphML, and as a picture, SVG or PNG.

Atoms are nodes, each rule is an edge between them. An edge leads from each feature of a rule to its
argument, with all that the rule says as attributes; the id of the rule is its key. A rule without
features starts at its contexts, one without an argument ends at a node for its functor. All
attributes are plain texts and numbers, which tools carry, so that the rules can be read back.

In the picture features are on the left, consequents on the right; an atom may be both. Each rule is
an arrow with its interval, coloured by its context; a dotted one speaks against its consequent, a
dashed one needs another feature besides. Boxes stand in the order that keeps the arrows short (the
barycentre heuristic of Sugiyama, Tagawa and Toda 1981), and each arrow has its own place at a box,
so that no label covers another. All lengths are in points.
"""

import io
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import cycle, groupby, zip_longest
from operator import attrgetter
from statistics import fmean
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from ...ontology.errors import DataError, HiltError, extra_required
from ..rdf.record_mapping import group_pairs
from ..rule import Rule
from . import value_notation
from .value_notation import COLUMNS

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from networkx import MultiDiGraph

ANY_CONTEXT = "any context"
_OPTIONAL = frozenset({"speaker", "status", "time"})
_LETTER, _ROW, _GAP, _MARGIN, _CURVE = 5.6, 20, 10, 12, 130  # [pt]; of a 9 pt font
_SWEEPS = 8  # how often the columns are ordered; more changes nothing
_DPI = 160  # of a PNG

# Colours that people who see few colours can tell apart (Okabe and Ito 2008).
_COLOURS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#7a5c00")
_NO_CONTEXT, _GREY = "#555555", "#888888"
_FILLS = {
    "object": "#dcecf7", "property": "#fdf1d6", "part": "#e3f1de", "affordance": "#f5e1ee",
}  # fmt: skip
_OTHER_FILL = "#eeeeee"
_STYLES: dict[str, Any] = {
    "supports": "-", "needs another feature": (0, (6, 3)), "speaks against": (0, (1.5, 2)),
}  # fmt: skip
_Boxes: TypeAlias = dict[str, tuple[float, float]]  # middle and height of that of each node


class _Arrow(NamedTuple):
    start: str
    end: str
    label: str
    context: str
    style: str
    rule: str


def graph_of(rules: Iterable[Rule]) -> "MultiDiGraph[str]":
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
        attributes = {"rule": rule.id, "label": str(rule.interval), **said, **texts, **bounds}
        for start in sorted(rule.features or rule.contexts):
            graph.add_node(str(start), kind=start.kind, name=start.name)
            graph.add_node(end, kind=_kind(end), name=_name(end))
            graph.add_edge(str(start), end, key=rule.id, **attributes)
    return graph


def write_graphml(rules: Iterable[Rule]) -> bytes:
    """Return the graph of rules as GraphML."""
    import networkx as nx

    target = io.BytesIO()
    nx.write_graphml_xml(graph_of(rules), target, named_key_ids=True, edge_id_from_attribute=None)
    return target.getvalue()


def read_graphml(text: bytes, *, source: str) -> Iterator[Rule]:
    """Iterate over the rules of a GraphML text, with the attributes that `write_graphml` writes.

    Each comes once. DataError if it is no GraphML, or an edge lacks an attribute of a rule.
    """
    import networkx as nx

    try:
        graph: Any = nx.read_graphml(io.BytesIO(text), force_multigraph=True)
    except Exception as error:  # the reader raises whatever its XML parser does
        raise DataError(f"is no GraphML: {error}.", source=source) from error
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


def draw_graph(graph: "MultiDiGraph[str]", form: str) -> bytes:
    """Draw a graph of rules as "svg" or "png"; MissingExtraError if matplotlib is not installed."""
    with extra_required("report", "matplotlib"):
        import matplotlib as mpl
        from matplotlib.figure import Figure

    arrows = sorted(_arrow(*edge) for edge in graph.edges(data=True))
    left, right = _ordered_columns(arrows)
    by_start = sorted(arrows, key=lambda one: (left.index(one.start), right.index(one.end), one))
    by_end = sorted(arrows, key=lambda one: (right.index(one.end), left.index(one.start), one))
    starts, tails = _stacked(by_start, "start")
    ends, heads = _stacked(by_end, "end")
    height = _ROW * len(arrows) + _GAP * max(len(left), len(right))
    longest = max((len(arrow.label) for arrow in arrows), default=0)
    x0 = _width(left)
    x1 = x0 + _LETTER * longest + _CURVE + min(height, 3000) / 10
    contexts = sorted({arrow.context for arrow in arrows} - {ANY_CONTEXT})
    colours = {**dict(zip(contexts, cycle(_COLOURS))), ANY_CONTEXT: _NO_CONTEXT}
    with mpl.rc_context({"svg.hashsalt": "hilt", "svg.fonttype": "none", "font.size": 9}):
        figure = Figure(figsize=((x1 + _width(right)) / 72, (height + _GAP) / 72))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(0, x1 + _width(right)), ylim=(-height - _GAP, 0))
        axes.set_axis_off()
        _draw_boxes(axes, starts, 0, x0)
        _draw_boxes(axes, ends, x1, _width(right))
        for arrow in arrows:
            tail, head = (x0, tails[arrow]), (x1, heads[arrow])
            _draw_arrow(axes, arrow, tail, head, colours[arrow.context])
        if arrows:
            _draw_legend(axes, colours, sorted({_kind(node) for node in graph}))
        stream = io.BytesIO()
        metadata = {"Date": None} if form == "svg" else None
        figure.savefig(stream, format=form, dpi=_DPI, metadata=metadata, bbox_inches="tight")
    return stream.getvalue()


def _arrow(start: str, end: str, data: Mapping[str, Any]) -> _Arrow:
    contexts = ", ".join(_name(one) for one in data["contexts"].split("; ") if one)
    if data["lower"] + data["upper"] <= 1:
        style = "speaks against"
    else:
        style = "needs another feature" if "; " in data["features"] else "supports"
    label = f"{contexts} {data['label']}".strip()
    return _Arrow(start, end, label, contexts or ANY_CONTEXT, style, data["rule"])


def _name(node: str) -> str:
    return node.partition(":")[2]


def _kind(node: str) -> str:
    return node.partition(":")[0]


def _width(column: Iterable[str]) -> float:
    return _LETTER * max((len(_name(node)) for node in column), default=0) + 2 * _MARGIN


def _ordered_columns(arrows: Sequence[_Arrow]) -> tuple[list[str], list[str]]:
    columns = sorted({arrow.start for arrow in arrows}), sorted({arrow.end for arrow in arrows})
    for _ in range(_SWEEPS):
        for own, other in ((1, 0), (0, 1)):
            height = {node: i / len(columns[other]) for i, node in enumerate(columns[other])}
            reached = group_pairs((arrow[own], height[arrow[other]]) for arrow in arrows)
            columns[own].sort(key=lambda node: (fmean(reached[node]), node))
    return columns


def _stacked(arrows: Iterable[_Arrow], by: str) -> tuple[_Boxes, dict[_Arrow, float]]:
    """The middle and height of the box of each node, and where each arrow is at it."""
    boxes: _Boxes = {}
    ports: dict[_Arrow, float] = {}
    y = float(-_GAP)
    for node, some in groupby(arrows, key=attrgetter(by)):
        top = y
        for arrow in some:
            ports[arrow] = y - _ROW / 2
            y -= _ROW
        boxes[node] = (top + y) / 2, top - y
        y -= _GAP
    return boxes, ports


def _draw_boxes(axes: "Axes", boxes: _Boxes, left: float, width: float) -> None:
    middles, heights = zip(*boxes.values(), strict=True) if boxes else ((), ())
    fills = [_FILLS.get(_kind(node), _OTHER_FILL) for node in boxes]
    bars = axes.barh(middles, width, heights, left, color=fills, edgecolor=_GREY, clip_on=False)
    axes.bar_label(bars, list(map(_name, boxes)), label_type="center", parse_math=False)


def _draw_arrow(
    axes: "Axes", arrow: _Arrow, tail: tuple[float, float], head: tuple[float, float], colour: str
) -> None:
    from matplotlib.patches import FancyArrowPatch
    from matplotlib.path import Path

    bend = tail[0] + _LETTER * len(arrow.label) + 6
    middle = (bend + head[0]) / 2
    path = Path(
        [tail, (bend, tail[1]), (middle, tail[1]), (middle, head[1]), head],
        [Path.MOVETO, Path.LINETO, Path.CURVE4, Path.CURVE4, Path.CURVE4],
    )
    axes.add_patch(
        FancyArrowPatch(
            path=path, arrowstyle="-|>,head_length=5,head_width=2.2", mutation_scale=1,
            color=colour, linestyle=_STYLES[arrow.style], linewidth=1.1, shrinkA=0, shrinkB=0,
        )
    )  # fmt: skip
    axes.text(
        tail[0] + 4, tail[1] + 1, arrow.label,
        va="bottom", fontsize=8, color=colour, parse_math=False,
    )  # fmt: skip


def _draw_legend(axes: "Axes", colours: Mapping[str, str], kinds: Sequence[str]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    columns: list[list[Any]] = [
        [Line2D([], [], color=colour, label=name) for name, colour in colours.items()],
        [Line2D([], [], color="#333333", linestyle=s, label=name) for name, s in _STYLES.items()],
        [Patch(fc=_FILLS.get(one, _OTHER_FILL), ec=_GREY, label=one) for one in kinds],
    ]
    rows = zip_longest(*columns, fillvalue=Line2D([], [], linestyle="none", label=" "))
    in_order = [one for column in zip(*rows, strict=True) for one in column]
    axes.legend(handles=in_order, ncols=3, loc="upper left", bbox_to_anchor=(0, 0), frameon=False)
