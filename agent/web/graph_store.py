"""SPARQL 1.1 Graph Store Protocol: whole graphs by their address, as updates of the same target."""

from __future__ import annotations

from uuid import uuid4

from starlette.datastructures import UploadFile
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from ...kb.rdf.terms import as_sparql
from ...kb.sparql.results import BooleanResult
from ...kb.stores.query_pool import PooledQuery
from ...kb.stores.rdf_text import as_ntriples
from ...ontology.errors import DataError
from ...ontology.vocabulary import Iri
from . import sparql_protocol
from .problems import Problem
from .sparql_protocol import STATEMENTS, SparqlTarget

_PATH = "/store"
_DEFAULT = Iri("")
_MULTIPART = "multipart/form-data"


class GraphStore:
    """Answers `/store` and the graphs that are named by an address below it."""

    def __init__(self, target: SparqlTarget) -> None:
        self._target = target

    def routes(self) -> list[Route]:
        """Where it is asked."""
        places = (_PATH, f"{_PATH}/{{graph:path}}")
        writing = ["PUT", "POST", "DELETE"]
        return [Route(place, self._read) for place in places] + [
            Route(place, self._write, methods=writing) for place in places
        ]

    async def _read(self, request: Request) -> Response:
        self._target.admit(request, False)
        graph = _graph(request)
        self._check_there(graph)
        text = f"CONSTRUCT {{ ?s ?p ?o }} WHERE {{ {_block(graph, '?s ?p ?o')} }}"
        formats = [None, None, sparql_protocol.accepted(request, STATEMENTS)]
        return await self._target.answer(request, PooledQuery(text, formats, is_union=False))

    async def _write(self, request: Request) -> Response:
        speaker = self._target.admit(request, True)
        is_new = request.method == "POST" and not request.url.query and _is_store(request)
        graph = Iri(f"{sparql_protocol.address(request)}/{uuid4()}") if is_new else _graph(request)
        was_there = self._is_there(graph)
        if request.method == "DELETE":
            self._check_there(graph)
            text = f"DROP {_name(graph)}"
        else:
            text = _insertion(graph, await _triples(request))
            if request.method == "PUT":
                text = f"DROP SILENT {_name(graph)} ; {text}"
        await self._target.change(text, request, speaker)
        headers = {"Location": str(graph)} if is_new else None
        return Response(status_code=204 if was_there else 201, headers=headers)

    def _check_there(self, graph: Iri) -> None:
        if not self._is_there(graph):
            raise Problem(404, "not-found", "Not found", f"There is no graph <{graph}>.")

    def _is_there(self, graph: Iri) -> bool:
        asked = f"ASK {{ {_block(graph, '')} }}"  # also one without statements
        return self._target.store.run(asked) == BooleanResult(True)


def _graph(request: Request) -> Iri:
    given = sparql_protocol.fields(request.url.query)
    named, is_default = given.get("graph", []), "default" in given
    if len(named) + is_default + (not _is_store(request)) != 1:
        raise sparql_protocol.bad_request("Expected one of ?default, ?graph=IRI, or a path.")
    if is_default:
        return _DEFAULT
    graph = Iri(named[0] if named else sparql_protocol.address(request))
    try:
        as_sparql(graph)
    except ValueError as error:
        raise sparql_protocol.bad_request(str(error)) from error
    return graph


def _is_store(request: Request) -> bool:
    return "graph" not in request.path_params


def _name(graph: Iri) -> str:
    return "DEFAULT" if graph == _DEFAULT else f"GRAPH {as_sparql(graph)}"


def _block(graph: Iri, pattern: str) -> str:
    return pattern if graph == _DEFAULT else f"GRAPH {as_sparql(graph)} {{ {pattern} }}"


def _insertion(graph: Iri, triples: str) -> str:
    if not triples and graph != _DEFAULT:  # an empty graph exists, too
        return f"CREATE SILENT {_name(graph)}"
    return f"INSERT DATA {{ {_block(graph, triples)} }}"


async def _triples(request: Request) -> str:
    media_type = sparql_protocol.content_type(request)
    documents = [(media_type, b"")]
    if media_type == _MULTIPART:
        async with request.form() as form:
            sent = [part for _, part in form.multi_items() if isinstance(part, UploadFile)]
            documents = [
                ((part.content_type or "").partition(";")[0].strip(), await part.read())
                for part in sent
            ]
    else:
        documents = [(media_type, await request.body())]
    if not documents or any(media_type not in STATEMENTS for media_type, _ in documents):
        raise sparql_protocol.unsupported(*STATEMENTS)
    base = sparql_protocol.address(request)
    try:
        return "".join(as_ntriples(data, media_type=kind, base=base) for kind, data in documents)
    except DataError as error:
        raise sparql_protocol.bad_request(str(error)) from error
