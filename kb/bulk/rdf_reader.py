"""RDF text as statements that are grouped by their subject."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Any, BinaryIO, NamedTuple, TypeAlias, cast

from ...ontology.vocabulary import Iri
from ..rdf.annotated_turtle import AnnotatedEdge, ReifyingTriple
from ..rdf.terms import Properties, Property, Quad

# What an RDF text is read into.
Statements: TypeAlias = "StatementGroup | ReifyingTriple"

MAX_GROUP = 10_000  # statements; many more rules than that may hang on one node


class StatementGroup(NamedTuple):
    """Consecutive statements about one subject in one graph."""

    node: Iri
    graph: Iri
    pairs: Properties


def read_groups(
    stream: BinaryIO, *, format: str, source: str, default: Iri
) -> Iterator[Statements]:
    """Iterate over the statements of an RDF text, those about one subject together.

    The text is UTF-8 in one of `rdf_text.RDF_FORMATS`; statements without a graph are of `default`.
    DataError if the text is malformed; says where.
    """
    from ..stores.rdf_text import TRIPLE, from_engine, parsed, property_from_engine, shared_iri

    last, place, pairs = cast(Any, None), cast(Any, None), list[Property]()
    node = named = default
    for subject, predicate, value, graph in parsed(stream, format=format, source=source):
        if subject != last or graph != place or len(pairs) >= MAX_GROUP:
            if pairs:
                yield StatementGroup(node, named, pairs)
            last, place, pairs = subject, graph, []
            node = cast(Iri, from_engine(subject))
            named = shared_iri(getattr(graph, "value", default))
        if type(value) is TRIPLE:
            edge = AnnotatedEdge(*(cast(Any, from_engine(part)) for part in value))
            yield ReifyingTriple(node, Iri(predicate.value), edge, named)
        else:
            pairs.append(property_from_engine(predicate, value))
    if pairs:
        yield StatementGroup(node, named, pairs)


def read_quads(items: Iterable[Statements]) -> Iterator[Quad | ReifyingTriple]:
    """Iterate over the statements of items."""
    for item in items:
        if isinstance(item, ReifyingTriple):
            yield item
        else:
            yield from (Quad(item.node, key, value, item.graph) for key, value in item.pairs)
