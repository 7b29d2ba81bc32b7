"""The store behind a SPARQL 1.1 endpoint of any engine.

It uses only what engines were found to agree on. Every query names the base's graphs as its
dataset, so that an endpoint may hold other data too. Literals are compared by value, because
engines write numbers differently. A result that the endpoint truncates is read page by page.

Several processes may share an endpoint: `writing` gives one of them at a time the right to write
(`write_lease`). A unit of up to `BATCH` statements is one update operation, which is atomic if
operations of the endpoint are. A larger one is prepared in parts and made visible at the end.
"""

import threading
from collections.abc import Generator, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from decimal import Decimal
from pathlib import Path
from typing import cast
from urllib.parse import urlencode, urljoin

from ...ontology.errors import QueryError, StoreError
from ...ontology.vocabulary import GRAPH_NAMES, Iri, iri, is_ontology
from ..rdf.terms import Quad, Term, as_line, as_sparql
from ..sparql import query_text, results
from ..sparql.results import BooleanResult, QueryLimits, SelectResult
from .base import ReadableStore, batched
from .http import EndpointConfig, EndpointResponse, EndpointTransport, parse_address
from .oxigraph import save_quads
from .rdf_text import read_triples
from .write_lease import CHANGES, IS_DECIDED, REPLACES, WriteLease, prepared

POSTED = 10_000  # statements prepared at a time
BATCH = 1_000  # statements of one update; some engines take no more than 1,400
MAX_MEGABYTES = 4_096  # of the answer to a call without limits
CALL = QueryLimits(seconds=60, megabytes=MAX_MEGABYTES)
LONG_CALL = QueryLimits(seconds=3_600, megabytes=MAX_MEGABYTES)  # makes visible what is prepared
ROWS, TRIPLES = "application/sparql-results+json", "application/n-triples, text/plain;q=0.2"
PAGE = 1_000  # solutions of a page where the endpoint does not say how many it sends
_ONTOLOGIES = "SELECT ?graph { GRAPH ?graph { ?graph a owl:Ontology } }"
VIRTUOSO, VIRTUOSO_UPDATES = "Virtuoso", "sparql-auth"


