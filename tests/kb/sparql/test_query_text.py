"""Claims about SPARQL texts, and about what queries and updates may not do."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.sparql.query_text import (
    bind_variables,
    errors_as_typed,
    lookup,
    query_form,
    refuse_external_access,
    syntax_message,
    with_prefixes,
)
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import HiltError, QueryError
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
    ("query", "limit"),
    [
        ("SELECT ?p ?o WHERE { GRAPH <urn:g> { <urn:s> ?p ?o } }", " LIMIT 7"),
        ("PREFIX x: <urn:x> select * {x:a rdf:type ?o . }", " LIMIT 7"),
        ("SELECT*{?s ?p ?o} LIMIT 20", ""),
        ('SELECT ?g { GRAPH ?g { <urn:s> a "x" } }', " LIMIT 7"),
    ],
)
def test_lookup_of_one_pattern_is_known(query: str, limit: str):
    """It gets a limit, unless it has one."""
    assert lookup(query, 7) == query + limit


@pytest.mark.parametrize(
    "query",
    [
        "SELECT ?s { ?s ?p ?o }",
        "SELECT ?s { ?s ?p ?s } LIMIT 20",
        "SELECT ?s { ?s ?p $s } LIMIT 20",
        "SELECT ?s { ?s ?p ?o } LIMIT 2000",
        "SELECT DISTINCT ?p { <urn:s> ?p ?o }",
        "SELECT ?p { <urn:s> ?p ?o . ?o ?q ?r }",
        "SELECT ?p { <urn:s> ?p ?o FILTER(?o > 1) }",
        "SELECT ?p { <urn:s> ?p ?o } ORDER BY ?p",
        "SELECT (COUNT(*) AS ?n) { <urn:s> ?p ?o }",
        "SELECT ?o { <urn:s> <urn:p>+ ?o }",
        "ASK { <urn:s> ?p ?o }",
        "SELECT" + " ?a   " * 50_000 + "{ <urn:s> x }",
    ],
)
def test_what_may_take_long_is_no_lookup(query: str):
    """More than one pattern, a condition, an order, or an unknown subject without a limit."""
    assert lookup(query, 7) is None


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


@pytest.mark.parametrize(
    "text",
    [
        "SELECT * { SERVICE <http://x/> { ?s ?p ?o } }",
        "SELECT * { service silent ?where { ?s ?p ?o } }",
        "SELECT * { FILTER EXISTS { SeRvIcE ex:a { } } }",
        "LOAD <http://x/>",
        "LOAD SILENT <file:///etc/passwd> INTO GRAPH <urn:g>",
        "CLEAR ALL ; load <http://x/>",
        'SELECT * { ?s ?p "a" } SERVICE',
        "SELECT * { \\u0053ERVICE <http://x/> { } }",
        'SELECT * { ?s ?p "\\u0022 } SERVICE <http://x/> {} #" }',
        "SELECT * { ?a <b> ?c } # \n SERVICE",
        'SELECT * { ?s ?p "unclosed SERVICE',
        "SELECT * { SERVICESILENT<http://x/>{?s ?p ?o} }",
        "PREFIX p: <http://x/> SELECT * { SERVICEp:x {?s ?p ?o} }",
        "SELECT * { ?s ?p 1.0SERVICE <http://x/> {} }",
        "SELECT * { ?s ?p trueSERVICE <http://x/> {} }",
        "SELECT * { ?s ?p hilt:.SERVICE <http://x/> {} }",
        "SELECT * { FILTER(1<2)SERVICE#>\n<http://x/>{} }",
        "SELECT * { FILTER(1<2)#>'''\nSERVICE<http://x/>{} #'''\n}",
        "SELECT * { VALUES (?a ?b) {(1 <http://x#>)} SERVICE<http://x/>{} }",
        "SELECT * { OPTIONAL{<http://x/\\u0041#> ?p ?o} SERVICE<http://x/>{} }",
        "SELECT * { OPTIONAL{<<?s?p?o#>'''\n>> ?x ?y .} SERVICE<http://x/>{} #'''\n}",
        'SELECT * { VALUES ?x { """a" } SERVICE <http://x/> {} # \\x """\n}',
        "CLEAR ALL;LOADSILENT<http://x/>",
        "PREFIX p: <http://x/> LOADp:x",
        'DEFINE get:soft "soft" SELECT * FROM <http://x/> {}',
        'SELECT (bif:file_to_string("/etc/passwd") AS ?x) {}',
        'SELECT (<bif:file_to_string>("/etc/passwd") AS ?x) {}',
    ],
)
def test_reaching_outside_is_refused(text: str):
    """SERVICE and LOAD are refused in every spelling and place."""
    with pytest.raises(QueryError, match="is refused"):
        refuse_external_access(text)


@pytest.mark.parametrize(
    "text",
    [
        "SELECT ?service { ?service ex:load ?load }",
        'SELECT * { ?s ?p "SERVICE" } # LOAD',
        "SELECT * { ?s <http://x/SERVICE#LOAD> '''LOAD''' }",
        "SELECT * { ?s service:x load:y ; ex:a-load 'x'@load }",
        "PREFIX load: <http://x/> INSERT DATA { GRAPH <a:b> { load:x load:y 'Load it' } }",
        "SELECT * { ?s ?p ?o FILTER(?o < 3 && ?s = <http://x/service>) } # it's",
        "SELECT * { ?s ?p 'load' FILTER(?a<?b) }",
        'SELECT * { ?s ?p """a "quoted" LOAD""" }',
    ],
)
def test_the_words_are_allowed_where_they_are_no_keywords(text: str):
    """Names, strings, IRIs, tags and comments may say them."""
    refuse_external_access(text)


FRAGMENTS = (
    *("SERVICE", "SILENT", "<http://127.0.0.1:9/>", "p:x", "{", "}", "{}", "(", ")", "<", ">"),
    *("<<", ">>", "#", "\n", " ", '"', "'", "'''", '"""', "\\", "\\u0041", "FILTER(", "1", "1.0"),
    *("?s ?p ?o", "?s", ".", ";", "true", "VALUES ?x {", "VALUES (?x ?y) {(", ")}", "OPTIONAL{"),
    *("p:", "_:b", "'a'", "@en", "-", "a:b"),
)


def complaint(query: str) -> str:
    """What the engine says of a query; nothing where it answers."""
    try:
        open_store("memory:").select(query)
    except HiltError as error:
        return str(error)
    return ""


@settings(max_examples=400)
@given(st.lists(st.sampled_from(FRAGMENTS), max_size=12).map("".join))
def test_what_is_not_refused_reaches_nothing(middle: str):
    """The engine opens no connection (here: complains of the port) for what the scan lets by."""
    text = f"PREFIX p: <http://127.0.0.1:9/> SELECT * {{ {middle} SERVICE<http://127.0.0.1:9/>{{}}"

    for query in (text, f"{text}\n}}", f"{text} #'''\n}}", f'{text} #"""\n}}'):
        with contextlib.suppress(QueryError):
            refuse_external_access(query)
            assert "port 9" not in complaint(query)
