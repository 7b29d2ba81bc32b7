"""SPARQL 1.1 Protocol and Graph Store Protocol over HTTP, of a base or of a bare store."""

from collections.abc import Awaitable, Callable, Hashable
from dataclasses import dataclass, field
from functools import lru_cache
from http import HTTPStatus
from typing import Any
from urllib.parse import parse_qs
from uuid import uuid4

from python_multipart.multipart import parse_options_header
from starlette.datastructures import UploadFile
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from ...kb.rdf.terms import as_sparql
from ...kb.sparql.query_text import lookup, refuse_external_access
from ...kb.sparql.results import BooleanResult, QueryLimits
from ...kb.sparql.update_operations import with_dataset
from ...kb.stores.base import last_utterance
from ...kb.stores.oxigraph import OxigraphStore
from ...kb.stores.query_pool import QueryPool
from ...kb.stores.rdf_text import as_ntriples
from ...ontology.vocabulary import Iri
from .problems import Problem

BOOLEANS = ("application/sparql-results+json", "application/sparql-results+xml",
            "application/json", "application/xml")  # fmt: skip
ROWS = (*BOOLEANS, "text/csv", "text/tab-separated-values")
STATEMENTS = ("text/turtle", "application/n-triples", "application/rdf+xml")
LIMITS = QueryLimits()
MOST_BYTES, MOST_KNOWN = 10_000, 4_000  # of what is answered at once and kept; such answers
_FORM, _HTML, _MULTIPART = "application/x-www-form-urlencoded", "text/html", "multipart/form-data"
_DEFAULT = Iri("")  # the graph without a name
_MOST_FIELDS = 1_000
_DESCRIPTION = """PREFIX sd: <http://www.w3.org/ns/sparql-service-description#>
CONSTRUCT { [] a sd:Service ; sd:endpoint <> ; sd:feature sd:UnionDefaultGraph ;
  sd:supportedLanguage sd:SPARQL11Query , sd:SPARQL11Update } WHERE {}"""


