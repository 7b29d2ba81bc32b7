"""The embedded store: pyoxigraph in memory or in a folder, behind the `Store` protocol.

What pyoxigraph leaves to its user is done here. It detects no write conflicts, so one lock is held
round every write. A write survives the death of the process at once, but a power failure only when
its write-ahead log is on disk, which is waited for before a unit returns (`WriteAheadLogSync`). It
must not be used after a fork, so a store remembers which process opened it. Open results keep the
folder locked, so they are read to the end before they are given out. A query cannot be stopped, so
one with limits runs in another process (`query_subprocess`).
"""

import contextlib
import os
import shutil
import threading
from collections import deque
from collections.abc import Generator, Iterable, Iterator, Sequence
from contextlib import AbstractContextManager, contextmanager
from pathlib import Path
from typing import Any, BinaryIO, TypeAlias, cast

import pyoxigraph as engine

from ...ontology.errors import QueryError, StoreError
from ...ontology.logs import timed
from ...ontology.vocabulary import PREFIXES, Iri
from ..rdf.terms import Properties, Quad, Term
from ..sparql import results
from ..sparql.query_text import delete_insert, keywords
from . import directory
from .base import MEMORY, ChunkReader, last_utterance
from .errors import open_error, translated_errors
from .mark import WriteAheadLogSync, check_files, check_number
from .query_subprocess import WorkerProcess
from .rdf_text import from_engine, named_node, quad_from_engine, quad_to_engine, to_engine

_PREFIXES = dict(PREFIXES)
_Found: TypeAlias = "engine.QuerySolutions | engine.QueryBoolean | engine.QueryTriples"
# The places in a statement that choose each of the engine's indexes, but for the one by which it
# goes through all statements.
_INDEXES = ((0,), (1,), (1, 3), (2,), (2, 3))


