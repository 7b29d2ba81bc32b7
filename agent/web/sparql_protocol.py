"""SPARQL 1.1 Protocol: queries and updates over HTTP, of a base or of a bare store."""

from __future__ import annotations

from collections.abc import Awaitable, Callable
from dataclasses import dataclass
from functools import lru_cache, partial
from http import HTTPStatus
from urllib.parse import parse_qs

from python_multipart.multipart import parse_options_header
from starlette.datastructures import UploadFile
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from ...kb.sparql.query_text import refuse_external_access
from ...kb.sparql.results import QueryLimits
from ...kb.sparql.update_operations import with_dataset
from ...kb.stores.oxigraph import OxigraphStore
from ...kb.stores.query_pool import QueryPool
from .problems import Problem

BOOLEANS = ("application/sparql-results+json", "application/sparql-results+xml",
            "application/json", "application/xml")  # fmt: skip
ROWS = (*BOOLEANS, "text/csv", "text/tab-separated-values")
STATEMENTS = ("text/turtle", "application/n-triples", "application/rdf+xml")
LIMITS = QueryLimits()
_FORM, _HTML = "application/x-www-form-urlencoded", "text/html"
_MOST_FIELDS = 1_000
_DESCRIPTION = """PREFIX sd: <http://www.w3.org/ns/sparql-service-description#>
CONSTRUCT { [] a sd:Service ; sd:endpoint <> ; sd:feature sd:UnionDefaultGraph ;
  sd:supportedLanguage sd:SPARQL11Query , sd:SPARQL11Update } WHERE {}"""


@dataclass(frozen=True)
class SparqlTarget:
    """What is queried and updated.

    Attributes:
        store: where the statements are.
        pool: evaluates the queries.
        admit: the speaker for whom a request asks; a problem if that one may not read it or, where
            the second argument is true, write to it.
        update: runs an update, whose relative IRIs a base IRI resolves, in the name of a speaker.
        page: where a browser is led that asks for nothing; empty for nowhere.
    """

    store: OxigraphStore
    pool: QueryPool
    admit: Callable[[Request, bool], str]
    update: Callable[[str, str, str], Awaitable[object]]
    page: str = ""

    async def answer(self, request: Request, query: str, **document: object) -> Response:
        """The response with the result of a query; see `OxigraphStore.document`."""
        gone = partial(_disconnected, request)
        if "fresh" in request.headers.get("prefer", ""):
            self.pool.forget_snapshot()
        refuse_external_access(query)
        media_type, body, number = await self.pool.answer(query, document, LIMITS, gone=gone)
        if not media_type:
            raise refusal(406, "The answer has no form that is accepted.")
        headers = {"Vary": "Accept", "Hilt-As-Of": str(number)}
        return Response(body, 200, headers, media_type)

    async def change(self, request: Request, update: str, speaker: str) -> None:
        """Run an update; each later query sees what it has changed."""
        refuse_external_access(update)
        await self.update(update, address(request), speaker)
        self.pool.forget_snapshot()


class SparqlProtocol:
    """Answers `/sparql` and `/update`."""

    def __init__(self, target: SparqlTarget) -> None:
        self._target = target
        query = Route("/sparql", self._query, methods=["GET", "POST"])
        self.routes = [query, Route("/update", self._update, methods=["POST"])]

    async def _query(self, request: Request) -> Response:
        formats = [accepted(request, offered) for offered in (ROWS, BOOLEANS, STATEMENTS)]
        asks_nothing = request.method != "POST" and not request.scope["query_string"]
        if asks_nothing and self._target.page and accepted(request, (*STATEMENTS, _HTML)) == _HTML:
            return RedirectResponse(self._target.page, 303)
        self._target.admit(request, False)
        text, dataset = _DESCRIPTION, None
        if not asks_nothing:
            text, dataset = await _read(request, "query", ("default-graph-uri", "named-graph-uri"))
        base = address(request)
        return await self._target.answer(request, text, formats=formats, base=base, dataset=dataset)

    async def _update(self, request: Request) -> Response:
        speaker = self._target.admit(request, True)
        graphs = ("using-graph-uri", "using-named-graph-uri")
        text, dataset = await _read(request, "update", graphs)
        text = with_dataset(text, *dataset) if dataset else text
        await self._target.change(request, text, speaker)
        return Response(status_code=204)


def accepted(request: Request, offered: tuple[str, ...]) -> str | None:
    """The first of the media types that a request likes best; None if it accepts none."""
    return _best(request.headers.get("accept", "*/*"), offered)


@lru_cache(maxsize=256)
def _best(header: str, offered: tuple[str, ...]) -> str | None:
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


def refusal(status: int, detail: str) -> Problem:
    """The problem of a request that the protocol does not allow."""
    return Problem(status, "protocol", HTTPStatus(status).phrase, detail)


def address(request: Request) -> str:
    """The address that was asked, without its query."""
    path: bytes = request.scope["raw_path"]
    return f"{request.scope['scheme']}://{request.headers['host']}{path.decode('latin-1')}"


def fields(form: str) -> dict[str, list[str]]:
    """The fields of a form; a problem 400 if it is none in UTF-8."""
    try:
        return parse_qs(form, keep_blank_values=True, errors="strict", max_num_fields=_MOST_FIELDS)
    except ValueError as error:
        raise refusal(400, "Expected a form in UTF-8.") from error


def content_type(sent: Request | UploadFile) -> str:
    """The media type of the body, without parameters; a problem 415 if it is not in UTF-8."""
    name, options = parse_options_header(sent.headers.get("content-type", ""))
    if options.get(b"charset", b"utf-8").lower() != b"utf-8":
        raise refusal(415, "Expected UTF-8.")
    return name.decode("latin-1")


async def _read(
    request: Request, operation: str, graphs: tuple[str, str]
) -> tuple[str, tuple[list[str], list[str]] | None]:
    """The text of the operation, and the graphs of its dataset if some are given."""
    given = [fields(request.scope["query_string"].decode("latin-1"))]
    if request.method == "POST":
        direct, media_type = f"application/sparql-{operation}", content_type(request)
        if media_type not in {_FORM, direct}:
            raise refusal(415, f"Expected {_FORM} or {direct}.")
        try:
            body = (await request.body()).decode()
        except UnicodeDecodeError as error:
            raise refusal(400, "Expected UTF-8.") from error
        given.append({operation: [body]} if media_type == direct else fields(body))
    queries, updates, default, named = (
        [value for each in given for value in each.get(name, ())]
        for name in ("query", "update", *graphs)
    )
    wanted, others = (queries, updates) if operation == "query" else (updates, queries)
    if len(wanted) != 1 or others:
        raise refusal(400, f"Expected one {operation}, and nothing else that is to be done.")
    return wanted[0], (default, named) if default or named else None


async def _disconnected(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass
