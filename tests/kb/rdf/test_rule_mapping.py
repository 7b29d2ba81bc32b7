"""Claims about rules in the graph."""

from __future__ import annotations

from dataclasses import replace
from datetime import datetime, timezone
from decimal import Decimal

import pytest
from hypothesis import given

from hilt.kb.interval import Interval
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.terms import Literal, Quad
from hilt.kb.rule import KIND_OF, Atom, Rule, functional, grasping
from hilt.ontology.errors import ValidationError
from hilt.ontology.vocabulary import Iri, external, iri, term

from ..conftest import BLADE, CUTTING
from ..strategies import rules

NOON = datetime(2026, 11, 21, 12, tzinfo=timezone.utc)


def star_of(rule: Rule) -> list[tuple[Iri, object]]:
    """What stands at the rule's node."""
    return [(quad.predicate, quad.object) for quad in rule_mapping.property_quads(rule)]


@given(rules)
def test_rule_comes_back_from_its_star(rule: Rule):
    """`read_rule` is the inverse of `star`, for rules of every form."""
    told = replace(rule, utterance=17, time=NOON, status="superseded")

    assert rule_mapping.read_rule(star_of(told)) == told
    assert rule_mapping.read_rule(star_of(rule)) == rule


@given(rules)
def test_every_node_of_a_rule_is_typed(rule: Rule):
    """Nothing in the graph is without a type, the rule and all it speaks of."""
    quads = list(rule_mapping.rule_quads(rule))
    typed = {quad.subject for quad in quads if quad.predicate == rule_mapping.TYPE}

    assert {quad.subject for quad in quads} <= typed


def test_rule_hangs_on_its_node():
    """The key by which the hot question finds it."""
    assert rule_mapping.node_edge(BLADE) == Quad(
        iri("node", "pass.graspObject"),
        rule_mapping.RULE,
        rule_mapping.rule_iri(BLADE.id),
        rule_mapping.DERIVED,
    )


def test_plain_edge_stands_beside_a_rule():
    """Graph tools see object and part, object and affordance joined."""
    knife = iri("object", "knife")

    assert rule_mapping.plain_edges(BLADE)[0][:3] == (
        knife,
        term("graspedBy"),
        iri("part", "blade"),
    )
    assert rule_mapping.plain_edges(CUTTING)[0][:3] == (
        knife,
        term("usedFor"),
        iri("affordance", "cutting"),
    )


def test_rule_that_denies_has_no_plain_edge():
    """A rule that says "never used for" must not read as "used for"."""
    denied = functional("shoe", "cutting", interval=Interval(0, 0.05))

    assert not rule_mapping.plain_edges(denied)


def test_general_rule_has_the_general_edge():
    """An edge of its own keeps it in sight."""
    rule = Rule(
        frozenset([Atom("object", "mug")]),
        frozenset(),
        "moveTo",
        Atom("place", "sink"),
        Interval(0.5, 1),
    )

    assert rule_mapping.plain_edges(rule)[0].predicate == term("affords")
    assert not rule_mapping.plain_edges(replace(rule, argument=None))


def test_only_an_active_rule_hangs_on_its_node():
    """What is retracted is not found by its node, nor by its plain edge."""
    gone = list(rule_mapping.rule_quads(replace(BLADE, status="retracted")))

    assert rule_mapping.node_edge(BLADE) not in gone
    assert not any(quad.predicate == term("graspedBy") for quad in gone)


@pytest.mark.parametrize(
    "missing",
    [rule_mapping.LOWER, rule_mapping.FUNCTOR, rule_mapping.STATUS, rule_mapping.ATTRIBUTED_TO],
)
def test_star_with_a_gap_is_refused(missing: Iri):
    """The message names the property that is missing."""
    with pytest.raises(ValidationError, match=missing.rpartition("#")[2]):
        rule_mapping.read_rule([pair for pair in star_of(BLADE) if pair[0] != missing])


@pytest.mark.parametrize(
    ("key", "value", "problem"),
    [
        (rule_mapping.LOWER, Decimal("1.3"), "is not an interval"),
        (rule_mapping.LOWER, "high", "is not an interval"),
        (rule_mapping.FEATURE, Iri("http://example.org/x"), "is no object"),
        (rule_mapping.FEATURE, "knife", "malformed|is no object"),
        (rule_mapping.FUNCTOR, iri("functor", "Grasp It"), "is no functor"),
    ],
)
def test_star_with_a_wrong_value_is_refused(key: Iri, value: object, problem: str):
    """The laws of intervals, atoms and functors hold for what is read."""
    wrong = [(k, value if k == key else v) for k, v in star_of(BLADE)]

    with pytest.raises(ValidationError, match=problem):
        rule_mapping.read_rule(wrong)


def test_star_with_two_bounds_is_refused():
    """One rule has one interval."""
    with pytest.raises(ValidationError, match="hilt:lower stands there 2 times"):
        rule_mapping.read_rule([*star_of(BLADE), (rule_mapping.LOWER, Decimal("0.5"))])


def test_atom_needs_a_node_of_ours():
    """Only the kinds that rules speak of are atoms."""
    assert rule_mapping.atom_from_iri(iri("object", "wine glass")) == Atom("object", "wine glass")
    with pytest.raises(ValidationError, match="is no object, part"):
        rule_mapping.atom_from_iri(iri("speaker", "sam"))


def test_bounds_are_short_decimals():
    """At most six digits, which every engine keeps."""
    rule = grasping("knife", "blade", interval=Interval(1 / 3, 1))

    assert dict(star_of(rule))[rule_mapping.LOWER] == Decimal("0.333333")
    assert dict(star_of(rule))[rule_mapping.UPPER] == Decimal(1)


def test_relation_beside_an_edge_names_its_conditions():
    """The contexts of a rule, and its further features: a hot mug, to pass it."""
    hot = replace(BLADE, features=BLADE.features | {Atom("property", "hot")})

    found = {quad[:3] for quad in rule_mapping.rule_quads(hot)}

    relation = iri("relation", "graspedBy.action-pass--with-property-hot")
    assert (iri("object", "knife"), relation, iri("part", "blade")) in found
    assert (relation, rule_mapping.CONTEXT, iri("action", "pass")) in found
    assert (relation, rule_mapping.FEATURE, iri("property", "hot")) in found
    assert (relation, external("rdfs:subPropertyOf"), term("graspedBy")) in found


def test_kind_of_thing_is_a_class_with_a_word():
    """A label in the language of the words; what an action does is written apart."""
    knife, pick = Atom("object", "knife"), Atom("action", "pickUp")

    found = {quad[:3] for quad in rule_mapping.atom_label_quads([knife, pick])}

    assert (iri("object", "knife"), external("rdf:type"), external("owl:Class")) in found
    assert (iri("action", "pickUp"), rule_mapping.LABEL, Literal("pick up", language="en")) in found


def test_kind_of_a_kind_is_its_subclass():
    """A ladle is a kind of spoon."""
    spoon = Atom("object", "spoon")
    rule = Rule(frozenset([Atom("object", "ladle")]), frozenset(), KIND_OF, spoon, Interval(1, 1))

    (edge,) = rule_mapping.plain_edges(rule)

    assert edge[:3] == (iri("object", "ladle"), external("rdfs:subClassOf"), iri("object", "spoon"))
