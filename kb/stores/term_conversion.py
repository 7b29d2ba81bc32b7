"""Conversion between Hilt's RDF terms and those of pyoxigraph."""

from functools import lru_cache
from typing import Any, cast

import pyoxigraph as engine

from ...ontology.errors import QueryError
from ...ontology.vocabulary import Iri
from ..rdf.rule_mapping import KEYS
from ..rdf.terms import LANGUAGE_TEXT, STRING, Quad, Term, lexical, literal
from ..sparql.results import RDF_12_UNSUPPORTED


def from_engine(term: Any) -> Term:
    """The term of a pyoxigraph term, a blank node as IRI with `_:`; QueryError for a triple."""
    kind = type(term)
    if kind is engine.NamedNode:
        return Iri(term.value)
    if kind is engine.Literal:
        return literal(term.value, term.datatype.value, term.language or "")
    if kind is engine.BlankNode:
        return Iri(str(term))
    raise QueryError(RDF_12_UNSUPPORTED)


def quad_from_engine(quad: engine.Quad) -> Quad:
    """The statement of a pyoxigraph quad; errors as for `from_engine`."""
    graph = quad.graph_name
    return Quad(
        cast(Iri, from_engine(quad.subject)),
        Iri(quad.predicate.value),
        from_engine(quad.object),
        None if isinstance(graph, engine.DefaultGraph) else cast(Iri, from_engine(graph)),
    )


@lru_cache(maxsize=2**16)
def property_from_engine(predicate: engine.NamedNode, value: Any) -> tuple[Iri, Term]:
    """The property that a pyoxigraph predicate and object are; errors as for `from_engine`."""
    return shared_iri(predicate.value), from_engine(value)


def to_engine(term: Term) -> engine.NamedNode | engine.Literal:
    """The pyoxigraph term of a term; ValueError if it is no valid IRI or literal."""
    if isinstance(term, Iri):
        return named_node(term)
    text, datatype, language = lexical(term)
    if datatype == STRING:
        return engine.Literal(text)
    if datatype == LANGUAGE_TEXT and language:
        return engine.Literal(text, language=language)
    return engine.Literal(text, datatype=named_node(datatype))


@lru_cache(maxsize=2**10)
def shared_iri(text: str) -> Iri:
    """The IRI of a text that comes often, as one object, which is quick to compare."""
    iri = Iri(text)
    return KEYS.get(iri, iri)


@lru_cache(maxsize=2**16)
def named_node(iri: str) -> engine.NamedNode:
    """The pyoxigraph node of an IRI."""
    return engine.NamedNode(iri)


def quad_to_engine(quad: Quad) -> engine.Quad:
    """The pyoxigraph quad of a statement; errors as for `to_engine`."""
    graph = engine.DefaultGraph() if quad.graph is None else named_node(quad.graph)
    return engine.Quad(
        named_node(quad.subject), named_node(quad.predicate), to_engine(quad.object), graph
    )
