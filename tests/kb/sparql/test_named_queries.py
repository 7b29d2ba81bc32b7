"""Claims about the named questions."""

from __future__ import annotations

import pytest

from hilt.kb.interval import CERTAIN, Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf.terms import Term
from hilt.kb.rule import Atom, functional, norm
from hilt.kb.sparql.named_queries import QUERIES_FOLDER, named_query, query_names, read_query
from hilt.ontology.errors import QueryError, UnknownNameError
from hilt.ontology.vocabulary import Iri, iri, split, term

from ..conftest import BLADE, CUTTING, teach


def names(row: tuple[Term | None, ...]) -> list[object]:
    """A row with the names of individuals instead of their IRIs."""
    return [split(value)[1] if isinstance(value, Iri) else value for value in row]


@pytest.mark.parametrize("name", query_names())
def test_every_query_asks_a_question_and_runs(paper: KnowledgeBase, name: str):
    """The file says what it asks, and runs as it is, in any engine: its prefixes are its own."""
    query = named_query(name)

    assert query.question.endswith("?")
    assert paper.answer(name).variables
    assert query.text == (QUERIES_FOLDER / f"{name}.rq").read_text(encoding="utf-8")


@pytest.mark.parametrize("name", query_names())
def test_every_parameter_is_a_variable_of_its_query(name: str):
    """What the head of the file declares occurs in the query."""
    query = named_query(name)
    body = query.text[query.text.index("SELECT") :]

    assert all(f"?{parameter}" in body for parameter in query.parameters)


def test_best_object_is_the_surest(paper: KnowledgeBase):
    """Objects for an affordance, the highest interval first."""
    teach(paper, functional("spoon", "cutting", interval=Interval(0.25, 1)))

    rows = [names(row)[1] for row in paper.answer("best-for", affordance="cutting")]

    assert rows == ["knife", "spoon"]
    assert not len(paper.answer("best-for", affordance="pounding"))


def test_use_is_listed_with_its_material(paper: KnowledgeBase):
    """A use on wood says so, a use on anything has no material."""
    teach(paper, functional("knife", "cutting", interval=Interval(0.5, 1), material="wood"))

    rows = [names(row)[-1] for row in paper.answer("uses-of", object="knife")]

    assert rows == [None, "wood"]


def test_grasp_is_found_by_object_and_context(paper: KnowledgeBase):
    """By the blade to pass it; both ways when no context is named."""
    passed = paper.answer("how-to-grasp", object="knife", context="pass")

    assert [names(row)[2] for row in passed] == ["blade"]
    assert len(paper.answer("how-to-grasp", object="knife")) == 2


def test_source_of_a_rule_is_its_sentence(paper: KnowledgeBase):
    """Who said it, and in which words."""
    (row,) = paper.answer("who-said", rule=BLADE.id)

    assert names(row)[1] == "sam"
    assert names(row)[3] == "To pass a knife grab the knife by the blade"


def test_changes_are_told_since_a_number(paper: KnowledgeBase):
    """Only what came after it, assertions and retractions alike."""
    paper.retract(CUTTING.id, "Forget it.", "", "sam")

    rows = [
        (row[0], str(row[1]).rpartition("#")[2]) for row in paper.answer("changed-since", since="2")
    ]

    assert rows == [(3, "asserts"), (4, "retracts")]


def test_contradiction_is_a_pair_that_excludes_each_other(paper: KnowledgeBase):
    """One rule's lower bound above the other's upper."""
    never = functional("knife", "cutting", interval=Interval(0, 0.05), speaker="anna")
    teach(paper, never, speaker="anna")

    (row,) = paper.answer("contradictions", object="knife")

    assert names(row)[4] == CUTTING.id.removeprefix("rule/")
    assert names(row)[6] == never.id.removeprefix("rule/")


def test_norms_are_listed_with_whom_they_are_about(paper: KnowledgeBase):
    """One row a norm, with the places and roles that it holds for."""
    child = [Atom("role", "child"), Atom("place", "kitchen")]
    teach(paper, norm("forbidden", "pass", "knife", interval=CERTAIN, contexts=child))

    (row,) = paper.answer("forbidden", action="pass")

    assert names(row)[:3] == ["forbidden", "pass", "knife"]
    assert sorted(str(row[4]).split(", ")) == ["child", "kitchen"]


def test_unknown_query_and_parameter_are_told():
    """The error lists those there are."""
    with pytest.raises(UnknownNameError, match="best-for"):
        named_query("best")
    with pytest.raises(UnknownNameError, match="affordance"):
        named_query("best-for").bindings({"use": "cutting"})


def test_argument_of_the_wrong_kind_is_refused():
    """A number must be one."""
    with pytest.raises(QueryError, match=r'"x" is no integer, as \?since must be'):
        named_query("changed-since").bindings({"since": "x"})


@pytest.mark.parametrize(
    "text",
    ["wine glass", "object:wine_glass", "object/wine glass", str(iri("object", "wine glass"))],
)
def test_argument_may_be_written_as_it_is_shown(text: str):
    """By its name, as in tables, as an id, or as its whole address."""
    found = named_query("uses-of").bindings({"object": text})

    assert found == {"object": [iri("object", "wine glass")]}


def test_several_values_are_alternatives(paper: KnowledgeBase):
    """A parameter may be given more than once."""
    bindings = named_query("best-for").bindings({"affordance": ["eating", "cutting"]})

    assert len(paper.query(named_query("best-for").text, bindings)) == 1  # pyright: ignore[reportArgumentType]


def test_value_for_no_variable_is_refused():
    """It would have no effect, silently."""
    own = read_query("SELECT ?s { ?s a ?kind }")

    with pytest.raises(UnknownNameError, match='Did you mean "kind"'):
        own.bindings({"kin": "hilt:ActionRule"})
    assert own.bindings({"kind": "hilt:ActionRule"}) == {"kind": [term("ActionRule")]}


def test_hostile_argument_is_only_a_name(paper: KnowledgeBase):
    """An argument cannot leave its IRI."""
    assert not len(paper.answer("best-for", affordance="x> } ; DROP ALL #"))
    assert len(paper.rules()) == 3