@dataclass(frozen=True)
class SparqlEndpoint:
    """Answers `/sparql`, `/update` and `/store`; its pool is to be closed before its store.

    `admit` returns the speaker for whom a request asks; a problem if that one may not read or,
    where its second argument is true, write. `update` runs one, whose relative IRIs a base IRI
    resolves, for a speaker. A browser that asks nothing sees the `page`. Look-ups are kept.
    """

    store: OxigraphStore
    pool: QueryPool
    admit: Callable[[Request, bool], str]
    update: Callable[[str, str, str], Awaitable[object]]
    page: str = ""
    _known: dict[Hashable, tuple[str, bytes, int]] = field(default_factory=dict, init=False)

    @property
    def routes(self) -> list[Route]:
        """The routes of both protocols."""
        places, writing = ("/store", "/store/{path:path}"), ["PUT", "POST", "DELETE"]
        return [
            Route("/sparql", self._query, methods=["GET", "POST"]),
            Route("/update", self._update, methods=["POST"]),
            *(Route(place, self._read_graph) for place in places),
            *(Route(place, self._write_graph, methods=writing) for place in places),
        ]

    async def _query(self, request: Request) -> Response:
        accept = request.headers.get("accept", "*/*")
        formats = tuple(_accepted(accept, offered) for offered in (ROWS, BOOLEANS, STATEMENTS))
        asks_nothing = request.method != "POST" and not request.scope["query_string"]
        if asks_nothing and self.page and _accepted(accept, (*STATEMENTS, _HTML)) == _HTML:
            return RedirectResponse(self.page, 303)
        self.admit(request, False)
        text, dataset = _DESCRIPTION, None
        if not asks_nothing:
            text, dataset = await _read(request, "query", ("default-graph-uri", "named-graph-uri"))
        base = _address(request)
        return await self._answer(request, text, formats=formats, base=base, dataset=dataset)

    async def _update(self, request: Request) -> Response:
        speaker = self.admit(request, True)
        graphs = ("using-graph-uri", "using-named-graph-uri")
        text, dataset = await _read(request, "update", graphs)
        await self._change(request, with_dataset(text, *dataset) if dataset else text, speaker)
        return Response(status_code=204)

    async def _read_graph(self, request: Request) -> Response:
        self.admit(request, False)
        if not self._is_there(graph := _graph(request)):
            raise _absent(graph)
        query = f"CONSTRUCT {{ ?s ?p ?o }} WHERE {{ {_block(graph, '?s ?p ?o')} }}"
        formats = None, None, _accepted(request.headers.get("accept", "*/*"), STATEMENTS)
        return await self._answer(request, query, formats=formats, is_union=False)

    async def _write_graph(self, request: Request) -> Response:
        speaker = self.admit(request, True)
        is_new = request.method == "POST" and not (request.url.query or request.path_params)
        graph = Iri(f"{_address(request)}/{uuid4()}") if is_new else _graph(request)
        was_there = self._is_there(graph)
        name = "DEFAULT" if graph is _DEFAULT else f"GRAPH {as_sparql(graph)}"
        if request.method == "DELETE":
            if not was_there:
                raise _absent(graph)
            update = f"DROP {name}"
        else:
            triples = await _triples(request)
            update = f"DROP SILENT {name} ; " if request.method == "PUT" else ""
            if triples:
                update += f"INSERT DATA {{ {_block(graph, triples)} }}"
            elif graph is not _DEFAULT:  # an empty graph exists, too
                update += f"CREATE SILENT {name}"
        await self._change(request, update, speaker)
        headers = {"Location": str(graph)} if is_new else None
        return Response(status_code=204 if was_there else 201, headers=headers)

    async def _answer(self, request: Request, query: str, **document: Any) -> Response:
        if "fresh" in request.headers.get("prefer", ""):
            self.pool.forget_snapshot()

        async def disconnected() -> None:
            while (await request.receive())["type"] != "http.disconnect":
                pass

        if not (found := self._looked_up(query, document)):
            refuse_external_access(query)
            found = await self.pool.answer(query, document, LIMITS, gone=disconnected)
        media_type, body, number = found
        if not media_type:
            raise _refusal(406, "The answer has no form that is accepted.")
        return Response(body, 200, {"Vary": "Accept", "Hilt-As-Of": str(number)}, media_type)

    def _looked_up(self, query: str, document: dict[str, Any]) -> tuple[str, bytes, int] | None:
        """The answer to what takes less time than to hand it over; None for other queries."""
        key = (self.store.changes, query, *document.items())
        if (known := self._known.get(key)) or (short := lookup(query, MOST_BYTES)) is None:
            return known
        media_type, body = self.store.document(short, **document)
        found = media_type, body, last_utterance(self.store)
        if len(body) < MOST_BYTES:  # and therefore whole, for a row takes a byte at least
            if len(self._known) >= MOST_KNOWN:
                self._known.clear()
            self._known[key] = found
        return found if short == query or len(body) < MOST_BYTES else None

    async def _change(self, request: Request, update: str, speaker: str) -> None:
        """Run an update; each later query sees what it has changed."""
        refuse_external_access(update)
        await self.update(update, _address(request), speaker)
        self.pool.forget_snapshot()

    def _is_there(self, graph: Iri) -> bool:
        asked = f"ASK {{ {_block(graph, '')} }}"  # also of one without statements
        return self.store.run(asked) == BooleanResult(True)


@lru_cache(maxsize=256)
def _accepted(header: str, offered: tuple[str, ...]) -> str | None:
    """The first of the media types that a header `Accept` likes best; None if it has none."""
    ranges: dict[str, float] = {}
    for one in header.split(","):
        name, options = parse_options_header(one.strip())
        quality = options.get(b"q", b"1")
        is_number = quality.replace(b".", b"", 1).isdigit()
        ranges[name.decode("latin-1")] = float(quality) if is_number else 0.0

    def liked(media_type: str) -> float:
        wider = (media_type, media_type.partition("/")[0] + "/*", "*/*")
        return next((ranges[one] for one in wider if one in ranges), 0.0)

    best = max(offered, key=liked)
    return best if liked(best) else None


