# SPDX-License-Identifier: Apache-2.0
"""The embedded store, in memory or in a folder: the only module that knows its engine.

What the engine leaves to its user is done here. It detects no write conflicts, so one lock is
held round every write. A write survives the death of the process at once, but power loss only
when the disk has its journal, which is waited for before a unit returns (`journal`). The engine
must not be used after a fork, so a store remembers which process opened it. Open results keep the
folder locked, so they are read to the end before they are given out. A query cannot be stopped,
so one that may have to be runs elsewhere (`bounded`).
"""

from __future__ import annotations

import contextlib
import io
import os
import shutil
import tempfile
import threading
from collections.abc import Generator, Iterable, Iterator
from contextlib import AbstractContextManager, contextmanager
from itertools import islice
from pathlib import Path
from typing import Any, BinaryIO, cast

import pyoxigraph as engine

from ...ontology.errors import QueryError, StoreError
from ...ontology.vocabulary import PREFIXES, Iri
from ..bulk.exporter import OutputStream
from ..bulk.statements import Group, Reader, RuleBlock
from ..bulk.texts import fit_for_xml, with_sorted_prefixes
from ..rdf.annotations import Edge, Reified
from ..rdf.terms import LANGUAGE_TEXT, STRING, Quad, Term, lexical, literal
from ..sparql import worker
from ..sparql.limits import Limits
from ..sparql.results import RDF_12, Found, Solutions
from ..sparql.sandbox import Worker
from ..sparql.text import delete_insert, words
from . import snapshots
from .base import MEMORY
from .directory import is_base, remove_leftovers, undo_replacement
from .failures import line_of, open_error, reading_text, reported, syntax_error
from .journal import WriteAheadLog

_MAX_KNOWN = 100_000  # terms that are remembered
_MAX_TERM = 2**24  # bytes of a line with one statement, as the engine has it
_CHUNK = 2**18  # bytes that are read at once
_BATCH = 2_000  # statements that are made into lines at once
_PREFIXES = dict(PREFIXES)
_ABBREVIATED = frozenset({"turtle", "trig"})  # formats with prefixes
_OF_LINES = frozenset({"nquads", "ntriples"})  # formats with one statement a line
RDF_FORMATS = {
    "turtle": engine.RdfFormat.TURTLE,
    "trig": engine.RdfFormat.TRIG,
    "nquads": engine.RdfFormat.N_QUADS,
    "ntriples": engine.RdfFormat.N_TRIPLES,
    "jsonld": engine.RdfFormat.JSON_LD,
    "rdfxml": engine.RdfFormat.RDF_XML,
}


