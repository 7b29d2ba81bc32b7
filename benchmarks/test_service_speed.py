"""Speed of queries over HTTP, with the server of Oxigraph itself beside it in the same run.

    pytest benchmarks/test_service_speed.py -s

The figure to reach: 95 % of queries with 20 rows among 500,000 statements are answered within 20 ms
while three others run into their limit of 30 seconds, and any request within 120 ms while the robot
moves. How many such queries are answered a second to 16 connections is compared with `oxigraph
serve`: a query that many ask, and queries that nobody has asked before, since Hilt keeps answers
until something is written. The share is to be half with the client of the standard library. One
that does as little as it can leaves that program in Rust most of the machine; for new queries the
share may only not fall there.
"""

from __future__ import annotations

import asyncio
import http.client
import shutil
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing
from itertools import cycle, islice, repeat
from pathlib import Path
from statistics import median, quantiles
from urllib.parse import urlencode, urlsplit

import pytest

sys.path.insert(0, str(Path(__file__).parents[1]))  # for the servers of the tests

from hilt.kb.stores.oxigraph import open_folder
from tests.agent.web import running_service
from tests.kb import endpoints

STATEMENTS, OF_A_NODE = 500_000, 20
CONNECTIONS, QUERIES, ROUNDS = 16, 3_000, 5
QUICK = "SELECT ?p ?o WHERE { GRAPH <urn:g> { <urn:s%d> ?p ?o } }"
SLOW = "SELECT (COUNT(*) AS ?n) { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i }"
LEAST_SHARES = {  # single runs vary
    ("of the standard library", "one query"): 0.5,
    ("of the standard library", "new queries"): 0.4,
    ("that does little", "one query"): 0.4,
    ("that does little", "new queries"): 0.2,
}
MOST_MS, MOST_BESIDE_ROBOT_MS = 20, 120
JSON = "application/sparql-results+json"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A store of many nodes that have 20 statements each."""
    place = tmp_path_factory.mktemp("speed") / "store"
    store = open_folder(place)
    store.load(
        f'<urn:s{node}> <urn:p{number}> "{node + number}" <urn:g> .\n'.encode()
        for node in range(STATEMENTS // OF_A_NODE)
        for number in range(OF_A_NODE)
    )
    store.close()
    return place


@pytest.fixture(scope="module")
def hilt(folder: Path) -> Iterator[str]:
    """The address of queries of Hilt's server."""
    service = running_service.start(folder, "--bare")
    yield f"{service.url}/sparql"
    running_service.end(service)


@pytest.fixture(scope="module")
def oxigraph(folder: Path) -> Iterator[str]:
    """That of Oxigraph's own, over a copy."""
    copy = shutil.copytree(folder, folder.with_name("copy"))
    with endpoints.oxigraph(copy) as found:
        yield found.location.partition("#")[0]


class Connection:
    """One connection that is kept open; it does as little as it can, for it shares the machine."""

    def __init__(self, address: str) -> None:
        self._place = urlsplit(address)

    async def __aenter__(self) -> Connection:
        host, port = self._place.hostname, self._place.port
        self._from, self._to = await asyncio.open_connection(host, port, limit=2**24)
        return self

    async def __aexit__(self, *_: object) -> None:
        self._to.close()

    async def ask(self, query: str) -> bytes:
        """The body of the answer."""
        path = f"{self._place.path}?{urlencode({'query': query})}"
        head = f"GET {path} HTTP/1.1\r\nHost: {self._place.netloc}\r\nAccept: {JSON}\r\n\r\n"
        self._to.write(head.encode())
        status, *lines = (await self._from.readuntil(b"\r\n\r\n")).lower().split(b"\r\n")
        fields = dict(line.split(b": ", 1) for line in lines if line)
        size, body = fields.get(b"content-length"), b""
        if size is not None:
            body = await self._from.readexactly(int(size))
        else:
            while part := int(await self._from.readuntil(b"\r\n"), 16):
                body += (await self._from.readexactly(part + 2))[:-2]
            await self._from.readexactly(2)
        assert b" 200 " in status or b"longer than" in body, body
        return body


async def rate(address: str, nodes: Iterator[int]) -> float:
    """Answers a second about so many nodes to many connections."""

    async def ask() -> None:
        async with Connection(address) as connection:
            for number in nodes:
                assert (await connection.ask(QUICK % number)).count(b'"p"') == OF_A_NODE + 1

    start = time.perf_counter()
    await asyncio.gather(*(ask() for _ in range(CONNECTIONS)))
    return QUERIES / (time.perf_counter() - start)


