"""SPARQL 1.1 Protocol: queries and updates over HTTP, of a base or of a bare store."""

from __future__ import annotations

from collections.abc import Awaitable, Callable, Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from urllib.parse import parse_qs

from python_multipart.multipart import parse_options_header
from starlette.requests import Request
from starlette.responses import RedirectResponse, Response
from starlette.routing import Route

from ...kb.sparql.results import QueryLimits
from ...kb.sparql.safety import refuse_external_access
from ...kb.sparql.update_operations import with_dataset
from ...kb.stores.oxigraph import OxigraphStore
from ...kb.stores.query_pool import BusyError, PooledQuery, QueryPool
from ...ontology.errors import DataError, QueryError, ValidationError
from .problems import Problem

BOOLEANS = ("application/sparql-results+json", "application/sparql-results+xml",
            "application/json", "application/xml")  # fmt: skip
ROWS = (*BOOLEANS, "text/csv", "text/tab-separated-values")
STATEMENTS = ("text/turtle", "application/n-triples", "application/rdf+xml")
_FORM, _HTML = "application/x-www-form-urlencoded", "text/html"
_MOST_FIELDS = 1_000
_DESCRIPTION = """PREFIX sd: <http://www.w3.org/ns/sparql-service-description#>
PREFIX format: <http://www.w3.org/ns/formats/>
CONSTRUCT { [] a sd:Service ; sd:endpoint <> ; sd:feature sd:UnionDefaultGraph ;
  sd:supportedLanguage sd:SPARQL11Query ; sd:resultFormat format:SPARQL_Results_JSON ,
    format:SPARQL_Results_XML , format:SPARQL_Results_CSV , format:SPARQL_Results_TSV ,
    format:Turtle , format:N-Triples , format:RDF_XML } WHERE {}"""


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
    limits: QueryLimits = field(default_factory=QueryLimits)
    page: str = ""

    async def answer(self, request: Request, query: PooledQuery) -> Response:
        """The response with the result of a query."""
        is_fresh = "fresh" in request.headers.get("prefer", "")
        with _as_problems():
            gone = partial(_disconnected, request)
            found = await self.pool.answer(query, self.limits, is_fresh=is_fresh, gone=gone)
        if not found.media_type:
            raise not_acceptable()
        headers = {"Vary": "Accept", "Hilt-As-Of": str(found.as_of)}
        return Response(found.body, 200, headers, found.media_type)

    async def change(self, text: str, request: Request, speaker: str) -> None:
        """Run an update; each later query sees what it has changed."""
        with _as_problems():
            refuse_external_access(text)
            await self.update(text, address(request), speaker)
        self.pool.forget_snapshot()


class SparqlProtocol:
    """Answers `/sparql` and `/update`."""

    def __init__(self, target: SparqlTarget) -> None:
        self._target = target

    def routes(self) -> list[Route]:
        """Where it is asked."""
        return [
            Route("/sparql", self._query, methods=["GET", "POST"]),
            Route("/update", self._update, methods=["POST"]),
        ]

    async def _query(self, request: Request) -> Response:
        if request.method != "POST" and not request.url.query:
            return await self._describe(request)
        self._target.admit(request, False)
        text, dataset = await _read(request, "query", ("default-graph-uri", "named-graph-uri"))
        with _as_problems():
            refuse_external_access(text)
        formats = [accepted(request, offered) for offered in (ROWS, BOOLEANS, STATEMENTS)]
        query = PooledQuery(text, formats, address(request), dataset)
        return await self._target.answer(request, query)

    async def _update(self, request: Request) -> Response:
        speaker = self._target.admit(request, True)
        graphs = ("using-graph-uri", "using-named-graph-uri")
        text, dataset = await _read(request, "update", graphs)
        with _as_problems():
            text = with_dataset(text, *dataset) if dataset else text
        await self._target.change(text, request, speaker)
        return Response(status_code=204)

    async def _describe(self, request: Request) -> Response:
        if self._target.page and accepted(request, (*STATEMENTS, _HTML)) == _HTML:
            return RedirectResponse(self._target.page, 303)
        self._target.admit(request, False)
        formats = [None, None, accepted(request, STATEMENTS)]
        return await self._target.answer(
            request, PooledQuery(_DESCRIPTION, formats, address(request))
        )