class RemoteStore(ReadableStore):
    """A store behind an endpoint; `hilt.kb.stores.base.Store` documents its methods."""

    has_cheap_patterns = False

    def __init__(self, transport: EndpointTransport, *, read_only: bool) -> None:
        self.location = transport.address.query
        self.read_only = read_only
        self._transport = transport
        self._address = transport.address
        self._lock = threading.RLock()
        self._lease = WriteLease(self.location, self.select, self._write, self._write_all)
        self._graphs = {iri("graph", name) for name in GRAPH_NAMES}
        self._dataset = dict[str, Sequence[str]]()
        self._server = ""
        self._is_open, self._is_sure = True, True  # that the right to write was not lost

    def connect(self) -> None:
        """Note the endpoint's server software, and complete what a dead writer left unfinished.

        A StoreError says that the endpoint does not answer, or refuses.
        """
        try:
            self._server = self._read("ASK {}", ROWS, CALL).server
        except QueryError as error:
            raise StoreError(f'"{self.location}" is not a SPARQL endpoint: {error}') from error
        self._extend_dataset(cast(Iri, graph) for (graph,) in self.select(_ONTOLOGIES))
        self._complete()

    def select(self, query: str, limits: QueryLimits = CALL) -> SelectResult:
        """All rows of a SELECT query, however many the endpoint sends at once."""
        if query_text.query_form(query) != "SELECT":
            raise QueryError("Expected a SELECT query.")
        response = self._read(query, ROWS, limits)
        found, size = results.read_solutions(response.body), response.max_rows
        if not size or len(found) < size:
            return found
        rows: list[tuple[Term | None, ...]] = []
        while len(rows) % size == 0:
            text = query_text.page_query(query, found.variables, size=size, offset=len(rows))
            page = results.read_solutions(self._read(text, ROWS, limits).body).rows
            rows += page
            if not page:
                break
        return SelectResult(found.variables, tuple(rows))

    def run(self, query: str, limits: QueryLimits | None = None) -> results.QueryResult:
        """The result of any query; the endpoint's own limits apply too."""
        limits = limits or CALL
        match query_text.query_form(query):
            case "ASK":
                return BooleanResult(results.read_boolean(self._read(query, ROWS, limits).body))
            case "CONSTRUCT" | "DESCRIBE":
                found = tuple(quad[:3] for quad in self._construct(query, limits))
                return results.ConstructResult(results.STATEMENT, found)
            case _:
                return self.select(query, limits)

    def quads(
        self,
        subject: Iri | None = None,
        predicate: Iri | None = None,
        object: Term | None = None,
        graph: Iri | None = None,
    ) -> Iterator[Quad]:
        """All statements that match."""
        wanted = {"s": subject, "p": predicate, "o": object, "g": graph}
        names = [name for name, term in wanted.items() if term is None]
        s, p, o, g = (f"?{n}" if t is None else as_sparql(t) for n, t in wanted.items())
        where = f"{{ GRAPH {g} {{ {s} {p} {o} }} }}"
        if not names:
            if self.run(f"ASK {where}") == BooleanResult(True):
                yield Quad(subject, predicate, object, graph)  # type: ignore[arg-type]
            return
        for row in self.select(f"SELECT ?{' ?'.join(names)} WHERE {where}"):
            found = wanted | dict(zip(names, row, strict=True))
            yield Quad(*found.values())  # type: ignore[arg-type]

    def apply(self, *, insert: Iterable[Quad] = (), delete: Iterable[Quad] = ()) -> None:
        """Delete, then insert; prepared in parts where it is too large for one operation."""
        self._check_open(to_write=True)
        with self.writing():
            old, new = [q for quad in delete for q in _number_variants(quad)], list(insert)
            if len(old) + len(new) <= BATCH:
                self._extend_dataset(cast(Iri, quad.graph) for quad in new)
                self._write(self._lease.fenced(old, new))
                self._is_sure = False
            else:
                self._write_large({"old": old, "new": new})

    def replace(self, quads: Iterable[Quad]) -> None:
        """Delete everything, then insert statements, as one unit."""
        self._check_open(to_write=True)
        with self.writing():
            self._write_large({"new": quads}, sorted(self._graphs))

    def update(self, update: str) -> None:
        """Run a SPARQL update, once."""
        self._check_open(to_write=True)
        with self.writing():
            self._write(query_text.with_prefixes(update), may_repeat=False)

    def save(self, target: Path) -> None:
        """Write all statements into a folder on this machine."""
        save_quads(self.quads(), target)

    @contextmanager
    def writing(self) -> Generator[None]:
        """The right to write: of one thread of one process; StoreError if others do not end."""
        with self._lock:
            if self.read_only or self._lease.node:
                yield
                return
            try:
                self._lease.acquire()
                self._is_sure = True
                yield
                if not self._is_sure:
                    self._lease.confirmed()
            finally:
                self._lease.release()

    def close(self) -> None:
        """Close the connections."""
        self._is_open = False
        self._transport.close()

    def _complete(self) -> None:
        claims = self._lease.claims()
        if any(one.is_decided or not (one.is_live or self.read_only) for one in claims):
            try:
                self._lease.acquire()
            except StoreError as error:
                raise StoreError(
                    f'The last large write to "{self.location}" is unfinished. It is completed '
                    f"when the base is opened for writing. {error}"
                ) from error
            finally:
                self._lease.release()

    def _extend_dataset(self, graphs: Iterable[Iri]) -> None:
        self._graphs.update(filter(is_ontology, graphs))
        names = sorted(map(str, self._graphs))
        self._dataset = {"default-graph-uri": names, "named-graph-uri": names}

    def _construct(self, query: str, limits: QueryLimits) -> list[Quad]:
        is_cut = self._server.startswith(VIRTUOSO) and query_text.query_form(query) == "CONSTRUCT"
        if not is_cut or (query_text.result_limit(query) or PAGE + 1) <= PAGE:
            return self._triples(query, limits)
        # It truncates statements silently, so they are read in pages from the start.
        found: dict[Quad, None] = {}
        for offset in range(0, 10**9, PAGE):
            page = self._triples(query_text.page_query(query, (), size=PAGE, offset=offset), limits)
            if not page:
                break
            found.update(dict.fromkeys(page))
        return list(found)

    def _triples(self, query: str, limits: QueryLimits) -> list[Quad]:
        return read_triples(self._read(query, TRIPLES, limits).body, source=self.location)

    def _read(self, query: str, accept: str, limits: QueryLimits) -> EndpointResponse:
        self._check_open()
        sent = query_text.with_prefixes(query)
        fields: dict[str, str | Sequence[str]] = {"query": sent}
        if "FROM" not in query_text.keywords(query):  # a query may name its own dataset
            fields |= self._dataset
        if self._server.startswith(VIRTUOSO):  # else it continues when the client has stopped
            fields["timeout"] = str(max(1_000, int(limits.seconds * 1_000)))
        address = self._address.query
        with query_text.errors_as_typed(query, sent):
            return self._transport.post(address, form=fields, accept=accept, limits=limits)

    def _write(self, update: str, *, may_repeat: bool = True, limits: QueryLimits = CALL) -> None:
        self._check_open()
        address = self._address.update
        if self._server.startswith(VIRTUOSO) and not self._address.is_update_given:
            address = urljoin(self._address.query, VIRTUOSO_UPDATES)
        self._transport.post(address, form={"update": update}, limits=limits, may_repeat=may_repeat)

    def _write_all(self, updates: Sequence[str]) -> None:
        for update in updates if self._server.startswith(VIRTUOSO) else [" ;\n".join(updates)]:
            self._write(query_text.with_prefixes(update), limits=LONG_CALL)

    def _write_large(self, parts: Mapping[str, Iterable[Quad]], old: Sequence[Iri] = ()) -> None:
        """Prepare statements by their kind, then decide that they count and make them visible."""
        try:
            self._lease.mark(*((each, graph) for graph in old for each in (CHANGES, REPLACES)))
            self._prepare(parts, {*old})
            self._lease.mark((IS_DECIDED, True))
            self._write_all(self._lease.confirmed().updates())
            self._is_sure = True  # whoever completes it
        except BaseException:
            self._lease.abandon()
            raise

    def _prepare(self, parts: Mapping[str, Iterable[Quad]], marked: set[Iri]) -> None:
        claim = cast(Iri, self._lease.node)
        for kind, quads in parts.items():
            for some in batched(quads, POSTED):
                for graph in sorted({cast(Iri, quad.graph) for quad in some}):
                    if graph not in marked:
                        self._lease.mark((CHANGES, graph))
                        marked.add(graph)
                    self._extend_dataset([graph])
                    inside = [quad for quad in some if quad.graph == graph]
                    self._insert(prepared(claim, kind, graph), inside)

    def _insert(self, graph: Iri, quads: Sequence[Quad]) -> None:
        if self._address.graphs:
            lines = (as_line(quad._replace(graph=None)) for quad in quads)
            url = f"{self._address.graphs}?{urlencode({'graph': graph})}"
            self._transport.post(url, ntriples="".join(lines).encode(), limits=CALL)
            return
        for part in batched(quads, BATCH):
            self._write(query_text.insert_data([quad._replace(graph=graph) for quad in part]))

    def _check_open(self, *, to_write: bool = False) -> None:
        if not self._is_open:
            raise StoreError(f'The knowledge base "{self.location}" is closed.')
        if to_write and self.read_only:
            raise StoreError(f'The knowledge base "{self.location}" is open for reading only.')


def open_remote(location: str | EndpointConfig, *, read_only: bool = False) -> RemoteStore:
    """A store behind an endpoint (see `http`); StoreError if that does not answer, or refuses."""
    address = location if isinstance(location, EndpointConfig) else parse_address(location)
    store = RemoteStore(EndpointTransport(address), read_only=read_only)
    try:
        store.connect()
    except BaseException:
        store.close()
        raise
    return store


def _number_variants(quad: Quad) -> Iterator[Quad]:
    """The statement with its number in each datatype that an engine may have stored."""
    yield quad
    value = quad.object
    if isinstance(value, Decimal) and value == value.to_integral_value():
        yield quad._replace(object=int(value))
    elif type(value) is int:
        yield quad._replace(object=Decimal(value))