def _refusal(status: int, detail: str) -> Problem:
    return Problem(status, "protocol", HTTPStatus(status).phrase, detail)


def _absent(graph: Iri) -> Problem:
    return _refusal(404, f"There is no graph <{graph}>.")


def _address(request: Request) -> str:
    """The address that was asked, without its query."""
    path: bytes = request.scope["raw_path"]
    return f"{request.scope['scheme']}://{request.headers['host']}{path.decode('latin-1')}"


def _fields(form: str | bytes) -> dict[str, list[str]]:
    """The fields of a form; a problem 400 if it is none in UTF-8."""
    try:
        text = form if isinstance(form, str) else form.decode()
        return parse_qs(text, keep_blank_values=True, errors="strict", max_num_fields=_MOST_FIELDS)
    except ValueError as error:
        raise _refusal(400, "Expected a form in UTF-8.") from error


def _content_type(sent: Request | UploadFile) -> str:
    """The media type of the body, without parameters; a problem 415 if it is not in UTF-8."""
    name, options = parse_options_header(sent.headers.get("content-type", ""))
    if options.get(b"charset", b"utf-8").lower() != b"utf-8":
        raise _refusal(415, "Expected UTF-8.")
    return name.decode("latin-1")


async def _read(
    request: Request, operation: str, graphs: tuple[str, str]
) -> tuple[str, tuple[tuple[str, ...], tuple[str, ...]] | None]:
    """The text of the operation, and the graphs of its dataset if some are given."""
    given = [_fields(request.scope["query_string"])]
    if request.method == "POST":
        direct, media_type = f"application/sparql-{operation}", _content_type(request)
        if media_type not in {_FORM, direct}:
            raise _refusal(415, f"Expected {_FORM} or {direct}.")
        try:
            body = (await request.body()).decode()
        except UnicodeDecodeError as error:
            raise _refusal(400, "Expected UTF-8.") from error
        given.append({operation: [body]} if media_type == direct else _fields(body))
    queries, updates, default, named = (
        tuple(value for each in given for value in each.get(name, ()))
        for name in ("query", "update", *graphs)
    )
    wanted, others = (queries, updates) if operation == "query" else (updates, queries)
    if len(wanted) != 1 or others:
        raise _refusal(400, f"Expected one {operation}, and nothing else that is to be done.")
    return wanted[0], (default, named) if default or named else None


def _graph(request: Request) -> Iri:
    given = _fields(request.scope["query_string"])
    named = [*given.get("graph", ()), *(_address(request) for _ in request.path_params)]
    if len(named) + ("default" in given) != 1:
        raise _refusal(400, "Expected one of ?default, ?graph=IRI, or a path.")
    graph = Iri(*named) if named else _DEFAULT
    try:
        _block(graph, "")
    except ValueError as error:
        raise _refusal(400, str(error)) from error
    return graph


def _block(graph: Iri, pattern: str) -> str:
    return pattern if graph is _DEFAULT else f"GRAPH {as_sparql(graph)} {{ {pattern} }}"


async def _triples(request: Request) -> str:
    if (media_type := _content_type(request)) == _MULTIPART:
        async with request.form() as form:
            parts = [part for _, part in form.multi_items() if isinstance(part, UploadFile)]
            documents = [(_content_type(part), await part.read()) for part in parts]
    else:
        documents = [(media_type, await request.body())]
    if not documents or any(kind not in STATEMENTS for kind, _ in documents):
        raise _refusal(415, f"Expected {', '.join(STATEMENTS)}.")
    base = _address(request)
    return "".join(as_ntriples(data, media_type=kind, base=base) for kind, data in documents)