class OxigraphStore:
    """A store that this process owns; see `hilt.kb.stores.base.Store` for its methods."""

    has_cheap_patterns = True

    def __init__(
        self,
        inner: engine.Store,
        location: str,
        *,
        read_only: bool,
        folder: Path | None = None,
        snapshot: Path | None = None,
    ) -> None:
        """Use an open engine.

        Args:
            inner: the engine.
            location: what it is called.
            read_only: whether writes are refused.
            folder: what it owns and writes to; None for the memory and for a snapshot.
            snapshot: what it reads and nothing changes; removed when the store is closed.
        """
        self._inner: engine.Store | None = inner
        self._lock = threading.RLock()
        self._process = os.getpid()
        self._worker = Worker()
        self._folder = folder
        self._journal = WriteAheadLog(folder)
        self._frozen: Path | None = None  # what the worker reads, while it is as the store is
        self._discarded: list[Path] = []  # what it may still be reading
        self._running = threading.Lock()
        self._snapshot = snapshot
        self.location = location
        self.read_only = read_only

    def select(self, query: str) -> Solutions:
        """The rows of a SELECT query, all of them."""
        found = self._run(query)
        if not isinstance(found, engine.QuerySolutions):
            raise QueryError("Expected a SELECT query.")
        names = tuple(variable.value for variable in found.variables)
        with reported(self.location):
            rows = tuple(tuple(None if t is None else _term(t) for t in row) for row in found)
        return Solutions(names, rows)

    def ask(self, query: str) -> bool:
        """The answer of an ASK query."""
        found = self._run(query)
        if not isinstance(found, engine.QueryBoolean):
            raise QueryError("Expected an ASK query.")
        return bool(found)

    def construct(self, query: str) -> list[Quad]:
        """The statements of a CONSTRUCT or DESCRIBE query."""
        found = self._run(query)
        if not isinstance(found, engine.QueryTriples):
            raise QueryError("Expected a CONSTRUCT or DESCRIBE query.")
        with reported(self.location):
            return [Quad(*(_term(part) for part in triple)) for triple in found]  # pyright: ignore[reportArgumentType]

    def run(self, query: str, limits: Limits) -> Found:
        """Any query, in a process of its own, over the store as it is now."""
        with self._running:
            with self._lock:
                self._discard()
                source = self._freeze()
            return self._worker.run(source, query, limits)

    def serialized(self, query: str) -> tuple[str, bytes]:
        """The answer of any query as a document, and which kind it is (see `worker`)."""
        found = self._run(query)
        with reported(self.location, query):
            if isinstance(found, engine.QueryTriples):
                written = found.serialize(format=engine.RdfFormat.N_TRIPLES)
                return worker.TRIPLES, cast(bytes, written)
            kind = worker.ANSWER if isinstance(found, engine.QueryBoolean) else worker.ROWS
            answer = cast("engine.QuerySolutions | engine.QueryBoolean", found)
            return kind, cast(bytes, answer.serialize(format=engine.QueryResultsFormat.JSON))

    def quads(
        self,
        subject: Iri | None = None,
        predicate: Iri | None = None,
        object: Term | None = None,  # noqa: A002 - the name RDF gives it
        graph: Iri | None = None,
    ) -> Iterator[Quad]:
        """All statements that match."""
        found = self._engine().quads_for_pattern(
            None if subject is None else engine.NamedNode(subject),
            None if predicate is None else engine.NamedNode(predicate),
            None if object is None else _engine_term(object),
            None if graph is None else engine.NamedNode(graph),
        )
        with reported(self.location):
            for quad in found:
                yield _quad(quad)

    def properties(self, subject: Iri, graph: Iri) -> list[tuple[Iri, Term]]:
        """Everything that stands at a node."""
        # The hot read: only what is wanted is turned into terms of ours.
        with reported(self.location):
            found = self._engine().quads_for_pattern(
                engine.NamedNode(subject), None, None, engine.NamedNode(graph)
            )
            return [(Iri(quad.predicate.value), _term(quad.object)) for quad in found]

    def apply(self, *, insert: Iterable[Quad] = (), delete: Iterable[Quad] = ()) -> None:
        """Delete, then insert, as one unit."""
        gone, new = list(delete), list(insert)
        with self._changing() as store:
            if gone:
                store.update(delete_insert(gone, new))
            else:
                store.extend([_engine_quad(quad) for quad in new])

    def update(self, update: str) -> None:
        """Run a SPARQL update as one unit."""
        with self._changing(update) as store:
            store.update(update, prefixes=_PREFIXES)

    def load(self, lines: Iterable[bytes]) -> None:
        """Add the statements of lines of N-Quads as one unit; the fast way for millions.

        The engine sorts and writes in threads of its own while the lines are made. An error that
        they raise goes through, and nothing is added.
        """
        with self._changing() as store:
            stream = cast(BinaryIO, _Stream(lines))
            try:
                # Lenient: Hilt has checked what it writes; to do so again takes a tenth longer.
                store.bulk_load(stream, format=engine.RdfFormat.N_QUADS, lenient=True)
            except BaseException:
                if self._folder:  # the parts that were written would stay
                    remove_leftovers(self._folder)
                raise
            store.flush()

    @property
    def is_sorted(self) -> bool:
        """Whether `quads` of a graph has the statements of a node together."""
        return self._folder is not None or self._snapshot is not None

    def dump_rows(self, query: str, stream: OutputStream) -> None:
        """Write the rows of a SELECT query as tab-separated values, as they are found."""
        found = self._run(query)
        with reported(self.location, query):
            rows = cast("engine.QuerySolutions", found)
            rows.serialize(cast(BinaryIO, stream), format=engine.QueryResultsFormat.TSV)

    def writing(self) -> AbstractContextManager[object]:
        """The lock round every write; the same thread may take it again."""
        return self._lock

    def close(self) -> None:
        """Let go of the folder."""
        with self._lock:
            self._worker.close()
            if self._inner is not None and self._journal.has_changes:
                with contextlib.suppress(OSError):  # the journal has it all
                    self._write_tables(self._inner)
            self._inner = None
            self._thaw()
            self._discard()
            if self._snapshot:
                snapshots.remove(self._snapshot)
                self._snapshot = None

    def save(self, target: Path) -> None:
        """Write a copy of the store as it is now into a new folder, which can be opened.

        Raises:
            StoreError: it cannot be written.
        """
        with self._lock, reported(self.location):
            store = self._engine()
            if self._snapshot:
                shutil.copytree(self._snapshot, target)
            elif self._folder:
                store.backup(target)
            else:
                _write_folder(store, target)

    def _freeze(self) -> Path:
        """What a worker can read: a snapshot of a folder, or all statements in a file."""
        store = self._engine()
        if self._snapshot:
            return self._snapshot
        if self._frozen is None:
            with reported(self.location):
                if self._folder:
                    # The engine wants to make the last folder itself.
                    self._frozen = snapshots.place(self._folder) / "base"
                    store.backup(self._frozen)
                else:
                    self._frozen = Path(tempfile.mkdtemp(prefix="hilt-")) / "base.nq"
                    store.dump(str(self._frozen), format=engine.RdfFormat.N_QUADS)
        return self._frozen

    def _write_tables(self, store: engine.Store) -> None:
        store.flush()
        self._journal.tables_written()

    def _thaw(self) -> None:
        """Forget what the worker was given, because the store is not like that any more."""
        if self._frozen is not None:
            self._discarded.append(self._frozen.parent)
            self._frozen = None

    def _discard(self) -> None:
        while self._discarded:
            snapshots.remove(self._discarded.pop())

    def _run(self, query: str) -> object:
        with reported(self.location, query):
            # The engine would not look at the graphs that a query itself chooses (FROM).
            is_union = "from" not in query.lower() or "FROM" not in words(query)
            return self._engine().query(
                query, prefixes=_PREFIXES, use_default_graph_as_union=is_union
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
        with self._lock, reported(self.location, update):
            store = self._engine()
            if self.read_only:
                raise StoreError(f'The knowledge base "{self.location}" is open for reading only.')
            self._thaw()
            yield store
            if not self._journal.keep():
                self._write_tables(store)


class _Stream:
    """Chunks as a file that the engine reads."""

    def __init__(self, chunks: Iterable[bytes]) -> None:
        self._chunks = iter(chunks)
        self._held = memoryview(b"")

    def read(self, size: int = -1) -> bytes:
        """At most so many bytes; none at the end."""
        while not self._held:
            chunk = next(self._chunks, None)
            if chunk is None:
                return b""
            self._held = memoryview(chunk)
        end = len(self._held) if size < 0 else size
        found, self._held = bytes(self._held[:end]), self._held[end:]
        return found


def open_memory(*, read_only: bool = False) -> OxigraphStore:
    """An empty store that lives as long as the process."""
    return OxigraphStore(engine.Store(), MEMORY, read_only=read_only)


def open_folder(folder: Path, *, read_only: bool = False) -> OxigraphStore:
    """A store in a folder, which is made when it is not there.

    Raises:
        StoreError: the folder is in use, cannot be written, holds something else, or is damaged.
    """
    try:
        undo_replacement(folder)
        is_there = is_base(folder)
        if read_only:
            if not is_there:
                raise StoreError(f'There is no knowledge base "{folder}" to read.')
            return _open_snapshot(snapshots.take(folder), str(folder))
        folder.mkdir(parents=True, exist_ok=True)
        snapshots.remove_stale(folder)
        opened = engine.Store(str(folder))
        remove_leftovers(folder)
        return OxigraphStore(opened, str(folder), read_only=False, folder=folder)
    except (OSError, RuntimeError) as error:  # damage is told as a RuntimeError
        raise open_error(folder, error) from error


def open_snapshot(snapshot: Path) -> OxigraphStore:
    """A store over a snapshot that somebody else removes.

    Raises:
        StoreError: it cannot be read.
    """
    try:
        return OxigraphStore(engine.Store.read_only(str(snapshot)), str(snapshot), read_only=True)
    except (OSError, RuntimeError) as error:
        raise open_error(snapshot, error) from error


def load_file(file: Path) -> OxigraphStore:
    """A store in memory with the statements of a file of N-Quads that Hilt wrote.

    Raises:
        StoreError: it cannot be read.
    """
    store = engine.Store()
    with reported(str(file)):
        store.bulk_load(path=file, format=engine.RdfFormat.N_QUADS)
    return OxigraphStore(store, str(file), read_only=True)


def read_rdf(
    stream: BinaryIO,
    *,
    format: str,  # noqa: A002
    source: str,
    default: Iri,
) -> Iterator[Quad | Reified]:
    """The statements of an RDF text, one after the other as they are read.

    Args:
        stream: the text in UTF-8.
        format: one of `RDF_FORMATS`.
        source: its name in messages.
        default: the graph of statements that name none.

    Raises:
        DataError: it is wrong; says where.
    """
    terms = _Terms()
    with reading_text(source):
        try:
            for quad in engine.parse(stream, format=RDF_FORMATS[format]):
                yield _placed(quad, terms, default)
        except SyntaxError as error:
            raise syntax_error(error, source, line_of(stream, error.lineno or 0)) from error


def read_groups(
    stream: BinaryIO,
    *,
    format: str,  # noqa: A002
    source: str,
    default: Iri,
) -> Iterator[Group | RuleBlock | Reified]:
    """As `read_rdf`, the statements of one node together where they stand so."""
    with reading_text(source):
        if format in _OF_LINES:
            yield from _read_lines(stream, format=format, source=source, default=default)
        else:
            yield from _read_other(stream, format=format, source=source, default=default)


def _read_lines(
    stream: BinaryIO,
    *,
    format: str,  # noqa: A002
    source: str,
    default: Iri,
) -> Iterator[Group | RuleBlock | Reified]:
    """As `read_groups`, for the formats with one statement a line."""
    reader = line_reader(format, source=source, default=default)
    while chunk := stream.read(_CHUNK):
        yield from reader.feed(chunk)
        if reader.held > _MAX_TERM:
            raise MemoryError
    yield from reader.finish()


def _read_other(
    stream: BinaryIO,
    *,
    format: str,  # noqa: A002
    source: str,
    default: Iri,
) -> Iterator[Group | RuleBlock | Reified]:
    """As `read_groups`, for the other formats: the engine makes lines of them."""
    chosen = RDF_FORMATS[format]
    lines = "nquads" if chosen.supports_datasets else "ntriples"
    reader = line_reader(lines, source=source, default=default)
    try:
        quads = engine.parse(stream, format=chosen)
        while some := list(islice(quads, _BATCH)):
            if not chosen.supports_datasets:
                some = [quad.triple for quad in some]
            text = cast(bytes, engine.serialize(some, format=RDF_FORMATS[lines]))
            yield from reader.feed(text)
    except SyntaxError as error:
        raise syntax_error(error, source, line_of(stream, error.lineno or 0)) from error
    yield from reader.finish()


def line_reader(format: str, *, source: str, default: Iri) -> Reader:  # noqa: A002
    """A reader of N-Quads or N-Triples; arguments as for `read_rdf`.

    It raises DataError where a line is wrong.
    """
    terms, chosen = _Terms(), RDF_FORMATS[format]

    def parse(line: str) -> list[Quad | Reified]:
        try:
            return [_placed(quad, terms, default) for quad in engine.parse(line, format=chosen)]
        except SyntaxError as error:
            raise syntax_error(error, source, line, reader.line) from error

    reader = Reader(parse, default=default, has_graphs=chosen.supports_datasets)
    return reader


def read_triples(data: bytes, *, source: str) -> list[Quad]:
    """The statements of an N-Triples text, in no graph.

    Raises:
        QueryError: it is wrong or holds what RDF 1.1 has not; `source` sent it.
    """
    with reported(source):
        return [_quad(quad) for quad in engine.parse(data, format=engine.RdfFormat.N_TRIPLES)]


def save_quads(quads: Iterable[Quad], target: Path) -> None:
    """Write statements into a new folder, which can be opened.

    Raises:
        StoreError: it cannot be written.
    """
    with reported(str(target)):
        _write_folder((_engine_quad(quad) for quad in quads), target)


def write_rdf(quads: Iterable[Quad], *, format: str) -> bytes:  # noqa: A002
    """Statements as RDF text in UTF-8, with the prefixes of the vocabulary.

    Args:
        quads: what to write; for turtle and ntriples their graphs are left out.
        format: one of `RDF_FORMATS`.
    """
    stream = io.BytesIO()
    write_rdf_to(quads, stream, format=format)
    written = stream.getvalue()
    return with_sorted_prefixes(written) if format in _ABBREVIATED else written


def write_rdf_to(quads: Iterable[Quad], stream: BinaryIO, *, format: str) -> None:  # noqa: A002
    """Statements as RDF text into a stream, one after the other; as `write_rdf` otherwise.

    Raises:
        DataError: a text has a character that XML cannot hold.
    """
    chosen = RDF_FORMATS[format]
    if chosen == engine.RdfFormat.RDF_XML:
        quads = map(fit_for_xml, quads)
    terms = _EngineTerms()
    if chosen.supports_datasets:
        statements = (terms.quad(quad) for quad in quads)
    else:
        statements = (terms.triple(quad) for quad in quads)
    engine.serialize(statements, stream, format=chosen, prefixes=_PREFIXES)


def _open_snapshot(snapshot: Path, location: str) -> OxigraphStore:
    """A store over a snapshot of its own."""
    try:
        inner = engine.Store.read_only(str(snapshot))
    except BaseException:
        snapshots.remove(snapshot)
        raise
    return OxigraphStore(inner, location, read_only=True, snapshot=snapshot)


def _write_folder(quads: Iterable[engine.Quad], target: Path) -> None:
    store = engine.Store(str(target))
    store.bulk_extend(quads)
    store.flush()


def _term(term: Any) -> Term:
    kind = type(term)
    if kind is engine.NamedNode:
        return Iri(term.value)
    if kind is engine.Literal:
        return literal(term.value, term.datatype.value, term.language or "")
    if kind is engine.BlankNode:
        return Iri(str(term))
    raise QueryError(RDF_12)


def _quad(quad: engine.Quad) -> Quad:
    graph = quad.graph_name
    return Quad(
        cast(Iri, _term(quad.subject)),
        Iri(quad.predicate.value),
        _term(quad.object),
        None if isinstance(graph, engine.DefaultGraph) else cast(Iri, _term(graph)),
    )


def _engine_term(term: Term) -> engine.NamedNode | engine.Literal:
    if isinstance(term, Iri):
        return engine.NamedNode(term)
    text, datatype, language = lexical(term)
    if datatype == STRING:
        return engine.Literal(text)
    if datatype == LANGUAGE_TEXT and language:
        return engine.Literal(text, language=language)
    return engine.Literal(text, datatype=engine.NamedNode(datatype))


class _Terms:
    """Our terms for those of the engine; the same few names come again and again."""

    def __init__(self) -> None:
        self._known: dict[object, Any] = {}

    def of(self, term: object) -> Any:
        """A term; statements about which something is said are not among them."""
        known = self._known.get(term)
        if known is None:
            if len(self._known) > _MAX_KNOWN:
                self._known.clear()
            known = self._known[term] = _term(term)
        return known


class _EngineTerms:
    """The engine's terms for ours; as `_Terms`."""

    def __init__(self) -> None:
        self._known: dict[str, engine.NamedNode] = {}

    def node(self, node: Iri) -> engine.NamedNode:
        """An IRI."""
        known = self._known.get(node)
        if known is None:
            if len(self._known) > _MAX_KNOWN:
                self._known.clear()
            known = self._known[node] = engine.NamedNode(node)
        return known

    def triple(self, quad: Quad) -> engine.Triple:
        """A statement without its graph."""
        value = quad.object
        return engine.Triple(
            self.node(quad.subject),
            self.node(quad.predicate),
            self.node(value) if isinstance(value, Iri) else _engine_term(value),
        )

    def quad(self, quad: Quad) -> engine.Quad:
        """A statement with its graph."""
        graph = engine.DefaultGraph() if quad.graph is None else self.node(quad.graph)
        triple = self.triple(quad)
        return engine.Quad(triple.subject, triple.predicate, triple.object, graph)


def _placed(quad: engine.Quad, terms: _Terms, default: Iri) -> Quad | Reified:
    value, graph = quad.object, quad.graph_name
    subject, predicate = terms.of(quad.subject), terms.of(quad.predicate)
    place = default if isinstance(graph, engine.DefaultGraph) else terms.of(graph)
    if isinstance(value, engine.Triple):
        about = Edge(*(terms.of(part) for part in value))
        return Reified(subject, predicate, about, place)
    return Quad(subject, predicate, terms.of(value), place)


def _engine_quad(quad: Quad) -> engine.Quad:
    graph = engine.DefaultGraph() if quad.graph is None else engine.NamedNode(quad.graph)
    return engine.Quad(
        engine.NamedNode(quad.subject),
        engine.NamedNode(quad.predicate),
        _engine_term(quad.object),
        graph,
    )
