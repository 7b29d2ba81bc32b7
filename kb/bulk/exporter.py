"""Exports of any size: the statements of a store as RDF text, and its rules.

A large store on disk is written in its own order, which is the same for equal bases, and in
bounded memory. What any other store has is sorted first.
"""

from collections.abc import Callable, Iterator
from itertools import groupby
from typing import TypeAlias, cast

from ...ontology.errors import ValidationError
from ...ontology.garbage_collection import paused_garbage_collection
from ...ontology.vocabulary import PREFIXES, Iri
from ..history import HISTORY
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rule import Rule
from ..stores.base import EmbeddedStore, EngineQuad, Store
from ..stores.rdf_text import graph_statements, property_from_engine

Progress: TypeAlias = Callable[[int], None]  # is called with how many are done so far

MAX_SORTED = 200_000  # statements; a store of more is written in its own order

_SOURCES = "SELECT DISTINCT ?node { GRAPH graph:beliefs { ?rule prov:wasDerivedFrom ?node } }"


def statements(store: Store, *, rules_only: bool = False) -> Iterator[EngineQuad]:
    """The statements of an export, those about one subject together; sorted in a small store.

    `rules_only` leaves out all but the rules and the utterances that they come from.
    """
    is_sorted = not is_large(store)
    sources = {node for (node,) in store.select(_SOURCES)} if rules_only else set[object]()
    for graph in [BELIEFS, HISTORY] if rules_only else _graphs(store):
        found = graph_statements(store, graph, is_sorted=is_sorted)
        if rules_only and graph == HISTORY:
            found = (quad for quad in found if Iri(quad.subject.value) in sources)
        yield from found


def scan_rules(store: Store) -> Iterator[Rule]:
    """Iterate over the rules of a store, of any status; ValidationError if one is malformed."""
    with store.writing(), paused_garbage_collection():
        found = graph_statements(store, BELIEFS, is_sorted=not is_large(store))
        for node, some in groupby(found, key=lambda quad: quad.subject.value):
            if not node.startswith(PREFIXES["rule"]):
                continue
            try:
                properties = (property_from_engine(quad.predicate, quad.object) for quad in some)
                yield rule_mapping.read_rule(properties)
            except ValidationError as error:
                raise ValidationError([f"<{node}>: {one}" for one in error.findings]) from error


def is_large(store: Store) -> bool:
    """Whether a store has its statements subject by subject, and more than `MAX_SORTED`."""
    if not isinstance(store, EmbeddedStore) or not store.is_sorted:
        return False
    some = f"SELECT ?node {{ GRAPH ?graph {{ ?node ?key ?value }} }} LIMIT {MAX_SORTED + 1}"
    ((count,),) = store.select(f"SELECT (COUNT(*) AS ?count) {{ {{ {some} }} }}")
    return cast(int, count) > MAX_SORTED


def _graphs(store: Store) -> list[Iri]:
    some = "GRAPH ?graph { ?node ?key ?value }"
    if isinstance(store, EmbeddedStore):  # lists graphs without going through their statements
        some = f"GRAPH ?graph {{}} FILTER EXISTS {{ {some} }}"
    rows = store.select(f"SELECT DISTINCT ?graph {{ {some} }}")
    return sorted(graph for (graph,) in rows if isinstance(graph, Iri))