class OxigraphStore:
    """A store that this process owns; `hilt.kb.stores.base.Store` documents its methods."""

    has_cheap_patterns = True

    def __init__(
        self,
        inner: engine.Store,
        location: str,
        *,
        read_only: bool,
        folder: Path | None = None,
        snapshot: directory.Snapshot | None = None,
    ) -> None:
        self._inner: engine.Store | None = inner
        self._lock = threading.RLock()
        self._process = os.getpid()
        self._worker = WorkerProcess()
        self._folder = folder
        self._log = WriteAheadLogSync(folder) if folder else None
        self._snapshot = snapshot  # what is read, by a worker too; None where that would be old
        self.changes = 0  # units that were written here; an answer holds until there is one more
        self.location = location
        self.read_only = read_only

    def select(self, query: str) -> results.SelectResult:
        """All rows of a SELECT query."""
        found = self._evaluate(query)
        if type(found) is not results.SelectResult:
            raise QueryError("Expected a SELECT query.")
        return found

    def run(self, query: str, limits: results.QueryLimits | None = None) -> results.QueryResult:
        """The result of any query; with limits evaluated in another process over a snapshot."""
        if limits is None:
            return self._evaluate(query)
        snapshot = self.snapshot()  # kept, as its folder goes with it
        with timed(__name__, "query with limits %s", query):
            return self._worker.request(limits, source=str(snapshot.path), query=query)

    def snapshot(self) -> directory.Snapshot:
        """What is stored now, for other processes; the same one until something changes."""
        with self._lock:
            self._snapshot = self._snapshot or self._take_snapshot()
            return self._snapshot

    def is_current(self, snapshot: directory.Snapshot) -> bool:
        """Whether nothing has changed since a snapshot of this store."""
        return snapshot is self._snapshot

    def document(
        self,
        query: str,
        formats: Sequence[str | None],
        *,
        base: str | None = None,
        dataset: tuple[Sequence[str], Sequence[str]] | None = None,
        is_union: bool = True,
    ) -> tuple[str, bytes]:
        """The result of a query as a document in UTF-8, after its media type.

        `formats` are the media types for rows, for a boolean, and for statements; where one is
        None, both parts of the answer are empty. `dataset` has the graphs that are its default
        graph, and the named ones. By default the query says them, or, with `is_union`, all are.
        """
        names = zip(("default_graph", "named_graphs"), dataset or (), strict=bool(dataset))
        with timed(__name__, "query %s", query), translated_errors(self.location, query):
            graphs = {key: list(map(named_node, given)) for key, given in names}
            found: Any = self._run(query, base_iri=base, is_union=is_union and not graphs, **graphs)
            kinds = (engine.QuerySolutions, engine.QueryBoolean, engine.QueryTriples)
            if (media_type := formats[kinds.index(type(found))]) is None:
                return "", b""
            is_graph = isinstance(found, engine.QueryTriples)
            known = engine.RdfFormat if is_graph else engine.QueryResultsFormat
            return media_type, found.serialize(format=known.from_media_type(media_type))

    def _evaluate(self, query: str) -> results.QueryResult:
        with timed(__name__, "query %s", query), translated_errors(self.location, query):
            if isinstance(found := self._run(query), engine.QueryBoolean):
                return results.BooleanResult(bool(found))
            if isinstance(found, engine.QueryTriples):
                parts = (tuple(map(from_engine, triple)) for triple in found)
                return results.ConstructResult(results.STATEMENT, tuple(parts))
            names = tuple(variable.value for variable in found.variables)
            rows = (tuple(None if t is None else from_engine(t) for t in row) for row in found)
            return results.SelectResult(names, tuple(rows))

    def quads(
        self,
        subject: Iri | None = None,
        predicate: Iri | None = None,
        object: Term | None = None,
        graph: Iri | None = None,
    ) -> Iterator[Quad]:
        """All statements that match."""
        found = self._engine().quads_for_pattern(
            None if subject is None else named_node(subject),
            None if predicate is None else named_node(predicate),
            None if object is None else to_engine(object),
            None if graph is None else named_node(graph),
        )
        with translated_errors(self.location):
            try:
                for quad in found:
                    yield quad_from_engine(quad)
            finally:  # only this thread may free it, also where not all was read
                del found

    def properties(self, subject: Iri, graph: Iri) -> Properties:
        """The properties of a node."""
        # The most frequent read: only predicates and objects are converted.
        with translated_errors(self.location):
            found = self._engine().quads_for_pattern(
                named_node(subject), None, None, named_node(graph)
            )
            return [(Iri(quad.predicate.value), from_engine(quad.object)) for quad in found]

    def apply(self, *, insert: Iterable[Quad] = (), delete: Iterable[Quad] = ()) -> None:
        """Delete, then insert, as one unit."""
        old, new = list(delete), list(insert)
        with self._changing() as store:
            if old:
                store.update(delete_insert(old, new))
            else:
                store.extend([quad_to_engine(quad) for quad in new])

    def update(self, update: str) -> None:
        """Run a SPARQL update as one unit."""
        with self._changing(update) as store:
            store.update(update, prefixes=_PREFIXES)

    def load(self, lines: Iterable[bytes]) -> None:
        """Add the statements of lines of N-Quads as one unit; the fast way for millions.

        pyoxigraph sorts and writes in its own threads while the lines are generated. An error of
        the generator is passed on, and nothing is added.
        """
        with self._changing() as store:
            stream = cast(BinaryIO, ChunkReader(lines))
            try:
                # Lenient: Hilt has checked the lines; checking them again takes a tenth longer.
                store.bulk_load(stream, format=engine.RdfFormat.N_QUADS, lenient=True)
            except BaseException:
                if self._folder:  # the parts that were written would stay
                    directory.remove_leftovers(self._folder)
                raise
            store.flush()

    @property
    def is_sorted(self) -> bool:
        """Whether `quads` of a graph has the statements of a node together."""
        return self.location != MEMORY

    def statements(self, graph: Iri) -> Iterator[engine.Quad]:
        """The statements of a graph as pyoxigraph has them."""
        return self._engine().quads_for_pattern(None, None, None, named_node(graph))

    def check_tables(self) -> None:
        """Read every statement by each index of the engine; StoreError if a table is damaged."""
        by_index = [set[tuple[object, ...]]() for _ in _INDEXES]
        with self._lock, translated_errors(self.location):
            count = 0
            deque(self._engine().named_graphs(), maxlen=0)
            for quad in self._engine().quads_for_pattern(None, None, None, None):
                count += 1
                for patterns, kept in zip(by_index, _INDEXES, strict=True):
                    patterns.add(tuple(quad[at] if at in kept else None for at in range(4)))
            for patterns in by_index:
                found = map(self._engine().quads_for_pattern, *zip(*patterns, strict=True))
                if sum(1 for some in found for _ in some) != count:
                    damage = f'The knowledge base "{self.location}" is damaged:'
                    advice = "Restore it from a backup or an export."
                    raise StoreError(f"{damage} its indexes differ. {advice}")

    def checked(self, number: int) -> "OxigraphStore":
        """The store, marked as acknowledged; StoreError if it ends before this utterance."""
        try:
            check_number(last_utterance(self), number, self.location)
            if self._log:
                self._log.reset(last_utterance(self))
        except BaseException:
            self.close()
            raise
        return self

    def writing(self) -> AbstractContextManager[object]:
        """The lock round every write; the same thread may take it again."""
        return self._lock

    def close(self) -> None:
        """Close the store and release its folder."""
        with self._lock:
            self._worker.close()
            if self._inner is not None and self._log and self._log.changes:
                with contextlib.suppress(OSError):  # the log has it all
                    self._write_tables(self._inner, self._log)
            self._inner = self._snapshot = None

    def save(self, target: Path) -> None:
        """Write a copy of the store as it is now into a new folder, which can be opened."""
        with self._lock, translated_errors(self.location):
            store = self._engine()
            if self._folder:
                store.backup(target)
                WriteAheadLogSync(target).reset(last_utterance(self))
            elif self._snapshot:
                shutil.copytree(self._snapshot.path, target)
            else:
                _write_folder(store, target)

    def _take_snapshot(self) -> directory.Snapshot:
        if self._folder:
            snapshot = directory.take_snapshot(self._folder)
        else:
            snapshot = directory.Snapshot(None)
            snapshot.path.rmdir()  # pyoxigraph makes it itself
            self.save(snapshot.path)
        snapshot.number = last_utterance(self)
        return snapshot

    def _write_tables(self, store: engine.Store, log: WriteAheadLogSync) -> None:
        store.flush()
        log.reset(last_utterance(self))

    def _run(self, query: str, *, is_union: bool = True, **options: Any) -> _Found:
        # As a union, pyoxigraph ignores the graphs that a query itself chooses (FROM).
        is_union = is_union and ("from" not in query.lower() or "FROM" not in keywords(query))
        return self._engine().query(
            query, prefixes=_PREFIXES, use_default_graph_as_union=is_union, **options
        )

    def _engine(self) -> engine.Store:
        if self._inner is None:
            raise StoreError(f'The knowledge base "{self.location}" is closed.')
        if os.getpid() != self._process:
            raise StoreError(
                f'The knowledge base "{self.location}" was opened by another process. '
                "Open it after a fork, not before."
            )
        return self._inner

    @contextmanager
    def _changing(self, update: str = "") -> Generator[engine.Store]:
        doing = timed(__name__, "write %s", update or "statements")
        with doing, self._lock, translated_errors(self.location, update):
            store = self._engine()
            if self.read_only:
                raise StoreError(f'The knowledge base "{self.location}" is open for reading only.')
            self._snapshot = None
            yield store
            self.changes += 1
            if self._log and not self._log.sync(last_utterance(self)):
                self._write_tables(store, self._log)


