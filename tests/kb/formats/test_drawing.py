# SPDX-License-Identifier: Apache-2.0
"""Claims about the picture of the rule graph."""

from __future__ import annotations

import sys
from itertools import combinations
from xml.etree import ElementTree

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.formats.drawing import ANY_CONTEXT, Arrow, NodeBox, Picture, picture_of
from hilt.kb.formats.graphml import graph_of
from hilt.kb.formats.painting import png, svg
from hilt.kb.interval import Interval
from hilt.kb.rule import Rule, functional, grasping
from hilt.ontology.errors import MissingExtraError

from ..conftest import BLADE, CUTTING, HANDLE
from ..strategies import rules

SPACE = "{http://www.w3.org/2000/svg}"
NEVER = functional("spoon", "cutting", interval=Interval(0, 0.05))
RED_MUG = grasping("mug", "handle", interval=Interval(0.7, 1), properties=["red"])


def drawn(*told: Rule) -> Picture:
    """The picture of these rules."""
    return picture_of(graph_of(told))


@settings(max_examples=40, deadline=None)
@given(st.lists(rules, max_size=12, unique_by=lambda rule: rule.id))
def test_every_rule_is_an_arrow_between_boxes_that_do_not_overlap(told: list[Rule]):
    """As many arrows as the graph has edges; boxes and labels within the picture, and apart."""
    graph = graph_of(told)

    picture = picture_of(graph)

    assert len(picture.arrows) == graph.number_of_edges()
    assert len(picture.boxes) == graph.number_of_nodes()
    assert not any(overlap(a, b) for a, b in combinations(picture.boxes, 2))
    assert all(box.x + box.width <= picture.width for box in picture.boxes)
    starts = [arrow.start for arrow in picture.arrows]
    assert len(set(starts)) == len(starts)


def overlap(one: NodeBox, other: NodeBox) -> bool:
    """Whether two boxes share a point inside."""
    return (
        one.x < other.x + other.width
        and other.x < one.x + one.width
        and one.y < other.y + other.height
        and other.y < one.y + one.height
    )


def by_label(picture: Picture) -> dict[str, Arrow]:
    """The arrows by what is written on them."""
    return {arrow.label: arrow for arrow in picture.arrows}


def test_arrows_tell_interval_and_context():
    """Each context has a colour of its own, which the legend explains."""
    picture = drawn(CUTTING, HANDLE, BLADE)

    arrows = by_label(picture)
    assert set(arrows) == {"[0.95, 1.00]", "pickUp [0.95, 1.00]", "pass [0.95, 1.00]"}
    assert [name for name, _ in picture.legend] == ["pass", "pickUp", ANY_CONTEXT]
    assert {arrow.colour for arrow in picture.arrows} == {colour for _, colour in picture.legend}


def test_denial_and_joint_condition_look_different():
    """Dotted speaks against, dashed needs another feature."""
    arrows = by_label(drawn(NEVER, RED_MUG, CUTTING))

    styles = {label: arrow.style for label, arrow in arrows.items()}
    assert styles == {
        "[0.00, 0.05]": "against", "[0.70, 1.00]": "together", "[0.95, 1.00]": "plain",
    }  # fmt: skip


def test_picture_does_not_depend_on_the_order_of_the_rules():
    """The same rules, the same picture."""
    told = (CUTTING, HANDLE, BLADE, NEVER, RED_MUG)

    assert svg(drawn(*told)) == svg(drawn(*reversed(told)))


def test_svg_holds_every_name_and_label():
    """It is well formed, whatever the names."""
    odd = functional("o'clock", "a & b".replace(" & ", " "), interval=Interval(0.2, 0.9))

    root = ElementTree.fromstring(svg(drawn(CUTTING, BLADE, NEVER, odd)))  # noqa: S314 - our own

    texts = {element.text for element in root.iter(f"{SPACE}text")}
    assert {"knife", "blade", "cutting", "o'clock", "pass [0.95, 1.00]", "[0.20, 0.90]"} <= texts


def test_png_shows_the_same():
    """It is an image of twice the size, with the colours of the arrows in it."""
    image = pytest.importorskip("PIL.Image")
    import io

    picture = drawn(CUTTING, BLADE, NEVER, RED_MUG)
    shown = image.open(io.BytesIO(png(picture)))

    assert shown.size == (round(picture.width * 2), round(picture.height * 2))
    colours = {colour for _, colour in shown.getcolors(1 << 24)}
    assert {tuple(bytes.fromhex(arrow.colour[1:])) for arrow in picture.arrows} <= colours


def test_png_without_pillow_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch):
    """SVG needs nothing."""
    monkeypatch.setitem(sys.modules, "PIL", None)

    with pytest.raises(MissingExtraError, match=r"pip install"):
        png(drawn(CUTTING))


def test_no_rules_is_an_empty_picture():
    """Nothing fails."""
    picture = drawn()

    assert (picture.boxes, picture.arrows, picture.legend) == ((), (), ())
    assert svg(picture).endswith("</svg>\n")
