"""Claims about the invariants: damage of every kind is found, and what Hilt writes is none."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable

import pytest

from hilt.kb.episodes import EPISODES
from hilt.kb.history import ASSERTS, HISTORY, SEQUENCE, TRUST_LOWER
from hilt.kb.invariants import check_invariants
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.learned import LearnedWord
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.domain import DOMAIN
from hilt.kb.rdf.rule_mapping import BELIEFS, DERIVED, DERIVED_FROM, TYPE
from hilt.kb.rdf.terms import BASE_GRAPH, BASE_NODE, Quad
from hilt.kb.rule import Atom
from hilt.ontology.actions import Actions
from hilt.ontology.objects import load_objects
from hilt.ontology.vocabulary import Iri, iri, term

from .conftest import BLADE
from .test_episodes import EPISODE
from .test_taught_actions import SERVE

NODE = rule_mapping.rule_iri(BLADE.id)
Change = Callable[[KnowledgeBase], tuple[Iterable[Quad], Iterable[Quad]]]  # deleted, inserted


@pytest.fixture
def base(paper: KnowledgeBase) -> KnowledgeBase:
    """A base with something in each graph."""
    word = LearnedWord(Atom("object", "spork"), "a spork is an object", "sam")
    paper.believe(word.said, "", "sam", [], words=[word], actions=[SERVE])
    paper.record_episode(EPISODE)
    paper.load_domain({"knife": load_objects()["knife"]}, Actions({}, {}))
    return paper


def test_what_hilt_writes_is_whole(base: KnowledgeBase):
    """Nothing is missing, and nothing too much."""
    assert [*check_invariants(base.store, whole=True)] == []


def gone(*pattern: object) -> Change:
    """The statements of a pattern are not there."""
    return lambda base: (list(base.store.quads(*pattern)), [])  # type: ignore[arg-type]


def added(*quads: Quad) -> Change:
    """Some statements more."""
    return lambda _: ([], quads)


DAMAGE: dict[str, tuple[Change, str]] = {
    "an utterance is not there": (
        gone(iri("utterance", "3")), "prov:wasDerivedFrom utterance:3 does not assert it"),
    "an utterance asserts nothing": (
        gone(iri("utterance", "3"), ASSERTS), "prov:wasDerivedFrom utterance:3 does not assert it"),
    "an utterance asserts a rule that is not there": (
        added(Quad(iri("utterance", "3"), ASSERTS, iri("rule", "0" * 16), HISTORY)),
        "hilt:asserts rule:0{16} is not there"),
    "an edge from a node is not there": (
        lambda _: ([rule_mapping.node_edge(BLADE)], []), "is missing, and follows"),
    "a plain edge is not there": (
        lambda _: (rule_mapping.plain_edges(BLADE), []), "is missing, and follows"),
    "a label is not there": (
        gone(iri("object", "knife"), rule_mapping.LABEL, None, DERIVED), "is missing, and follows"),
    "a class is not there": (gone(NODE, TYPE), "rdf:type hilt:ActionRule is missing"),
    "a second trust": (
        added(Quad(iri("speaker", "sam"), TRUST_LOWER, 0, BELIEFS)), "one hilt:trustLower"),
    "a bound of trust is not there": (gone(iri("speaker", "sam"), TRUST_LOWER), "Trust is one"),
    "a trust that is none": (
        lambda base: ([*base.store.quads(iri("speaker", "sam"), TRUST_LOWER)],
                      [Quad(iri("speaker", "sam"), TRUST_LOWER, 7, BELIEFS)]),
        r"\[7, 1\] is not an interval"),
    "nobody is trusted": (gone(iri("speaker", "sam"), None, None, BELIEFS), "Nobody is trusted"),
    "an old number": (
        lambda base: ([*base.store.quads(BASE_NODE, SEQUENCE)],
                      [Quad(BASE_NODE, SEQUENCE, 1, BASE_GRAPH)]),
        "hilt:sequence is 1, but there is an utterance:4"),
    "a foreign statement of the base": (
        added(Quad(BASE_NODE, term("colour"), "red", BASE_GRAPH)), "belongs to nothing known"),
    "another domain": (
        added(Quad(iri("object", "knife"), term("partOf"), iri("object", "mug"), DOMAIN)),
        "It is not as Hilt wrote it"),
    "a word without its text": (gone(None, term("text"), "a spork is an object"), "hilt:text"),
    "a word of an utterance that is not there": (
        added(Quad(iri("word", "object.spork"), DERIVED_FROM, iri("utterance", "9"),
                   iri("graph", "lexicon"))),
        "utterance:9 is not there"),
    "an episode without its outcome": (gone(None, term("outcome"), "done"), "hilt:outcome"),
    "a foreign statement of an episode": (
        added(Quad(iri("step", "x.1"), term("index"), 1, EPISODES)), "step:x.1"),
    "a foreign node": (
        added(Quad(Iri("http://example.org/x"), TYPE, term("Rule"), iri("graph", "actions"))),
        "belongs to nothing known"),
}  # fmt: skip


@pytest.mark.parametrize("damage", DAMAGE)
def test_damage_is_found(base: KnowledgeBase, damage: str):
    """However it came in."""
    change, said = DAMAGE[damage]
    deleted, inserted = change(base)
    assert [*deleted, *inserted]
    base.store.apply(delete=deleted, insert=inserted)

    found = [str(finding) for finding in check_invariants(base.store, whole=True)]

    assert any(re.search(said, one) for one in found), found


def test_blank_node_is_found(base: KnowledgeBase):
    """In any graph, as subject or object."""
    base.store.update("INSERT DATA { GRAPH graph:domain { object:knife hilt:partOf [] } }")
    base.store.update("INSERT DATA { GRAPH graph:history { [] a hilt:Utterance } }")

    found = [one.problem for one in check_invariants(base.store, whole=True)]

    assert found.count("A base has no blank nodes; give each a name.") == 2
