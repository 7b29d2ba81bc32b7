"""Claims about SPARQL texts."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.kb.sparql.query_text import (
    bind_variables,
    errors_as_typed,
    query_form,
    syntax_message,
    with_prefixes,
)
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import QueryError
from hilt.ontology.vocabulary import Iri


def test_binding_stands_at_the_head_of_the_where_group():
    """A value becomes a VALUES block, several values are alternatives."""
    bound = bind_variables("SELECT ?s WHERE { ?s ?p ?o }", {"s": [Iri("urn:a"), Iri("urn:b")]})

    assert bound == "SELECT ?s WHERE { VALUES ?s { <urn:a> <urn:b> } ?s ?p ?o }"


@pytest.mark.parametrize(
    "query",
    [
        "CONSTRUCT { ?s ?p ?o } WHERE # a { brace\n { ?s ?p ?o }",
        "SELECT (EXISTS { ?s ?p ?o } AS ?x) WHERE { ?s ?p ?o }",
        'SELECT ?s { ?s ?p "{" }',
        "ASK { ?s ?p ?o } VALUES ?p { <urn:p> }",
    ],
)
def test_binding_finds_the_outermost_group(query: str):
    """Templates, expressions, strings and comments are not taken for the WHERE group."""
    bound = bind_variables(query, {"s": Iri("urn:a")})

    head = bound.index("VALUES ?s")
    assert bound[:head].rstrip().endswith("{")
    assert "?s ?p" in bound[head:]
    open_store("memory:").select(bound) if query_form(query) == "SELECT" else None


@given(st.text(st.characters(exclude_categories=["Cs"])))
def test_bound_text_never_leaves_its_literal(text: str):
    """Whatever the text, the query finds that text and nothing else."""
    bound = bind_variables("SELECT ?x WHERE { BIND(?x AS ?y) }", {"x": text})

    assert open_store("memory:").select(bound).rows == ((text,),)


def test_query_without_group_cannot_be_bound():
    """There is no place for the values."""
    with pytest.raises(QueryError, match="no WHERE group"):
        bind_variables("DESCRIBE <urn:x>", {"x": 1})


def test_malformed_value_is_refused():
    """A value that is no term, and a name that is no variable, are refused."""
    with pytest.raises(QueryError, match=r"value for \?x is wrong"):
        bind_variables("SELECT * { ?x ?p ?o }", {"x": Iri("urn:a> }")})
    with pytest.raises(QueryError, match="not the name of a variable"):
        bind_variables("SELECT * { ?x ?p ?o }", {"x } #": 1})


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("# SELECT\nPREFIX ask: <urn:SELECT> ask {}", "ASK"),
        ("select * {}", "SELECT"),
        ("construct where {}", "CONSTRUCT"),
        ("DESCRIBE <urn:x>", "DESCRIBE"),
        ("INSERT DATA {}", ""),
        ("", ""),
    ],
)
def test_form_is_the_first_keyword(text: str, expected: str):
    """Prefixes and comments before it do not count."""
    assert query_form(text) == expected


def test_undeclared_prefix_is_named():
    """The engine says something else; the person needs the prefix."""
    assert syntax_message("error at 1:1", "ASK { ex:a ?p ?o }") == (
        'The prefix "ex:" is not declared.'
    )


def test_mistake_is_told_with_its_place():
    """Line, column, and what stands there."""
    with pytest.raises(QueryError, match=r'at line 2, column 6: found "\{ \?s \?p \?o \}"'):
        open_store("memory:").select("SELECT ?s\nWERE { ?s ?p ?o }")


@pytest.mark.parametrize(
    ("query", "place"),
    [
        ("SELECT ?s { ?s hilt:lower 1 . ?s hilt:upper ! . ?s ?p ?o }", "line 1, column 45"),
        ("PREFIX x: <urn:x>\nSELECT ?s\n{ ?s hilt:upper ! . ?s ?p 1 }", "line 3, column 17"),
        ("PREFIX x: <urn:x>\nSELECT ?s { ?s hilt:lower 1 }\n\nLIMIT ten", "line 4, column 7"),
    ],
)
def test_place_of_an_error_is_that_in_the_text_as_typed(query: str, place: str):
    """What Hilt adds, values of variables and declarations, does not count."""
    values = {"s": Iri("urn:a:name:that:makes:it:longer")}

    for sent in (bind_variables(query, values), with_prefixes(query), query):
        with pytest.raises(QueryError, match=place), errors_as_typed(query, sent):
            open_store("memory:").select(sent)