def rate_of_threads(address: str, nodes: Iterator[int]) -> float:
    """Answers a second to as many connections of the client of the standard library."""
    place = urlsplit(address)

    def ask(_: int) -> None:
        with closing(http.client.HTTPConnection(place.hostname or "", place.port)) as connection:
            while (number := next(nodes, None)) is not None:
                path = f"{place.path}?{urlencode({'query': QUICK % number})}"
                connection.request("GET", path, headers={"Accept": JSON})
                assert connection.getresponse().read().count(b'"p"') == OF_A_NODE + 1

    start = time.perf_counter()
    with ThreadPoolExecutor(CONNECTIONS) as pool:
        list(pool.map(ask, range(CONNECTIONS)))
    return QUERIES / (time.perf_counter() - start)


CLIENTS: dict[str, Callable[[str, Iterator[int]], float]] = {
    "of the standard library": rate_of_threads,
    "that does little": lambda address, nodes: asyncio.run(rate(address, nodes)),
}
NEW = cycle(range(STATEMENTS // OF_A_NODE))  # comes back to a node after more than are kept


@pytest.mark.parametrize(("client", "asked"), LEAST_SHARES)
def test_share_of_the_answers_that_the_server_of_the_engine_gives(
    client: str, asked: str, hilt: str, oxigraph: str
):
    """By turns, so that what else the machine does meets both."""

    def rate_for(address: str) -> float:
        return CLIENTS[client](
            address, islice(NEW if asked == "new queries" else repeat(7), QUERIES)
        )

    for address in (hilt, oxigraph):
        rate_for(address)  # to warm up

    rates = [(rate_for(hilt), rate_for(oxigraph)) for _ in range(ROUNDS)]

    share = median(ours / theirs for ours, theirs in rates)
    ours, theirs = (median(one) for one in zip(*rates, strict=True))
    print(f"\na client {client}, {asked}: {ours:.0f} and {theirs:.0f} a second; share {share:.2f}")
    assert share >= LEAST_SHARES[client, asked]


async def times_beside_slow_ones(address: str) -> tuple[list[float], list[bytes]]:
    """How long quick queries take [s] while slow ones run, and the answers to those."""

    async def ask_much() -> bytes:
        async with Connection(address) as connection:
            return await connection.ask(SLOW)

    slow = [asyncio.ensure_future(ask_much()) for _ in range(3)]
    await asyncio.sleep(2)
    took = list[float]()
    async with Connection(address) as connection:
        while not any(one.done() for one in slow):
            start = time.perf_counter()
            await connection.ask(QUICK % len(took))
            took.append(time.perf_counter() - start)
            await asyncio.sleep(0.02)
    return took, await asyncio.gather(*slow)


def test_quick_queries_are_answered_beside_slow_ones(hilt: str):
    """Each has a process of its own."""
    took, slow = asyncio.run(times_beside_slow_ones(hilt))

    p95 = quantiles(took, n=20)[-1] * 1_000
    print(f"\n{len(took)} quick queries: p50 {median(took) * 1_000:.1f} ms, p95 {p95:.1f} ms")
    assert all(b"longer than 30 s" in one for one in slow)
    assert p95 <= MOST_MS


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[running_service.RunningService]:
    """A service with a robot that moves as fast as it is computed."""
    service = running_service.start(
        tmp_path / "kb", "--scene", "objects:knife,mug", "--pace", "0", "--no-auth"
    )
    yield service
    running_service.end(service)


def test_requests_are_answered_while_the_robot_moves(robot: running_service.RunningService):
    """The robot has a thread of its own, which gives way between its steps."""
    took = list[float]()
    with robot.client() as client:
        for _ in range(ROUNDS):
            begun = {"Prefer": "respond-async"}
            command = running_service.say(client, "do", "Pass me the knife.", headers=begun).json()
            while client.get(f"/api/v1/commands/{command['id']}").json()["state"] != "done":
                for path in ("rules", "scene", "history"):
                    start = time.perf_counter()
                    assert client.get(f"/api/v1/{path}").is_success
                    took.append(time.perf_counter() - start)
                time.sleep(0.02)
            client.post("/api/v1/scene", json={"scene": "objects:knife,mug"})

    p95 = quantiles(took, n=20)[-1] * 1_000
    print(f"\n{len(took)} requests: p50 {median(took) * 1_000:.1f} ms, p95 {p95:.1f} ms")
    assert p95 <= MOST_BESIDE_ROBOT_MS