def open_memory(*, read_only: bool = False) -> OxigraphStore:
    """An empty store that lives as long as the process."""
    return OxigraphStore(engine.Store(), MEMORY, read_only=read_only)


def open_folder(folder: Path, *, read_only: bool = False) -> OxigraphStore:
    """A store in a folder, which is created if it does not exist.

    StoreError if the folder is in use, cannot be written, holds something else, or is damaged.
    """
    location = str(folder)
    try:
        directory.undo_replacement(folder)
        if not directory.is_base(folder) and read_only:
            raise StoreError(f'There is no knowledge base "{folder}" to read.')
        if read_only:
            snapshot = directory.take_snapshot(folder)
            number = check_files(snapshot.path, location)
            inner = engine.Store.read_only(str(snapshot.path))
            store = OxigraphStore(inner, location, read_only=True, snapshot=snapshot)
        else:
            folder.mkdir(parents=True, exist_ok=True)
            directory.remove_what_dead_processes_left(folder)
            number = check_files(folder, location)
            # No other name for the engine: the traceback of an error would keep it, and its lock.
            store = OxigraphStore(engine.Store(location), location, read_only=False, folder=folder)
            directory.remove_leftovers(folder)
        return store.checked(number)
    except (OSError, RuntimeError) as error:  # a damaged folder raises RuntimeError
        raise open_error(folder, error) from error


def open_snapshot(snapshot: Path) -> OxigraphStore:
    """A store over a snapshot that the caller removes; StoreError if it cannot be read."""
    try:
        return OxigraphStore(engine.Store.read_only(str(snapshot)), str(snapshot), read_only=True)
    except (OSError, RuntimeError) as error:
        raise open_error(snapshot, error) from error


def save_quads(quads: Iterable[Quad], target: Path) -> None:
    """Write statements into a new folder, which can be opened; StoreError on failure."""
    with translated_errors(str(target)):
        _write_folder(map(quad_to_engine, quads), target)


def _write_folder(quads: Iterable[engine.Quad], target: Path) -> None:
    store = engine.Store(str(target))
    store.bulk_extend(quads)
    store.flush()
