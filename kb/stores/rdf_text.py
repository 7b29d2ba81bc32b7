"""Conversion, parsing and serialization by pyoxigraph: terms, RDF text and query results.

Rows are JSON, CSV, TSV or XML of SPARQL 1.1, booleans JSON or XML, statements all these and Turtle.
"""

import io
import json
import re
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import lru_cache
from itertools import groupby
from operator import attrgetter
from typing import Any, BinaryIO, cast

import pyoxigraph as engine

from ...ontology.errors import DataError, HiltError, QueryError
from ...ontology.vocabulary import PREFIXES, Iri, shortened
from ..rdf import terms
from ..rdf.rule_mapping import KEYS, TYPE
from ..rdf.terms import Property, Quad, Statements, Term, lexical, literal
from ..sparql.results import RDF_12_UNSUPPORTED, BooleanResult, ConstructResult, QueryResult
from .base import ChunkReader, EmbeddedStore, EngineQuad, Store, batched
from .errors import text_error, translated_errors

RDF_FORMATS = {
    "turtle": engine.RdfFormat.TURTLE,
    "trig": engine.RdfFormat.TRIG,
    "nquads": engine.RdfFormat.N_QUADS,
    "ntriples": engine.RdfFormat.N_TRIPLES,
    "jsonld": engine.RdfFormat.JSON_LD,
    "rdfxml": engine.RdfFormat.RDF_XML,
}
MAX_GROUP = 10_000  # statements; many more rules than that may hang on one node
_CHUNK = 2**18  # bytes that are read at once
_NOT_IN_XML = re.compile(r"[\x00-\x08\x0b\x0c\x0e-\x1f\ufffe\uffff]")


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
    subject, predicate, value, graph = quad
    place = None if isinstance(graph, engine.DefaultGraph) else cast(Iri, from_engine(graph))
    return Quad(cast(Iri, from_engine(subject)), Iri(predicate.value), from_engine(value), place)


_shared_literal = lru_cache(maxsize=2**16)(from_engine)  # numbers and times take long to read


def property_from_engine(predicate: engine.NamedNode, value: Any) -> Property:
    """The property that a pyoxigraph predicate and object are; errors as for `from_engine`."""
    is_node = type(value) is engine.NamedNode
    return shared_iri(predicate.value), Iri(value.value) if is_node else _shared_literal(value)


def to_engine(term: Term) -> engine.NamedNode | engine.Literal:
    """The pyoxigraph term of a term; ValueError if it is no valid IRI or literal."""
    if isinstance(term, Iri):
        return named_node(term)
    text, datatype, language = lexical(term)
    if datatype == terms.STRING:
        return engine.Literal(text)
    if datatype == terms.LANGUAGE_TEXT and language:
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
    subject, predicate, value, graph = quad
    place = engine.DefaultGraph() if graph is None else named_node(graph)
    return engine.Quad(named_node(subject), named_node(predicate), to_engine(value), place)


def read_groups(file: BinaryIO, *, format: str, source: str, default: Iri) -> Iterator[Statements]:
    """Iterate over the statements of an RDF text, those about one subject together.

    The text is UTF-8 in one of `RDF_FORMATS`; statements without a graph are of `default`.
    DataError if the text is malformed; says where.
    """
    text = _RecentLines(file)
    try:
        yield from grouped(engine.parse(cast(BinaryIO, text), format=RDF_FORMATS[format]), default)
    except HiltError:
        raise
    except (SyntaxError, MemoryError, ValueError, OSError) as error:
        raise text_error(error, source, text.line(getattr(error, "lineno", 0) or 0)) from error


def grouped(quads: Iterable[EngineQuad], default: Iri) -> Iterator[Statements]:
    """Iterate over statements, those about one subject that stand together; as `read_groups`."""
    for (node, graph), some in groupby(quads, attrgetter("subject", "graph_name")):
        place = default if isinstance(graph, engine.DefaultGraph) else from_engine(graph)
        for part in batched(some, MAX_GROUP):
            yield from _group(cast(Iri, from_engine(node)), cast(Iri, place), part)


def _group(node: Iri, graph: Iri, quads: Iterable[engine.Quad]) -> Iterator[Statements]:
    pairs = list[Property]()
    for quad in quads:
        key, value = quad.predicate, quad.object
        if type(value) is engine.Triple:
            edge = terms.AnnotatedEdge(*cast("list[Any]", [from_engine(part) for part in value]))
            yield terms.ReifyingTriple(node, shared_iri(key.value), edge, graph)
        else:
            pairs.append(property_from_engine(key, value))
    if pairs:
        yield terms.StatementGroup(node, graph, pairs)


def read_triples(data: bytes, *, source: str) -> list[Quad]:
    """The statements, in no graph, of N-Triples that `source` sent; QueryError if it is wrong."""
    with translated_errors(source):
        return [quad_from_engine(q) for q in engine.parse(data, format=engine.RdfFormat.N_TRIPLES)]


