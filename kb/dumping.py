# SPDX-License-Identifier: Apache-2.0
"""Exports of any size: the engine writes, and nothing is held in memory.

A store on disk has the statements of a node together, so it is gone through once, in its own
order: equal bases still give equal files. What stands elsewhere is gathered rule by rule
(`exchange`). Tables are made of the rows of a query (`columns`).
"""

from __future__ import annotations

from collections.abc import Callable, Generator
from contextlib import contextmanager
from typing import BinaryIO, Protocol, runtime_checkable

from ..ontology.errors import StoreError
from ..ontology.vocabulary import Iri
from . import stars
from .files import Progress
from .formats import Format
from .history import HISTORY
from .nquads import Group
from .stars import BELIEFS
from .store import Store

_ALL = frozenset({"nquads", "trig"})  # formats in which the engine writes a whole base
_BELIEFS = frozenset({"ntriples", "turtle"})  # and one graph, to which another text may be added
_TOLD = 10_000  # lines after which the progress is told
_ANY = "GRAPH ?graph { ?node ?key ?value }"
_COUNT = f"SELECT (COUNT(*) AS ?count) {{ {_ANY} }}"


@runtime_checkable
class Dumping(Protocol):
    """A store that writes itself as RDF text."""

    @property
    def is_sorted(self) -> bool:
        """Whether it does so node by node."""
        ...

    def dump(self, stream: Sink, *, format: str, graph: Iri | None = None) -> None:  # noqa: A002
        """Write all statements, or those of a graph."""
        ...

    def dump_rows(self, query: str, stream: Sink) -> None:
        """Write the rows of a SELECT query as CSV."""
        ...


class Sink:
    """Hands on what a store writes, and tells how many lines that were.

    Attributes:
        failure: why that was not possible, where it was not.
    """

    def __init__(self, take: Callable[[bytes], object], progress: Progress | None = None) -> None:
        """Hand on to `take`; `progress` is told how many lines went by."""
        self.failure: OSError | None = None
        self._take, self._progress = take, progress
        self._lines = self._told = 0

    def write(self, chunk: bytes, /) -> int:
        """Hand on some bytes."""
        try:
            self._take(chunk)
        except OSError as error:  # of the file, not of the store
            self.failure = error
            raise
        self._lines += chunk.count(b"\n")
        if self._progress and self._lines - self._told >= _TOLD:
            self._told = self._lines
            self._progress(self._lines)
        return len(chunk)

    def flush(self) -> None:
        """Nothing is held."""


def is_dumped(store: Store, chosen: Format, most: int, *, rules_only: bool) -> bool:
    """Whether `dump_statements` is the way to write a store: it has more than `most` statements."""
    wanted = _BELIEFS if rules_only else _ALL
    return chosen.name in wanted and is_large(store, most)


def is_large(store: Store, most: int) -> bool:
    """Whether a store writes itself node by node, and has more than `most` statements."""
    if not isinstance(store, Dumping) or not store.is_sorted:
        return False
    some = f"SELECT (COUNT(*) AS ?count) {{ SELECT ?node {{ {_ANY} }} LIMIT {most + 1} }}"
    return count(store, some) > most


def dump_statements(
    store: Store, stream: BinaryIO, chosen: Format, progress: Progress | None, *, rules_only: bool
) -> int:
    """Write a base, or all that belongs to its rules; how many statements that are.

    Raises:
        OSError: the stream cannot be written to.
        StoreError: the store cannot be read.
    """
    sink = Sink(stream.write, progress)
    with _told(store, sink) as dumping:
        dumping.dump(sink, format=chosen.name, graph=BELIEFS if rules_only else None)
    if not rules_only:
        return count(store, _COUNT)
    from .oxigraph import write_rdf_to

    sources = list(_sources(store))
    quads = (quad for group in sources for quad in group.quads())
    write_rdf_to(quads, stream, format=chosen.name)
    return count(store, _COUNT.replace("?graph", f"<{BELIEFS}>")) + sum(
        len(group.pairs) for group in sources
    )


def dump_rows(store: Store, query: str, sink: Sink) -> None:
    """Write the rows of a SELECT query as CSV; errors as for `dump_statements`."""
    with _told(store, sink) as dumping:
        dumping.dump_rows(query, sink)


@contextmanager
def _told(store: Store, sink: Sink) -> Generator[Dumping]:
    """Tell what failed, the store or the file."""
    if not isinstance(store, Dumping):
        raise TypeError(f"{store.location} writes no text.")
    try:
        yield store
    except StoreError as error:
        raise (sink.failure or error) from error


def _sources(store: Store) -> list[Group]:
    """The utterances that rules come from."""
    utterances = {quad.subject for quad in store.quads(None, stars.TYPE, None, HISTORY)}
    told = sorted(
        node for node in utterances if any(store.quads(None, stars.DERIVED_FROM, node, BELIEFS))
    )
    return [Group(node, HISTORY, store.properties(node, HISTORY)) for node in told]


def count(store: Store, query: str) -> int:
    """The number that a query gives."""
    ((found,),) = store.select(query)
    return found if isinstance(found, int) else 0
