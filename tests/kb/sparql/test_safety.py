"""Claims about what queries and updates may not do."""

from __future__ import annotations

import contextlib

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.sparql.safety import refuse_external_access
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import HiltError, QueryError


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
