# SPDX-License-Identifier: Apache-2.0
"""Claims that every store keeps, whatever its kind."""

from __future__ import annotations

import threading
from datetime import datetime, timezone
from decimal import Decimal

import pytest

from hilt.kb.store import Store, open_store
from hilt.kb.terms import Literal, Quad, Term
from hilt.ontology.errors import QueryError, StoreError
from hilt.ontology.vocabulary import Iri

S, P, G, H = (Iri(f"urn:{name}") for name in "spgh")


def quad(value: Term = 1, graph: Iri = G) -> Quad:
    """A statement with a value."""
    return Quad(S, P, value, graph)


@pytest.mark.parametrize(
    "value",
    [
        Iri("urn:x"),
        "text",
        'quote " and \n newline, ünïcode 刀',
        True,
        -3,
        Decimal("0.95"),
        Decimal(1),
        0.25,
        datetime(2026, 11, 21, 9, 0, 0, 5000, tzinfo=timezone.utc),
        Literal("knife", language="en"),
        Literal("x", "urn:type"),
    ],
)
def test_every_value_comes_back(store: Store, value: Term):
    """What is written is read back, compared by value."""
    store.apply(insert=[quad(value)])

    assert list(store.quads()) == [quad(value)]
    assert store.properties(S, G) == [(P, value)]
    assert list(store.quads(None, None, value)) == [quad(value)]


def test_insertion_is_idempotent(store: Store):
    """A statement stands there once."""
    store.apply(insert=[quad(), quad()])
    store.apply(insert=[quad()])

    assert len(list(store.quads())) == 1


def test_deletion_comes_before_insertion(store: Store):
    """One unit deletes, then inserts; what is both is there afterwards."""
    store.apply(insert=[quad(1), quad(2)])

    store.apply(delete=[quad(1), quad(2)], insert=[quad(2), quad(3, H)])

    assert set(store.quads()) == {quad(2), quad(3, H)}


def test_pattern_matches_only_what_it_says(store: Store):
    """Each of the four places narrows what is found."""
    store.apply(insert=[quad(1), quad(1, H), Quad(P, P, 1, G)])

    assert set(store.quads(graph=H)) == {quad(1, H)}
    assert set(store.quads(subject=P)) == {Quad(P, P, 1, G)}
    assert not list(store.quads(predicate=S))


def test_select_gives_all_rows(store: Store):
    """Rows are complete, unbound variables are None."""
    store.apply(insert=[quad(1), quad(2)])

    found = store.select("SELECT ?o ?x WHERE { GRAPH <urn:g> { ?s ?p ?o } } ORDER BY ?o")

    assert (found.variables, found.rows) == (("o", "x"), ((1, None), (2, None)))


def test_ask_and_construct_answer(store: Store):
    """The other two forms."""
    store.apply(insert=[quad(1)])

    assert store.ask("ASK { GRAPH <urn:g> { <urn:s> ?p 1 } }")
    assert (
        store.construct("CONSTRUCT { ?o ?p ?s } WHERE { GRAPH ?g { ?s ?p ?o FILTER(false) } }")
        == []
    )
    assert store.construct("CONSTRUCT { ?s ?p ?o } WHERE { GRAPH <urn:g> { ?s ?p ?o } }") == [
        Quad(S, P, 1)
    ]


@pytest.mark.parametrize("call", ["select", "ask", "construct"])
def test_query_of_the_wrong_form_is_refused(store: Store, call: str):
    """Each method takes its own form only."""
    text = "ASK { ?s ?p ?o }" if call != "ask" else "SELECT * { ?s ?p ?o }"

    with pytest.raises(QueryError, match="Expected a"):
        getattr(store, call)(text)


def test_wrong_update_changes_nothing(store: Store):
    """A mistake anywhere in an update undoes all of it."""
    store.apply(insert=[quad(1)])

    with pytest.raises(QueryError):
        store.update("DELETE WHERE { GRAPH <urn:g> { ?s ?p ?o } } ; INSERT DATA {")

    assert list(store.quads()) == [quad(1)]


def test_update_is_applied(store: Store):
    """A SPARQL update works on named graphs."""
    store.update("INSERT DATA { GRAPH <urn:g> { <urn:s> <urn:p> 1 } }")

    assert list(store.quads()) == [quad(1)]


def test_threads_lose_no_update(store: Store):
    """Four threads that count up under the lock reach the sum."""
    store.apply(insert=[quad(0)])

    def count(times: int = 15) -> None:
        for _ in range(times):
            with store.writing():
                (now,) = store.quads(S, P, None, G)
                store.apply(delete=[now], insert=[quad(int(str(now.object)) + 1)])

    threads = [threading.Thread(target=count) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert list(store.quads()) == [quad(60)]


def test_closed_store_says_so(store: Store):
    """Closing twice is allowed, using a closed store is not."""
    store.close()
    store.close()

    with pytest.raises(StoreError, match="is closed"):
        store.apply(insert=[quad()])
    with pytest.raises(StoreError, match="is closed"):
        list(store.quads())


def test_triple_terms_are_refused(store: Store):
    """RDF 1.2 is not what a base holds, and a query that makes such terms is told so."""
    with pytest.raises(QueryError, match=r"RDF 1\.2"):
        store.select("SELECT (TRIPLE(<urn:a>, <urn:b>, 1) AS ?t) WHERE {}")


def test_endpoint_is_not_taken_for_a_folder():
    """An address never becomes a folder of that name."""
    with pytest.raises(StoreError, match="http://x/sparql"):
        open_store("http://x/sparql")
