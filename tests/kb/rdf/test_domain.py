"""Claims about the household domain in the graph."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf.domain import DOMAIN
from hilt.kb.rdf.terms import Literal
from hilt.kb.sparql.results import BooleanResult
from hilt.kb.validation import check_shapes
from hilt.ontology.actions import load_actions
from hilt.ontology.objects import load_household, load_objects
from hilt.ontology.vocabulary import term

OBJECTS, ACTIONS = load_objects(), load_actions()


@pytest.fixture
def home(kb: KnowledgeBase) -> KnowledgeBase:
    """A base that knows the household."""
    kb.load_domain(OBJECTS, ACTIONS, load_household().classes)
    return kb


def test_domain_is_written_once(home: KnowledgeBase):
    """The same data is not written again."""
    assert not home.load_domain(OBJECTS, ACTIONS, load_household().classes)
    assert home.sequence == 0


def test_changed_domain_replaces_the_old_one(home: KnowledgeBase):
    """What is no longer in the data is no longer in the graph."""
    fewer = {"knife": replace(OBJECTS["knife"], properties=frozenset({"flat"}))}

    assert home.load_domain(fewer, ACTIONS)

    found = home.select("SELECT ?o { GRAPH graph:domain { ?o a hilt:Object } }")
    assert {str(row[0]).rpartition("/")[2] for row in found} == {"knife", "cutlery"}
    ask = "ASK {{ GRAPH graph:domain {{ object:knife hilt:property property:{} }} }}"
    assert home.store.run(ask.format("flat")) == BooleanResult(True)
    assert home.store.run(ask.format("sharp")) == BooleanResult(False)


@pytest.mark.parametrize("name", list(OBJECTS))
def test_parts_are_those_of_the_data(home: KnowledgeBase, name: str):
    """Each object has its own part nodes, which are of the kinds that rules speak of."""
    found = home.select(
        "SELECT ?name { GRAPH graph:domain { ?part hilt:whole ?object ; hilt:isA ?kind . "
        "?kind rdfs:label ?name ; hilt:partOf ?object . ?object rdfs:label ?label } }",
        {"label": Literal(name, language="en")},
    )

    assert {row[0] for row in found} == {
        Literal(part, language="en") for part in OBJECTS[name].parts
    }


def test_domain_says_nothing_about_use_or_grasp(home: KnowledgeBase):
    """What things are for, and how they are taken, is only ever taught."""
    taught = {term(name) for name in ("usedFor", "graspedBy", "affords", "rule", "feature")}

    assert not any(q.predicate in taught for q in home.store.quads(None, None, None, DOMAIN))
    assert home.rules() == []


def test_node_of_a_tree_leads_to_the_rules_that_matter_there(home: KnowledgeBase):
    """A deep node heeds the rules of each of its contexts, and those of the action alone."""
    found = home.select(
        "SELECT ?key { GRAPH graph:domain "
        "{ node:pound-pickUp.graspObject hilt:heeds ?node . ?node rdfs:label ?key } }"
    )

    assert {row[0] for row in found} == {"pickUp.graspObject", "pound.graspObject", "graspObject"}


def test_domain_keeps_to_the_shapes(home: KnowledgeBase):
    """What comes from the data is valid."""
    assert list(check_shapes(home.store)) == []