def as_ntriples(data: bytes, *, media_type: str, base: str) -> str:
    """The statements of an RDF document as N-Triples with blank nodes of its own.

    `base` resolves relative IRIs. DataError if the document is wrong.
    """
    chosen = engine.RdfFormat.from_media_type(media_type)
    try:
        found = engine.parse(data, format=chosen, base_iri=base, rename_blank_nodes=True)
        triples = [quad.triple for quad in found]
    except SyntaxError as error:
        raise text_error(error, media_type) from error
    return cast(bytes, engine.serialize(triples, format=engine.RdfFormat.N_TRIPLES)).decode()


def graph_statements(store: Store, graph: Iri, *, is_sorted: bool) -> Iterable[EngineQuad]:
    """The statements of a graph, to be serialized; sorted by subject, the class of each first."""
    if isinstance(store, EmbeddedStore):
        found = store.statements(graph)
    else:
        found = map(quad_to_engine, store.quads(None, None, None, graph))

    def order(quad: engine.Quad) -> tuple[str, bool, str, str]:
        predicate = quad.predicate.value
        return str(quad.subject), predicate != TYPE, predicate, str(quad.object)

    return sorted(found, key=order) if is_sorted else found


def write_rdf(quads: Iterable[Quad], *, format: str) -> bytes:
    """Statements as RDF text in UTF-8 in one of `RDF_FORMATS`, without graphs where it has none."""
    statements, stream = [quad_to_engine(quad) for quad in quads], io.BytesIO()
    plain = cast(bytes, engine.serialize(statements, format=engine.RdfFormat.N_QUADS)).decode()
    used = {name: space for name, space in PREFIXES.items() if f"<{space}" in plain}
    write_rdf_to(statements, stream, format=format, prefixes=used)
    return stream.getvalue()


def write_rdf_to(
    statements: Iterable[EngineQuad],
    stream: BinaryIO,
    *,
    format: str,
    prefixes: Mapping[str, str] = PREFIXES,
) -> None:
    """Write statements into a stream, as `write_rdf`; DataError if XML cannot hold a character."""
    if (chosen := RDF_FORMATS[format]) == engine.RdfFormat.RDF_XML:
        statements = map(_checked_for_xml, statements)
    if not chosen.supports_datasets:
        statements = (quad.triple for quad in statements)
    engine.serialize(statements, stream, format=chosen, prefixes=dict(prefixes))


def write_result(found: QueryResult, format: str) -> str:
    """A query result in one of `RESULT_FORMATS`; QueryError if that format cannot hold it."""
    if format not in RESULT_FORMATS:
        known = ", ".join(RESULT_FORMATS)
        raise QueryError(f'There is no result format "{format}". Known: {known}.')
    return RESULT_FORMATS[format](found)


class _RecentLines(ChunkReader):
    """A text that is read in chunks, of which the last two are kept for messages."""

    def __init__(self, stream: BinaryIO) -> None:
        super().__init__(self._noted(iter(lambda: stream.read(_CHUNK), b"")))
        self._recent, self._first = deque[bytes](), 1  # the number of their first line

    def line(self, number: int) -> str:
        lines = b"".join(self._recent).split(b"\n")[max(0, number - self._first) :]
        return lines[0].decode("utf-8", "replace") if lines and number >= self._first else ""

    def _noted(self, chunks: Iterable[bytes]) -> Iterator[bytes]:
        for chunk in chunks:
            if len(self._recent) == 2:
                self._first += self._recent.popleft().count(b"\n")
            self._recent.append(chunk)
            yield chunk


def _checked_for_xml(quad: engine.Quad) -> engine.Quad:
    value = quad.object
    if isinstance(value, engine.Literal) and (found := _NOT_IN_XML.search(value.value)):
        place = shortened(cast(Iri, from_engine(quad.subject)))
        problem = f"XML cannot hold the character U+{ord(found[0]):04X} of {place}."
        raise DataError(f"{problem} Choose Turtle, N-Quads or another format.", source="RDF/XML")
    return quad


def _by_engine(found: QueryResult, name: str) -> str:
    if isinstance(found, BooleanResult) and name != "XML":
        raise QueryError(f"{name} is for rows; the result of ASK is a boolean. Use json or xml.")
    formats = engine.QueryResultsFormat
    read = engine.parse_query_results(json.dumps(found.as_json()), formats.JSON)
    return cast(bytes, read.serialize(format=getattr(formats, name))).decode()


def _turtle(found: QueryResult) -> str:
    if not isinstance(found, ConstructResult):
        raise QueryError("Turtle is for the statements of a CONSTRUCT or DESCRIBE query.")
    return write_rdf(found.quads, format="turtle").decode("utf-8")


RESULT_FORMATS: Mapping[str, Callable[[QueryResult], str]] = {
    "json": lambda found: json.dumps(found.as_json(), ensure_ascii=False) + "\n",
    "csv": lambda found: _by_engine(found, "CSV"),
    "tsv": lambda found: _by_engine(found, "TSV"),
    "xml": lambda found: _NOT_IN_XML.sub("\ufffd", _by_engine(found, "XML")),
    "turtle": _turtle,
}
