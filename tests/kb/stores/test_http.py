"""Claims about talking to an endpoint: logging in, trying again, and what failures say."""

from __future__ import annotations

import logging
from collections.abc import Callable

import httpx
import pytest

from hilt.kb.rdf.terms import Quad
from hilt.kb.sparql.results import QueryLimits
from hilt.kb.stores.http import (
    PASSWORD,
    TOKEN,
    TRIES,
    USER,
    EndpointConfig,
    EndpointResponse,
    EndpointTransport,
    parse_address,
)
from hilt.kb.stores.remote import RemoteStore
from hilt.ontology.errors import QueryError, StoreError
from hilt.ontology.vocabulary import Iri, iri

from ..endpoints import InMemoryEndpoint

ADDRESS = EndpointConfig("http://h/query", "http://h/update")
QUAD = Quad(Iri("urn:s"), Iri("urn:p"), 1, iri("graph", "beliefs"))
Handler = Callable[[httpx.Request], httpx.Response]


class Served:
    """An endpoint in memory: answers one handler's way, and remembers requests and pauses."""

    def __init__(self, handler: Handler, address: EndpointConfig = ADDRESS) -> None:
        self.requests: list[httpx.Request] = []
        self.pauses: list[float] = []
        self.transport = EndpointTransport(
            address, pause=self.pauses.append, connection=httpx.MockTransport(self._handle)
        )
        self._handler = handler

    def _handle(self, request: httpx.Request) -> httpx.Response:
        # A copy, as a request is changed when it is sent again.
        self.requests.append(
            httpx.Request(
                request.method, request.url, headers=request.headers, content=request.content
            )
        )
        return self._handler(request)

    def post(self, *, may_repeat: bool = True, megabytes: int = 10) -> EndpointResponse:
        """Send something small."""
        limits = QueryLimits(5, megabytes)
        return self.transport.post(
            "http://h/query", form={"query": "ASK {}"}, accept="*/*", limits=limits,
            may_repeat=may_repeat,
        )  # fmt: skip


def in_turn(*answers: httpx.Response | Exception) -> Handler:
    """Gives one answer after the other; the last one for ever."""
    rest = list(answers)

    def handler(_: httpx.Request) -> httpx.Response:
        answer = rest.pop(0) if len(rest) > 1 else rest[0]
        if isinstance(answer, Exception):
            raise answer
        return answer

    return handler


def test_busy_server_is_asked_again_a_little_later():
    """Pauses double, and a wait that the server asks for is kept."""
    busy = httpx.Response(503)
    later = httpx.Response(429, headers={"Retry-After": "3"})
    served = Served(in_turn(busy, later, busy, httpx.Response(200, text="x")))

    assert served.post().body == b"x"
    assert served.pauses == [0.2, 3.0, 0.8]


def test_lost_connection_is_tried_again_and_then_told():
    """So many times and no more; the message says what to look at."""
    served = Served(in_turn(httpx.RemoteProtocolError("gone")))

    with pytest.raises(StoreError, match=r'"http://h/query" cannot be reached: gone\. Is it run'):
        served.post()

    assert len(served.requests) == TRIES


def test_what_may_not_be_done_twice_is_sent_once():
    """Unless it certainly never arrived."""
    lost, never = Served(in_turn(httpx.ReadError("x"))), Served(in_turn(httpx.ConnectError("x")))

    for served in (lost, never):
        with pytest.raises(StoreError):
            served.post(may_repeat=False)
    busy = Served(in_turn(httpx.Response(503)))
    with pytest.raises(StoreError, match="HTTP 503"):
        busy.post(may_repeat=False)

    assert [len(one.requests) for one in (lost, never, busy)] == [1, TRIES, 1]


def test_slow_server_is_not_asked_again():
    """A query that took too long would take too long again."""
    served = Served(in_turn(httpx.ReadTimeout("slow")))

    with pytest.raises(QueryError, match="took longer than 5 s"):
        served.post()

    assert len(served.requests) == 1


def test_huge_answer_is_not_read():
    """Reading stops at the limit."""
    served = Served(in_turn(httpx.Response(200, content=b"x" * 2_000_001)))

    with pytest.raises(QueryError, match="more than 2 MB"):
        served.post(megabytes=2)


@pytest.mark.parametrize(
    ("status", "body", "error", "said"),
    [
        (400, "\nsyntax error at 1:3\nmore", QueryError, "The endpoint says: syntax error at 1:3."),
        (401, "no", StoreError, r"refuses: no\. Set HILT_KB_USER and HILT_KB_PASSWORD"),
        (403, "", StoreError, "refuses: no message"),
        (500, "Error SR186: No permission", StoreError, "refuses: Error SR186"),
        (404, "", StoreError, 'after a "#"'),
        (500, "disk on fire", StoreError, r"failed \(HTTP 500\): disk on fire\."),
        (302, "", StoreError, "HTTP 302"),
    ],
)
def test_failures_say_what_is_wrong(status: int, body: str, error: type[Exception], said: str):
    """One line a person can act on; redirects are not followed."""
    served = Served(in_turn(httpx.Response(status, text=body)))

    with pytest.raises(error, match=said):
        served.post()

    assert len(served.requests) == 1


