"""SPARQL 1.1 Graph Store Protocol: whole graphs by their IRI, changed by updates of a target."""

from __future__ import annotations

from uuid import uuid4

from starlette.datastructures import UploadFile
from starlette.requests import Request
from starlette.responses import Response
from starlette.routing import Route

from ...kb.rdf.terms import as_sparql
from ...kb.sparql.results import BooleanResult
from ...kb.stores.rdf_text import as_ntriples
from ...ontology.vocabulary import Iri
from .sparql_protocol import (
    STATEMENTS,
    SparqlTarget,
    accepted,
    address,
    content_type,
    fields,
    refusal,
)

_DEFAULT = Iri("")
_MULTIPART = "multipart/form-data"


class GraphStore:
    """Answers `/store`, and the graphs that are named by an address below it."""

    def __init__(self, target: SparqlTarget) -> None:
        self._target = target
        places, writing = ("/store", "/store/{path:path}"), ["PUT", "POST", "DELETE"]
        self.routes = [Route(place, self._read) for place in places]
        self.routes += [Route(place, self._write, methods=writing) for place in places]

    async def _read(self, request: Request) -> Response:
        self._target.admit(request, False)
        graph = _graph(request)
        self._check_there(graph)
        query = f"CONSTRUCT {{ ?s ?p ?o }} WHERE {{ {_block(graph, '?s ?p ?o')} }}"
        formats = [None, None, accepted(request, STATEMENTS)]
        return await self._target.answer(request, query, formats=formats, is_union=False)

    async def _write(self, request: Request) -> Response:
        speaker = self._target.admit(request, True)
        is_new = request.method == "POST" and not (request.url.query or request.path_params)
        graph = Iri(f"{address(request)}/{uuid4()}") if is_new else _graph(request)
        was_there = self._is_there(graph)
        name = "DEFAULT" if graph is _DEFAULT else f"GRAPH {as_sparql(graph)}"
        if request.method == "DELETE":
            self._check_there(graph)
            update = f"DROP {name}"
        else:
            triples = await _triples(request)
            update = f"DROP SILENT {name} ; " if request.method == "PUT" else ""
            if triples:
                update += f"INSERT DATA {{ {_block(graph, triples)} }}"
            elif graph is not _DEFAULT:  # an empty graph exists, too
                update += f"CREATE SILENT {name}"
        await self._target.change(request, update, speaker)
        headers = {"Location": str(graph)} if is_new else None
        return Response(status_code=204 if was_there else 201, headers=headers)

    def _check_there(self, graph: Iri) -> None:
        if not self._is_there(graph):
            raise refusal(404, f"There is no graph <{graph}>.")

    def _is_there(self, graph: Iri) -> bool:
        asked = f"ASK {{ {_block(graph, '')} }}"  # also of one without statements
        return self._target.store.run(asked) == BooleanResult(True)


def _graph(request: Request) -> Iri:
    given = fields(request.url.query)
    named = [*given.get("graph", ()), *(address(request) for _ in request.path_params)]
    if len(named) + ("default" in given) != 1:
        raise refusal(400, "Expected one of ?default, ?graph=IRI, or a path.")
    graph = Iri(*named) if named else _DEFAULT
    try:
        _block(graph, "")
    except ValueError as error:
        raise refusal(400, str(error)) from error
    return graph


def _block(graph: Iri, pattern: str) -> str:
    return pattern if graph is _DEFAULT else f"GRAPH {as_sparql(graph)} {{ {pattern} }}"


async def _triples(request: Request) -> str:
    media_type = content_type(request)
    if media_type == _MULTIPART:
        async with request.form() as form:
            parts = [part for _, part in form.multi_items() if isinstance(part, UploadFile)]
            documents = [(content_type(part), await part.read()) for part in parts]
    else:
        documents = [(media_type, await request.body())]
    if not documents or any(kind not in STATEMENTS for kind, _ in documents):
        raise refusal(415, f"Expected {', '.join(STATEMENTS)}.")
    base = address(request)
    return "".join(as_ntriples(data, media_type=kind, base=base) for kind, data in documents)
