"""Claims about the operations of updates: they select and write what the engine would."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from hilt.kb.rdf.terms import Quad
from hilt.kb.sparql.update_operations import UpdateOperation, parse_update, readable_update
from hilt.kb.stores.base import Store
from hilt.kb.stores.opening import open_store
from hilt.ontology.errors import QueryError
from hilt.ontology.vocabulary import Iri, iri

DATA = Path(__file__).parents[1] / "data"
A, B = iri("graph", "beliefs"), iri("graph", "lexicon")
UPDATES = yaml.safe_load((DATA / "update_operations.yaml").read_text("utf-8"))


def example() -> Store:
    """A store with two graphs that overlap."""
    store = open_store("memory:")
    for graph, numbers in ((A, (1, 2, 3)), (B, (1, 5))):
        store.apply(insert=[Quad(Iri(f"urn:{n}"), Iri("urn:p"), n, graph) for n in numbers])
    return store


def statements_of(update: str) -> set[Quad]:
    """What an update leaves in an empty store."""
    empty = open_store("memory:")
    empty.update(update)
    return set(empty.quads())


def apply(store: Store, operation: UpdateOperation) -> None:
    """Select the solutions, and write the templates."""
    rows = store.select(operation.query(1000)).rows if operation.where else ((None,),)
    delete, insert = (
        statements_of(operation.insertion(template, rows)) if template and rows else set[Quad]()
        for template in (operation.deleted, operation.inserted)
    )
    store.apply(delete=delete)
    store.apply(insert=insert)


@pytest.mark.parametrize("update", UPDATES)
def test_operations_do_what_the_engine_does(update: str):
    """Statement by statement, with graphs chosen in every way."""
    by_engine, by_operations = example(), example()

    by_engine.update(update)
    for operation in parse_update(update):
        apply(by_operations, operation)

    assert set(by_operations.quads()) == set(by_engine.quads())


@pytest.mark.parametrize("prefix", ["graph", "silent", "default", "to", "all"])
def test_prefix_that_looks_like_a_keyword_is_none(prefix: str):
    """`COPY graph:a TO graph:b` names two graphs, whatever an engine makes of it."""
    declared = f"PREFIX {prefix}: <https://w3id.org/hilt/graph/>"
    named = f"{declared} COPY {prefix}:beliefs TO {prefix}:lexicon"
    store, expected = example(), example()
    expected.update(f"COPY GRAPH <{A}> TO GRAPH <{B}>")

    for operation in parse_update(named):
        apply(store, operation)

    assert set(store.quads()) == set(expected.quads())
    example().update(readable_update(named))


@pytest.mark.parametrize("first", ["COPY graph:a\n TO graph:b", "ADD\ngraph:a TO graph:b\n"])
def test_readable_update_keeps_every_token_in_its_place(first: str):
    """So that the place of an error stays right."""
    text = f"{first} ; INSERT DATA {{ hilt:a hilt:b 1 }}"

    before, after = (one.partition("INSERT")[0] for one in (text, readable_update(text)))

    assert before.count("\n") == after.count("\n")
    assert len(before.rpartition("\n")[2]) == len(after.rpartition("\n")[2])


@pytest.mark.parametrize(
    ("text", "said"),
    [(" ; # nothing", "is empty"), ("COPY DEFAULT TO graph:b", "no default graph")],
)
def test_what_a_base_has_no_use_for_is_refused(text: str, said: str):
    """An empty update, and the default graph."""
    with pytest.raises(QueryError, match=said):
        readable_update(text)
