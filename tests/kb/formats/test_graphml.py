"""Claims about the picture of the rule graph."""

from __future__ import annotations

import struct
import sys
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.formats.graphml import draw_graph, graph_of
from hilt.kb.interval import Interval
from hilt.kb.rule import Rule, functional, grasping
from hilt.ontology.errors import MissingExtraError

from ..conftest import BLADE, CUTTING, HANDLE
from ..strategies import rules

SVG = "{http://www.w3.org/2000/svg}"
NEVER = functional("spoon", "cutting", interval=Interval(0, 0.05))
RED_MUG = grasping("mug", "handle", interval=Interval(0.7, 1), properties=["red"])


def svg(*some: Rule) -> bytes:
    """The picture of these rules."""
    return draw_graph(graph_of(some), "svg")


def texts(picture: bytes) -> list[str]:
    """Everything that is written in a picture."""
    root = ElementTree.fromstring(picture)  # noqa: S314 - our own
    return [element.text or "" for element in root.iter(f"{SVG}text")]


@settings(max_examples=10, deadline=None)
@given(st.lists(rules, max_size=8, unique_by=lambda rule: rule.id))
def test_picture_has_every_node_and_the_interval_of_every_rule(some: list[Rule]):
    """Whatever the names are."""
    graph = graph_of(some)

    written = texts(draw_graph(graph, "svg"))

    assert {data["name"] for _, data in graph.nodes(data=True)} <= set(written)
    arrows = [text for text in written if text.endswith("]")]
    assert len(arrows) == graph.number_of_edges()
    assert {text[text.index("[") :] for text in arrows} == {str(rule.interval) for rule in some}


def test_arrows_name_their_context_and_the_legend_explains_them():
    """Contexts, ways of concluding, and kinds of nodes."""
    written = texts(svg(CUTTING, HANDLE, BLADE))

    assert {"[0.95, 1.00]", "pickUp [0.95, 1.00]", "pass [0.95, 1.00]"} <= set(written)
    assert {"pass", "pickUp", "any context", "speaks against", "affordance"} <= set(written)


def test_denial_and_joint_condition_look_different():
    """They are dotted and dashed, other rules are solid."""
    solid, dashed, dotted = (svg(rule).count(b"stroke-dasharray") for rule in
                             (CUTTING, RED_MUG, NEVER))  # fmt: skip

    assert dashed > solid
    assert dotted > solid


def test_picture_does_not_depend_on_the_order_of_the_rules():
    """The same rules, the same picture."""
    some = (CUTTING, HANDLE, BLADE, NEVER, RED_MUG)

    assert svg(*some) == svg(*reversed(some))


def test_png_grows_with_the_rules():
    """It has room for every arrow."""
    sizes = [
        struct.unpack(">II", draw_graph(graph_of(some), "png")[16:24])
        for some in ([CUTTING], [CUTTING, HANDLE, BLADE, NEVER, RED_MUG])
    ]

    assert sizes[0][1] < sizes[1][1]


def test_missing_matplotlib_is_reported_with_its_extra(monkeypatch: pytest.MonkeyPatch):
    """One line says what to install."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)

    with pytest.raises(MissingExtraError, match=r'pip install "hilt\[report\]"'):
        svg(CUTTING)


def test_no_rules_are_an_empty_picture():
    """Nothing fails."""
    assert texts(svg()) == []
