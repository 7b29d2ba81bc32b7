# SPDX-License-Identifier: Apache-2.0
"""Exports of any size: nothing is held in memory.

A store on disk has the statements of a node together, so it is gone through once, in its own
order (`scanning`): equal bases still give equal files. What stands elsewhere is gathered rule by
rule (`exchange`).
"""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING, BinaryIO, Protocol, runtime_checkable

from ...ontology.errors import StoreError
from ...ontology.vocabulary import Iri
from ..formats.registry import Format
from ..formats.streams import Progress
from ..history import HISTORY
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import as_sparql
from ..stores.base import Store

if TYPE_CHECKING:
    from .scanning import Take

_FORMATS = frozenset({"nquads", "ntriples", "trig", "turtle"})
_TOLD = 10_000  # lines after which the progress is told
_ANY = "GRAPH ?graph { ?node ?key ?value }"
_TOLD_BY = f"""SELECT DISTINCT ?utterance {{
  GRAPH <{BELIEFS}> {{ ?rule <{rule_mapping.DERIVED_FROM}> ?utterance }}
}}"""


@runtime_checkable
class Dumping(Protocol):
    """A store that writes what it finds as text."""

    @property
    def is_sorted(self) -> bool:
        """Whether it has the statements of a graph node by node."""
        ...

    def dump_rows(self, query: str, stream: OutputStream) -> None:
        """Write the rows of a SELECT query as tab-separated values."""
        ...


class OutputStream:
    """Hands on what a store writes.

    Attributes:
        failure: why that was not possible, where it was not.
    """

    def __init__(self, take: Callable[[bytes], object]) -> None:
        """Hand on to `take`."""
        self.failure: OSError | None = None
        self._take = take

    def write(self, chunk: bytes, /) -> int:
        """Hand on some bytes."""
        try:
            self._take(chunk)
        except OSError as error:  # of the file, not of the store
            self.failure = error
            raise
        return len(chunk)

    def flush(self) -> None:
        """Nothing is held."""


def is_dumped(store: Store, chosen: Format, most: int) -> bool:
    """Whether `dump_statements` is the way to write a store: it has more than `most` statements."""
    return chosen.name in _FORMATS and is_large(store, most)


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
    from .scanning import graphs_of, scan  # they need what is in here
    from .spelling import spelling

    counted, spelt = _Counted(progress), spelling(chosen.name, stream)
    with store.writing():  # so that all of it is of one moment
        told = _told_by(store) if rules_only else None
        for graph in (BELIEFS, HISTORY) if rules_only else graphs_of(store):
            take = counted.over(spelt.begin(graph))
            if told is not None and graph == HISTORY:
                take = _only(told, take)
            scan(store, graph, take)
            spelt.end()
    return counted.total


class _Counted:
    """Counts the statements that go by."""

    def __init__(self, progress: Progress | None) -> None:
        self.total = self._told = 0
        self._progress = progress

    def over(self, take: Take) -> Take:
        """As `take`, counted."""

        def counted(lines: Sequence[str]) -> None:
            take(lines)
            self.total += len(lines)
            if self._progress and self.total - self._told >= _TOLD:
                self._told = self.total
                self._progress(self.total)

        return counted


def _only(nodes: frozenset[str], take: Take) -> Take:
    """As `take`, for the lines about some nodes."""
    return lambda lines: take([line for line in lines if line.split("\t", 1)[0] in nodes])


def _told_by(store: Store) -> frozenset[str]:
    """The utterances that rules come from, as they are written."""
    return frozenset(as_sparql(node) for (node,) in store.select(_TOLD_BY) if isinstance(node, Iri))


def dump_rows(store: Store, query: str, sink: OutputStream) -> None:
    """Write the rows of a SELECT query as tab-separated values.

    Raises:
        OSError: the sink cannot be written to.
        StoreError: the store cannot be read.
    """
    with _told(store, sink) as dumping:
        dumping.dump_rows(query, sink)


@contextmanager
def _told(store: Store, sink: OutputStream) -> Generator[Dumping]:
    """Tell what failed, the store or the file."""
    if not isinstance(store, Dumping):
        raise TypeError(f"{store.location} writes no text.")
    try:
        yield store
    except StoreError as error:
        raise (sink.failure or error) from error


def count(store: Store, query: str) -> int:
    """The number that a query gives."""
    ((found,),) = store.select(query)
    return found if isinstance(found, int) else 0