@pytest.mark.parametrize("scheme", ["Basic", "Digest"])
def test_scheme_is_the_one_that_the_server_asks_for(scheme: str):
    """Credentials go only to a server that wants them, and then every time."""
    challenge = {"WWW-Authenticate": f'{scheme} realm="r", nonce="n", qop="auth", algorithm=MD5'}

    def handler(request: httpx.Request) -> httpx.Response:
        if request.headers.get("authorization", "").startswith(scheme):
            return httpx.Response(200, text="in")
        return httpx.Response(401, headers=challenge)

    served = Served(handler, EndpointConfig("http://h/query", "", user="sam", password="s"))  # noqa: S106

    assert [served.post().body for _ in range(2)] == [b"in", b"in"]
    assert "authorization" not in served.requests[0].headers
    assert "authorization" in served.requests[-1].headers


@pytest.mark.parametrize("login", [{"user": "sam", "password": "s3cret"}, {"token": "s3cret"}])
def test_log_has_the_query_and_no_secret(login: dict[str, str], caplog: pytest.LogCaptureFixture):
    """What is asked and how long it took can be shown to anybody."""
    caplog.set_level(logging.DEBUG, logger="hilt")
    challenge = {"WWW-Authenticate": 'Basic realm="r"'}
    answers = in_turn(httpx.Response(401, headers=challenge), httpx.Response(200))
    if "token" in login:
        answers = in_turn(httpx.Response(200))

    Served(answers, EndpointConfig("http://h/query", "", **login)).post()

    (message,) = (one.getMessage() for one in caplog.records if one.name.startswith("hilt"))
    assert message.startswith("request http://h/query ASK {}")
    assert "s3cret" not in caplog.text


def test_token_is_sent_as_bearer():
    """Without waiting to be asked."""
    served = Served(
        in_turn(httpx.Response(200)),
        EndpointConfig("http://h/query", "", token="t0ken"),  # noqa: S106
    )
    served.post()

    assert served.requests[0].headers["authorization"] == "Bearer t0ken"


def test_bulk_goes_by_the_graph_store_protocol():
    """Where its address is known, one request a graph in place of many updates."""
    endpoint = InMemoryEndpoint()
    store = endpoint.open(graphs="http://h/store")

    store.apply(insert=[QUAD._replace(object=number) for number in range(2_500)])

    (graph,) = (one for one in endpoint.updates if one.startswith("http"))
    assert graph.endswith("new?https://w3id.org/hilt/graph/beliefs")
    assert len(list(store.quads())) == 2_500


def test_read_only_endpoint_is_never_written_to():
    """Nothing is sent."""
    served = Served(in_turn(httpx.Response(204)))
    store = RemoteStore(served.transport, read_only=True)

    with pytest.raises(StoreError, match="for reading only"):
        store.apply(insert=[QUAD])

    assert served.requests == []


@pytest.mark.parametrize(
    "body",
    [
        b"",
        b"<html>",
        b"[]",
        b'{"head": {}}',
        b'{"head": {"vars": ["o"]}, "results": {"bindings": [',
    ],
)
def test_answer_that_is_not_whole_is_not_taken_for_one(body: bytes):
    """An endpoint that cuts an answer off, or gives another thing, is not believed."""
    store = RemoteStore(
        Served(in_turn(httpx.Response(200, content=body))).transport, read_only=True
    )

    with pytest.raises(QueryError, match="The endpoint"):
        store.select("SELECT ?o WHERE { ?s ?p ?o }")


def test_partial_answer_of_virtuoso_is_refused():
    """It says that it ran out of time in a header, and otherwise looks whole."""
    whole = b'{"head": {"vars": ["o"]}, "results": {"bindings": []}}'
    partial = httpx.Response(200, content=whole, headers={"X-SQL-State": "S1TAT"})
    store = RemoteStore(Served(in_turn(partial)).transport, read_only=True)

    with pytest.raises(QueryError, match="took longer"):
        store.select("SELECT ?o WHERE { ?s ?p ?o }")


@pytest.mark.parametrize(
    ("location", "query", "update", "graphs"),
    [
        ("http://h/sparql", "http://h/sparql", "http://h/sparql", None),
        ("http://h:7878/query", "http://h:7878/query", "http://h:7878/update", None),
        ("http://h/d/query#update,data", "http://h/d/query", "http://h/d/update", "http://h/d/data"),
        ("https://h/r/kb#kb/statements", "https://h/r/kb", "https://h/r/kb/statements", None),
        ("http://h/sparql#/sparql-auth", "http://h/sparql", "http://h/sparql-auth", None),
        ("http://h/sparql#,/store", "http://h/sparql", "http://h/sparql", "http://h/store"),
        ("http://h/a#http://other/b", "http://h/a", "http://other/b", None),
    ],
)  # fmt: skip
def test_one_address_names_all(location: str, query: str, update: str, graphs: str | None):
    """What follows "#" is relative to where queries go."""
    found = parse_address(location, {})

    assert (found.query, found.update, found.graphs) == (query, update, graphs)


def test_credentials_are_taken_and_never_shown():
    """From the address, or from the environment; the shown address has none."""
    found = parse_address("http://sam:s%40fe@h/sparql", {})
    other = parse_address("http://h/sparql", {USER: "anna", PASSWORD: "secret", TOKEN: "t0ken"})

    assert (found.user, found.password, found.query) == ("sam", "s@fe", "http://h/sparql")
    assert (other.user, other.password, other.token) == ("anna", "secret", "t0ken")
    assert found.user and other.token
    assert not any(one in f"{found}{other}" for one in ("s@fe", "s%40fe", "secret", "t0ken"))


@pytest.mark.parametrize("location", ["http://", "http:///x", "https://h:port/", "ftp://h/x"])
def test_what_is_no_address_is_told(location: str):
    """The text itself is not repeated: it may hold a password."""
    with pytest.raises(StoreError, match="expected http"):
        parse_address(location, {})
