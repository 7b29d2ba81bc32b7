# SPDX-License-Identifier: Apache-2.0
"""Exports of any size: the engine writes, and nothing is held in memory.

A store on disk has the statements of a node together, so it is gone through once, in its own
order: equal bases still give equal files. What stands elsewhere is gathered rule by rule
(`exchange`).
"""

from __future__ import annotations

from collections.abc import Callable
from typing import BinaryIO, Protocol, runtime_checkable

from ..ontology.errors import StoreError
from ..ontology.vocabulary import Iri, split
from . import stars
from .files import Progress
from .formats import Format
from .history import HISTORY
from .nquads import Group, Reader
from .rule import Rule
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
    return _count(store, some) > most


def dump_statements(
    store: Store, stream: BinaryIO, chosen: Format, progress: Progress | None, *, rules_only: bool
) -> int:
    """Write a base, or all that belongs to its rules; how many statements that are.

    Raises:
        OSError: the stream cannot be written to.
        StoreError: the store cannot be read.
    """
    _dump(store, Sink(stream.write, progress), chosen.name, BELIEFS if rules_only else None)
    if not rules_only:
        return _count(store, _COUNT)
    from .oxigraph import write_rdf_to

    sources = list(_sources(store))
    quads = (quad for group in sources for quad in group.quads())
    write_rdf_to(quads, stream, format=chosen.name)
    return _count(store, _COUNT.replace("?graph", f"<{BELIEFS}>")) + sum(
        len(group.pairs) for group in sources
    )


def dump_rules(store: Store, take: Callable[[Rule], object], progress: Progress | None) -> int:
    """Give every rule of a store, whatever its status, to `take`; how many that are.

    Raises:
        OSError: `take` raised it.
        StoreError: the store cannot be read.
    """
    from .oxigraph import line_reader

    rules = _Rules(line_reader("ntriples", source="the base", default=BELIEFS), take, progress)
    _dump(store, Sink(rules.feed), "ntriples", BELIEFS)
    rules.finish()
    return rules.count


class _Rules:
    """Reads rules from lines."""

    def __init__(
        self, reader: Reader, take: Callable[[Rule], object], progress: Progress | None
    ) -> None:
        self.count = 0
        self._reader, self._rule, self._progress = reader, take, progress

    def feed(self, chunk: bytes) -> None:
        for group in self._reader.feed(chunk):
            self._take(group)
        if self._progress:
            self._progress(self.count)

    def finish(self) -> None:
        for group in self._reader.finish():
            self._take(group)

    def _take(self, group: object) -> None:
        if isinstance(group, Group) and split(group.node)[0] == "rule":
            self.count += 1
            self._rule(stars.read_rule(group.pairs))


def _dump(store: Store, sink: Sink, name: str, graph: Iri | None) -> None:
    if not isinstance(store, Dumping):
        raise TypeError(f"{store.location} writes no {name}.")
    try:
        store.dump(sink, format=name, graph=graph)
    except StoreError as error:
        raise (sink.failure or error) from error


def _sources(store: Store) -> list[Group]:
    """The utterances that rules come from."""
    utterances = {quad.subject for quad in store.quads(None, stars.TYPE, None, HISTORY)}
    told = sorted(
        node for node in utterances if any(store.quads(None, stars.DERIVED_FROM, node, BELIEFS))
    )
    return [Group(node, HISTORY, store.properties(node, HISTORY)) for node in told]


def _count(store: Store, query: str) -> int:
    ((count,),) = store.select(query)
    return count if isinstance(count, int) else 0