def accepted(request: Request, offered: Sequence[str]) -> str | None:
    """The first of the media types that a request likes best; None if it accepts none."""
    ranges: dict[str, float] = {}
    for one in request.headers.get("accept", "*/*").split(","):
        name, options = parse_options_header(one.strip())
        ranges[name.decode("latin-1")] = _quality(options.get(b"q", b"1"))

    def liked(media_type: str) -> float:
        wider = (media_type, media_type.partition("/")[0] + "/*", "*/*")
        return next((ranges[one] for one in wider if one in ranges), 0.0)

    best = max(offered, key=liked)
    return best if liked(best) else None


def not_acceptable() -> Problem:
    """The refusal of a request that accepts no form of its answer."""
    return Problem(406, "not-acceptable", "Not acceptable", "There is no such form of the answer.")


def address(request: Request) -> str:
    """The address that was asked, without its query."""
    path: bytes = request.scope["raw_path"]
    return f"{request.url.scheme}://{request.url.netloc}{path.decode('latin-1')}"


def fields(text: str) -> dict[str, list[str]]:
    """The fields of a form; a problem 400 if it is none in UTF-8."""
    try:
        return parse_qs(text, keep_blank_values=True, errors="strict", max_num_fields=_MOST_FIELDS)
    except ValueError as error:
        raise bad_request("Expected a form in UTF-8.") from error


def bad_request(detail: str) -> Problem:
    """The refusal of a request that is wrong."""
    return Problem(400, "protocol", "Against the protocol", detail)


def content_type(request: Request) -> str:
    """The media type of the body, without parameters; a problem 415 if it is not in UTF-8."""
    name, options = parse_options_header(request.headers.get("content-type", ""))
    if options.get(b"charset", b"utf-8").lower() != b"utf-8":
        raise unsupported("UTF-8")
    return name.decode("latin-1")


def unsupported(*expected: str) -> Problem:
    """The refusal of a body of another media type."""
    return Problem(415, "media-type", "Unknown media type", f"Expected {' or '.join(expected)}.")


async def _read(
    request: Request, operation: str, graphs: tuple[str, str]
) -> tuple[str, tuple[list[str], list[str]] | None]:
    """The text of the operation, and the graphs of its dataset if some are given."""
    given = [fields(request.url.query)]
    if request.method == "POST":
        direct, media_type = f"application/sparql-{operation}", content_type(request)
        if media_type not in {_FORM, direct}:
            raise unsupported(_FORM, direct)
        try:
            body = (await request.body()).decode()
        except UnicodeDecodeError as error:
            raise bad_request("Expected UTF-8.") from error
        given.append({operation: [body]} if media_type == direct else fields(body))
    found = {
        name: [value for each in given for value in each.get(name, ())]
        for name in ("query", "update", *graphs)
    }
    if [len(found[name]) for name in ("query", "update")] != [
        operation == "query",
        operation == "update",
    ]:
        raise bad_request(f"Expected one {operation}, and nothing else that is to be done.")
    default, named = (found[name] for name in graphs)
    return found[operation][0], (default, named) if default or named else None


async def _disconnected(request: Request) -> None:
    while (await request.receive())["type"] != "http.disconnect":
        pass


def _quality(text: bytes) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


@contextmanager
def _as_problems() -> Generator[None]:
    try:
        yield
    except ValidationError as error:
        detail, findings = str(error), list(error.findings)
        raise Problem(409, "invalid", "Against the laws", detail, findings=findings) from error
    except BusyError as error:
        headers = {"Retry-After": "1"}
        raise Problem(503, "busy", "Busy", str(error), headers=headers) from error
    except (QueryError, DataError) as error:
        raise Problem(400, "query", "Refused", str(error)) from error
