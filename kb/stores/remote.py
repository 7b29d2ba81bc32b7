"""The store behind a SPARQL 1.1 endpoint of any engine.

It uses only what engines were found to agree on. Every query names the base's graphs as its
dataset, so that an endpoint may hold other data too. Literals are compared by value, because
engines write numbers differently. A result that the endpoint truncates is read page by page.

A unit of up to `BATCH` statements is one update operation, which is atomic if updates of the
endpoint are. A larger one is sent in parts, which may be repeated. Only one process at a time may
write to a base; endpoints do not enforce that.
"""

from __future__ import annotations

import threading
from collections.abc import Iterable, Iterator, Sequence
from contextlib import AbstractContextManager
from decimal import Decimal
from pathlib import Path
from urllib.parse import urlencode, urljoin

from ...ontology.errors import QueryError, StoreError
from ...ontology.vocabulary import GRAPH_NAMES, Iri, iri
from ..rdf.terms import Quad, Term, as_sparql
from ..sparql.query_text import (
    delete_insert,
    insert_data,
    keywords,
    page_query,
    query_form,
    result_limit,
    with_prefixes,
)
from ..sparql.results import (
    BooleanResult,
    ConstructResult,
    QueryLimits,
    QueryResult,
    SelectResult,
    read_boolean,
    read_solutions,
)
from .base import batched
from .http import EndpointConfig, EndpointResponse, EndpointTransport, parse_address

BATCH = 1_000  # statements of one update; some engines take no more than 1,400
MAX_MEGABYTES = 4_096  # of the answer to a call without limits
CALL = QueryLimits(seconds=60, megabytes=MAX_MEGABYTES)
ROWS, TRIPLES = "application/sparql-results+json", "application/n-triples, text/plain;q=0.2"
PAGE = 1_000  # solutions of a page where the endpoint does not say how many it sends
VIRTUOSO, VIRTUOSO_UPDATES = "Virtuoso", "sparql-auth"


class RemoteStore:
    """A store behind an endpoint; `hilt.kb.stores.base.Store` documents its methods."""

    has_cheap_patterns = False

    def __init__(self, transport: EndpointTransport, *, read_only: bool) -> None:
        self.location = transport.address.query
        self.read_only = read_only
        self._transport = transport
        self._address = transport.address
        self._lock = threading.RLock()
        graphs = [str(iri("graph", name)) for name in GRAPH_NAMES]
        self._dataset = {"default-graph-uri": graphs, "named-graph-uri": graphs}
        self._server = ""
        self._is_open = True

    def connect(self) -> None:
        """Note the endpoint's server software; StoreError if it does not answer, or refuses."""
        try:
            self._server = self._read("ASK {}", ROWS, CALL).server
        except QueryError as error:
            raise StoreError(f'"{self.location}" is not a SPARQL endpoint: {error}') from error

    def select(self, query: str, limits: QueryLimits = CALL) -> SelectResult:
        """All rows of a SELECT query, however many the endpoint sends at once."""
        if query_form(query) != "SELECT":
            raise QueryError("Expected a SELECT query.")
        response = self._read(query, ROWS, limits)
        found = read_solutions(response.body)
        if response.max_rows and len(found) >= response.max_rows:
            return self._read_pages(query, found, response.max_rows, limits)
        return found

    def run(self, query: str, limits: QueryLimits | None = None) -> QueryResult:
        """The result of any query; the endpoint's own limits apply too."""
        limits = limits or CALL
        match query_form(query):
            case "ASK":
                return BooleanResult(read_boolean(self._read(query, ROWS, limits).body))
            case "CONSTRUCT" | "DESCRIBE":
                return ConstructResult.from_quads(self._construct(query, limits))
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

    def properties(self, subject: Iri, graph: Iri) -> list[tuple[Iri, Term]]:
        """The properties of a node."""
        return [(quad.predicate, quad.object) for quad in self.quads(subject, graph=graph)]

    def apply(self, *, insert: Iterable[Quad] = (), delete: Iterable[Quad] = ()) -> None:
        """Delete, then insert; one operation when it is not too large for one."""
        old, new = [q for quad in delete for q in _number_variants(quad)], list(insert)
        with self._lock:
            if len(old) + len(new) <= BATCH:
                self._write(delete_insert(old, new), may_repeat=True)
                return
            for part in batched(old, BATCH):
                self._write(delete_insert(part, []), may_repeat=True)
            self._insert(new)

    def update(self, update: str) -> None:
        """Run a SPARQL update, once."""
        with self._lock:
            self._write(with_prefixes(update), may_repeat=False)

    def save(self, target: Path) -> None:
        """Write all statements into a folder on this machine."""
        from .oxigraph import save_quads

        save_quads(self.quads(), target)

    def writing(self) -> AbstractContextManager[object]:
        """A lock between the threads of this process."""
        return self._lock

    def close(self) -> None:
        """Close the connections."""
        self._is_open = False
        self._transport.close()

    def _read_pages(
        self, query: str, first: SelectResult, size: int, limits: QueryLimits
    ) -> SelectResult:
        """The rows of a result that the endpoint truncates after `size`, page by page."""
        rows: list[tuple[Term | None, ...]] = []
        while len(rows) % size == 0:
            text = page_query(query, first.variables, size=size, offset=len(rows))
            page = read_solutions(self._read(text, ROWS, limits).body).rows
            rows += page
            if not page:
                break
        return SelectResult(first.variables, tuple(rows))

    def _construct(self, query: str, limits: QueryLimits) -> list[Quad]:
        is_cut = self._server.startswith(VIRTUOSO) and query_form(query) == "CONSTRUCT"
        if not is_cut or (result_limit(query) or PAGE + 1) <= PAGE:
            return self._triples(query, limits)
        # It truncates statements silently, so they are read in pages from the start.
        found: dict[Quad, None] = {}
        for offset in range(0, 10**9, PAGE):
            page = self._triples(page_query(query, (), size=PAGE, offset=offset), limits)
            if not page:
                break
            found.update(dict.fromkeys(page))
        return list(found)

    def _triples(self, query: str, limits: QueryLimits) -> list[Quad]:
        from .rdf_text import read_triples

        return read_triples(self._read(query, TRIPLES, limits).body, source=self.location)

    def _read(self, query: str, accept: str, limits: QueryLimits) -> EndpointResponse:
        self._check_open()
        fields: dict[str, str | Sequence[str]] = {"query": with_prefixes(query)}
        if "FROM" not in keywords(query):  # a query may name its own dataset
            fields |= self._dataset
        if self._server.startswith(VIRTUOSO):  # else it continues when the client has stopped
            fields["timeout"] = str(max(1_000, int(limits.seconds * 1_000)))
        return self._transport.post(self._address.query, form=fields, accept=accept, limits=limits)

    def _write(self, update: str, *, may_repeat: bool) -> None:
        self._check_writable()
        address = self._address.update
        if self._server.startswith(VIRTUOSO) and not self._address.is_update_given:
            address = urljoin(self._address.query, VIRTUOSO_UPDATES)
        self._transport.post(
            address, form={"update": update}, accept="*/*", limits=CALL, may_repeat=may_repeat
        )

    def _insert(self, quads: Sequence[Quad]) -> None:
        for graph in dict.fromkeys(quad.graph for quad in quads):
            inside = [quad for quad in quads if quad.graph == graph]
            if self._address.graphs and graph:
                self._post(graph, inside)
            else:
                for part in batched(inside, BATCH):
                    self._write(insert_data(part), may_repeat=True)

    def _post(self, graph: Iri, quads: Sequence[Quad]) -> None:
        self._check_writable()
        lines = (" ".join(map(as_sparql, quad[:3])) + " .\n" for quad in quads)
        self._transport.post(
            f"{self._address.graphs}?{urlencode({'graph': graph})}",
            content="".join(lines).encode(),
            content_type="application/n-triples",
            accept="*/*",
            limits=CALL,
        )

    def _check_writable(self) -> None:
        self._check_open()
        if self.read_only:
            raise StoreError(f'The knowledge base "{self.location}" is open for reading only.')

    def _check_open(self) -> None:
        if not self._is_open:
            raise StoreError(f'The knowledge base "{self.location}" is closed.')


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
