"""The `Store` protocol: statements in named graphs, SPARQL, and atomic, durable writes.

A store holds RDF 1.1 quads and knows nothing of rules. Its guarantees, tested for every backend:

- `apply` and `update` are one atomic unit each, and durable when they return;
- outside `GRAPH` a query sees the union of all graphs;
- no update is lost between threads that hold `writing()` while they read and then write;
- the results of a query are complete when it returns; no cursor stays open.
"""

from collections.abc import Iterable, Iterator
from contextlib import AbstractContextManager
from itertools import groupby, islice
from operator import attrgetter
from pathlib import Path
from typing import Any, Protocol, TypeAlias, TypeVar, cast, runtime_checkable

from ...ontology.vocabulary import Iri, term
from ..rdf.terms import BASE_GRAPH, BASE_NODE, Properties, Quad, Term
from ..sparql.results import QueryLimits, QueryResult, SelectResult

MEMORY = "memory:"
T = TypeVar("T")
EngineQuad: TypeAlias = Any  # a statement as pyoxigraph has it


class ReadableStore(Protocol):
    """What is read of a store, node by node."""

    def quads(
        self,
        subject: Iri | None = None,
        predicate: Iri | None = None,
        object: Term | None = None,
        graph: Iri | None = None,
    ) -> Iterator[Quad]:
        """All statements that match, in any order; None matches everything."""
        ...

    def properties(self, subject: Iri, graph: Iri) -> Properties:
        """The properties of a node in a graph, as (predicate, object)."""
        return [(quad.predicate, quad.object) for quad in self.quads(subject, graph=graph)]


class Store(ReadableStore, Protocol):
    """A store of RDF quads, in memory, on disk or behind an endpoint."""

    location: str  #: as it was given to `open_store`
    read_only: bool  #: whether writes are refused
    has_cheap_patterns: bool  #: whether a few small reads cost less than one query

    def select(self, query: str) -> SelectResult:
        """The rows of a SELECT query; QueryError if that is wrong, StoreError if unreadable."""
        ...

    def run(self, query: str, limits: QueryLimits | None = None) -> QueryResult:
        """The result of any query; QueryError if it is wrong or exceeds its limits, if any."""
        ...

    def apply(self, *, insert: Iterable[Quad] = (), delete: Iterable[Quad] = ()) -> None:
        """Delete, then insert, as one atomic, durable unit; after a StoreError nothing changed."""

    def update(self, update: str) -> None:
        """Run a SPARQL update, as `apply`; QueryError if the update is wrong."""

    def save(self, target: Path) -> None:
        """Write a copy of all statements into a new folder; StoreError if it cannot be written."""

    def writing(self) -> AbstractContextManager[object]:
        """The lock to hold while a write depends on what was read before it."""
        ...

    def close(self) -> None:
        """Close the store; it cannot be used any more. Closing twice is allowed."""


@runtime_checkable
class EmbeddedStore(Protocol):
    """What a store of this process can do besides: read and load many statements."""

    @property
    def is_sorted(self) -> bool:
        """Whether the statements of a graph come subject by subject."""
        ...

    def statements(self, graph: Iri) -> Iterator[EngineQuad]:
        """The statements of a graph as the engine has them, to be serialized (`rdf_text`)."""
        ...

    def check_tables(self) -> None:
        """Read every statement in every way it is stored; StoreError where one is damaged."""

    def load(self, lines: Iterable[bytes]) -> None:
        """Add the statements of lines of N-Quads as one unit, while they are made."""


def described_nodes(store: ReadableStore, graph: Iri) -> Iterator[tuple[Iri, Properties]]:
    """Iterate over the nodes of a graph with their properties; in memory where not sorted."""
    found = store.quads(None, None, None, graph)
    if not (isinstance(store, EmbeddedStore) and store.is_sorted):
        found = iter(sorted(found, key=attrgetter("subject")))
    for node, some in groupby(found, key=attrgetter("subject")):
        yield node, [(quad.predicate, quad.object) for quad in some]


def last_utterance(store: ReadableStore) -> int:
    """Return the number of the last utterance of the base in a store; 0 before the first."""
    numbers = store.quads(BASE_NODE, term("sequence"), None, BASE_GRAPH)
    return max((cast(int, quad.object) for quad in numbers), default=0)


def is_first(thing: object, known: set[object], most: int) -> bool:
    """Whether a set, which is emptied when it has so many things, has not this one; adds it."""
    if thing in known:
        return False
    if len(known) >= most:
        known.clear()
    known.add(thing)
    return True


class ChunkReader:
    """A file of chunks of bytes, as pyoxigraph reads it."""

    def __init__(self, chunks: Iterable[bytes]) -> None:
        self._chunks = iter(chunks)
        self._held = memoryview(b"")

    def read(self, size: int = -1) -> bytes:
        """At most `size` bytes, or those of a chunk; none at the end."""
        while not self._held:
            if (chunk := next(self._chunks, None)) is None:
                return b""
            self._held = memoryview(chunk)
        end = len(self._held) if size < 0 else size
        found, self._held = bytes(self._held[:end]), self._held[end:]
        return found


def batched(things: Iterable[T], size: int) -> Iterator[list[T]]:
    """Iterate over lists of so many things; the last may be shorter."""
    rest = iter(things)
    while some := list(islice(rest, size)):
        yield some
