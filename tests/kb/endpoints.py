"""Real SPARQL servers on the loopback, started for tests and stopped after them."""

from __future__ import annotations

import shutil
import socket
import subprocess
import sys
import time
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import parse_qs

import httpx
import pyoxigraph
import pytest

from hilt.kb.sparql.query_text import with_prefixes
from hilt.kb.stores.http import EndpointConfig, EndpointTransport
from hilt.kb.stores.remote import RemoteStore

from ..agent.web import running_service

PASSWORD = "correct horse"  # noqa: S105 - of a server that lives for some seconds
MAX_ROWS = 1_000  # that Virtuoso gives at once here; its default is 10,000
UP_S, DOWN_S = 60.0, 10.0


@dataclass(frozen=True)
class Endpoint:
    """A server that runs.

    Attributes:
        location: as `--kb` takes it, without credentials.
        user: a name that may write; empty where nobody is asked.
        password: of that name.
    """

    location: str
    user: str = ""
    password: str = ""


@contextmanager
def oxigraph(folder: Path) -> Generator[Endpoint]:
    """The server of the package `oxigraph`; skips where that is not installed."""
    program = shutil.which("oxigraph", path=str(Path(sys.executable).parent))
    if program is None:
        pytest.skip("the package oxigraph is not installed (pip install oxigraph)")
    port = _free_port()
    served = ["serve", "--location", str(folder), "--bind", f"127.0.0.1:{port}"]
    with _running([program, *served], folder.parent, f"http://127.0.0.1:{port}/query"):
        yield Endpoint(f"http://127.0.0.1:{port}/query#update,store")


@contextmanager
def virtuoso(folder: Path) -> Generator[Endpoint]:
    """Virtuoso from Debian's `virtuoso-opensource-7-bin`; skips where that is not installed."""
    program = shutil.which("virtuoso-t")
    if program is None:
        pytest.skip("Virtuoso is not installed (apt-get install virtuoso-opensource-7-bin)")
    folder.mkdir()
    port = _free_port()
    (folder / "virtuoso.ini").write_text(_settings(port, _free_port()))
    started = [program, "+foreground", "+configfile", "virtuoso.ini"]
    change = [*started, "+pwdold", "dba", "+pwddba", PASSWORD]
    subprocess.run(change, cwd=folder, check=True, capture_output=True, timeout=UP_S)
    with _running(started, folder, f"http://127.0.0.1:{port}/sparql"):
        yield Endpoint(f"http://127.0.0.1:{port}/sparql", "dba", PASSWORD)


@contextmanager
def hilt(folder: Path) -> Generator[Endpoint]:
    """`hilt serve --bare`, which serves a plain store."""
    service = running_service.start(folder, "--bare")
    try:
        yield Endpoint(f"{service.url}/sparql#update,store")
    finally:
        running_service.end(service)


@contextmanager
def _running(command: Sequence[str], folder: Path, address: str) -> Generator[None]:
    with (folder / "server.log").open("wb") as log:
        process = subprocess.Popen(command, cwd=folder, stdout=log, stderr=log)
        try:
            _wait(process, address, folder / "server.log")
            yield
        finally:
            process.terminate()
            try:
                process.wait(DOWN_S)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()


def _wait(process: subprocess.Popen[bytes], address: str, log: Path) -> None:
    deadline = time.monotonic() + UP_S
    while time.monotonic() < deadline and process.poll() is None:
        try:
            httpx.post(address, data={"query": "ASK {}"}, timeout=5).raise_for_status()
        except httpx.HTTPError:
            time.sleep(0.1)
        else:
            return
    raise RuntimeError(f"{address} did not come up: {log.read_text(errors='replace')[-2000:]}")


def _free_port() -> int:
    with socket.socket() as found:
        found.bind(("127.0.0.1", 0))
        return found.getsockname()[1]


def _settings(port: int, own_port: int) -> str:
    return f"""
[Database]
DatabaseFile = virtuoso.db
ErrorLogFile = virtuoso.log
LockFile = virtuoso.lck
TransactionFile = virtuoso.trx
xa_persistent_file = virtuoso.pxa
[TempDatabase]
DatabaseFile = temporary.db
TransactionFile = temporary.trx
[Parameters]
ServerPort = 127.0.0.1:{own_port}
DirsAllowed = .
NumberOfBuffers = 10000
[HTTPServer]
ServerPort = 127.0.0.1:{port}
[SPARQL]
ResultSetMaxRows = {MAX_ROWS}
"""


class InMemoryEndpoint:
    """An endpoint in this process; it is not reached after `stop_after` more updates.

    A `server` called Virtuoso is sent one operation at a time.

    Attributes:
        store: all statements.
        updates: the updates that it was sent.
    """

    def __init__(self, server: str = "") -> None:
        self.store, self._server = pyoxigraph.Store(), server
        self.updates: list[str] = []
        self.stop_after: int | None = None

    def open(self, *, read_only: bool = False, graphs: str | None = None) -> RemoteStore:
        """A process's own connection to it."""
        address = EndpointConfig("http://h/query", "http://h/update", graphs, is_update_given=True)
        transport = EndpointTransport(
            address, pause=lambda _: None, connection=httpx.MockTransport(self._answer)
        )
        store = RemoteStore(transport, read_only=read_only)
        store.connect()
        return store

    def pass_time(self) -> None:
        """Let the lease of every claim end."""
        change = """DELETE { GRAPH graph:writers { ?claim hilt:claimedAt ?time } }
            INSERT { GRAPH graph:writers { ?claim hilt:claimedAt ?long_ago } }
            WHERE { VALUES ?long_ago { "2000-01-01T00:00:00Z"^^xsd:dateTime }
              GRAPH graph:writers { ?claim hilt:claimedAt ?time } }"""
        self.store.update(with_prefixes(change))

    def _answer(self, request: httpx.Request) -> httpx.Response:
        if self.stop_after == 0:
            raise httpx.ConnectError("stopped")
        if request.url.path == "/store":
            graph = pyoxigraph.NamedNode(request.url.params["graph"])
            format = pyoxigraph.RdfFormat.N_TRIPLES
            self.store.load(request.content, format, to_graph=graph)
            return self._changed(request.url.params["graph"])
        form = parse_qs(request.content.decode())
        if request.url.path == "/update":
            self.store.update(form["update"][0])
            return self._changed(form["update"][0])
        graphs = [pyoxigraph.NamedNode(one) for one in form.get("named-graph-uri", [])]
        dataset: dict[str, Any] = (
            {"default_graph": graphs, "named_graphs": graphs} if graphs else {}
        )
        found = self.store.query(form["query"][0], **dataset)
        return httpx.Response(
            200, content=found.serialize(format=pyoxigraph.QueryResultsFormat.JSON)
        )

    def _changed(self, update: str) -> httpx.Response:
        self.updates.append(update)
        if self.stop_after is not None:
            self.stop_after -= 1
        return httpx.Response(204)
