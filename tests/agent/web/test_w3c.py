"""The test suites of the W3C for SPARQL over HTTP, each test against a plain store."""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import httpx
import pytest
from rdflib import Graph, Namespace
from rdflib.collection import Collection
from rdflib.compare import isomorphic
from rdflib.term import Node

from .running_service import end, start

FOLDER = Path(__file__).with_name("w3c")
SUITES = {
    name: Graph().parse(FOLDER / f"{name}.ttl", publicID=FOLDER.as_uri() + "/")
    for name in ("protocol", "graph-store-direct", "graph-store-indirect")
}
CNT = Namespace("http://www.w3.org/2011/content#")
HT = Namespace("http://www.w3.org/2011/http#")
MF = Namespace("http://www.w3.org/2001/sw/DataAccess/tests/test-manifest#")
RDFS = Namespace("http://www.w3.org/2000/01/rdf-schema#")
UT = Namespace("http://www.w3.org/2009/sparql/tests/test-update#")
STATUS = {"OK": 200, "Created": 201, "NoContent": 204, "NotFound": 404}
TYPES = {
    "boolean": {"application/sparql-results+json", "application/sparql-results+xml"},
    "tabular": {"application/sparql-results+json", "text/csv"},
    "RDF": {"text/turtle", "application/n-triples"},
}
COUNTS = {"protocol": 34, "graph-store-direct": 4, "graph-store-indirect": 9}


def entries(suite: str) -> list[Node]:
    """The tests of a manifest, in its order."""
    graph = SUITES[suite]
    return list(Collection(graph, next(graph.objects(None, MF.entries))))


TESTS = [
    pytest.param(suite, test, id=str(test).partition("#")[2])
    for suite in SUITES
    for test in entries(suite)
]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """A plain store."""
    service = start(tmp_path_factory.mktemp("bare") / "store", "--bare")
    yield service.url
    end(service)


@pytest.fixture
def address(server: str) -> str:
    """An empty store."""
    httpx.post(f"{server}/update", data={"update": "DROP ALL"}).raise_for_status()
    return server


class Connection:
    """Sends the requests of one test, in which the variables of a location are replaced."""

    def __init__(self, graph: Graph, address: str) -> None:
        self.graph, self.address = graph, address
        self.locations: dict[str, str] = {}

    def text(self, text: object) -> str:
        """A text of the manifest, with the locations that were answered in it."""
        found = str(text)
        for variable, location in self.locations.items():
            found = found.replace(variable, location)
        return found

    def headers(self, message: Node) -> dict[str, str]:
        """The headers of a request or a response."""
        found = self.graph.value(message, HT.headers)
        listed = Collection(self.graph, found) if found else []
        fields = [
            [self.graph.value(each, key) for key in (HT.fieldName, HT.fieldValue)]
            for each in listed
        ]
        return {str(name): str(value) for name, value in fields}

    def body(self, message: Node) -> bytes:
        """The body of a request or a response, in its encoding."""
        found = self.graph.value(message, HT.body)
        if found is None:
            return b""
        encoding = str(self.graph.value(found, CNT.characterEncoding))
        return self.text(self.graph.value(found, CNT.chars)).encode(encoding)

    def send(self, request: Node) -> None:
        """Send a request, and check its response."""
        value = self.graph.value
        path, method = self.text(value(request, HT.absolutePath)), value(request, HT.methodName)
        sent_type, body = self.headers(request).get("content-type", ""), self.body(request)
        is_update = "sparql-update" in sent_type or b"update=" in body
        for written, here in {
            "/gsp": "/store",
            "/sparql/": "/update" if is_update else "/sparql",
        }.items():
            path = re.sub(f"^{written}", here, path)
        with httpx.Client() as client:
            sent = client.build_request(
                str(method), self.address + path, headers=self.headers(request), content=body
            )
            self.check(client.send(sent), value(request, HT.resp))

    def check(self, got: httpx.Response, wanted: Node) -> None:
        """Compare a response with the expected one."""
        value = self.graph.value
        statuses = [
            str(one).partition("#")[2] for one in self.graph.objects(wanted, MF.expectedStatus)
        ]
        accepted = {str(STATUS.get(one, one.removeprefix("StatusCode")[:1])) for one in statuses}
        assert str(got.status_code).startswith(tuple(accepted)), got.text
        media_type = got.headers.get("content-type", "").partition(";")[0]
        if expected := value(wanted, MF.expectedFormat):
            assert media_type in TYPES[str(expected)]
        boolean = value(wanted, MF.expectedBoolean)
        if boolean is not None:
            assert got.json()["boolean"] is boolean.toPython()
        if variable := value(wanted, MF.expectedLocation):
            self.locations[str(variable)] = got.headers["location"]
        if body := self.body(wanted):
            assert media_type == self.headers(wanted)["content-type"].partition(";")[0]
            expected, found = (
                Graph().parse(data=one, format="turtle") for one in (body, got.content)
            )
            assert isomorphic(expected, found)


@pytest.mark.parametrize(("suite", "test"), TESTS)
def test_w3c(suite: str, test: Node, address: str):
    """Every request of the test has a response that the manifest allows."""
    graph = SUITES[suite]
    connection = Connection(graph, address)
    for data in graph.objects(test, UT.graphData):
        file, name = graph.value(data, UT.graph), graph.value(data, RDFS.label)
        content = (FOLDER / str(file).rpartition("/")[2]).read_bytes()
        headers = {"Content-Type": "application/n-triples"}
        httpx.put(
            f"{address}/store", params={"graph": str(name)}, content=content, headers=headers
        ).raise_for_status()

    for request in Collection(graph, graph.value(graph.value(test, MF.action), HT.requests)):
        connection.send(request)


@pytest.mark.parametrize(("suite", "count"), COUNTS.items())
def test_no_test_of_the_w3c_is_left_out(suite: str, count: int):
    """Each manifest has as many tests as it had when it was taken."""
    assert len(entries(suite)) == count
