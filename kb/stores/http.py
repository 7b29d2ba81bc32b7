"""HTTP requests to a SPARQL endpoint: addresses, authentication, time-outs, retries and errors.

`http://host/path` is the address of queries. After a `#` it may name the address of updates and,
after a comma, that of the Graph Store Protocol; both relative to the query address:

    http://host:3030/ds/query#update,data         Fuseki: /ds/update and /ds/data
    http://host:7200/repositories/kb#kb/statements    GraphDB

Without `#` updates go to the query address, but to `.../update` where that is `.../query`.
Credentials are in the address (`http://name:password@host/...`) or the environment, never shown.

A request that may be repeated is retried after increasing pauses when the connection fails or the
server is busy. Redirects are not followed, so that no other server receives the credentials.
"""

import json
import os
import re
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import closing, suppress
from dataclasses import dataclass, field
from urllib.parse import unquote, urldefrag, urljoin, urlsplit, urlunsplit

import httpx

from ...ontology.errors import QueryError, StoreError
from ...ontology.logs import timed
from ..sparql.results import QueryLimits

USER, PASSWORD, TOKEN = "HILT_KB_USER", "HILT_KB_PASSWORD", "HILT_KB_TOKEN"
TRIES = 4
FIRST_PAUSE_S = 0.2  # doubled before each further try
MAX_PAUSE_S = 5.0  # however long a server asks to wait
CONNECT_S = 10.0
REDIRECT, BAD_REQUEST, UNAUTHORIZED = 300, 400, 401  # HTTP status
NOT_THERE = frozenset({404, 405})
BUSY = frozenset({429, 502, 503, 504})
LOGIN = frozenset({401, 403, 407})
NO_PERMISSION = re.compile(r"\bSR186\b|permission|not authori[sz]ed", re.IGNORECASE)
N_TRIPLES = "application/n-triples"
OUT_OF_TIME = "S1TAT"  # Virtuoso's state of an incomplete answer
MAX_MESSAGE = 300  # characters of a server's message that are shown


@dataclass(frozen=True)
class EndpointConfig:
    """The addresses of one endpoint: queries, updates, Graph Store Protocol (None if not known).

    The credentials are apart: user and password (basic, digest) or token (bearer); empty for none.
    """

    query: str
    update: str
    graphs: str | None = None
    is_update_given: bool = False
    user: str = ""
    password: str = field(default="", repr=False)
    token: str = field(default="", repr=False)


def parse_address(location: str, environment: Mapping[str, str] | None = None) -> EndpointConfig:
    """The addresses of a location, the value of `--kb`; StoreError if it is not http(s).

    >>> found = parse_address("http://localhost:3030/ds/query#update,data", {})
    >>> found.update, found.graphs
    ('http://localhost:3030/ds/update', 'http://localhost:3030/ds/data')

    The environment variables may hold credentials; they are the process's by default.
    """
    known = os.environ if environment is None else environment
    bare, fragment = urldefrag(location)
    try:
        parts = urlsplit(bare)
        is_valid = parts.scheme in {"http", "https"} and parts.hostname and parts.port != 0
    except ValueError:
        parts, is_valid = urlsplit(""), False
    if not is_valid:
        # Not shown: it may hold a password all the same.
        raise StoreError("The endpoint's address is not valid: expected http(s)://host:port/path.")
    query = urlunsplit((parts.scheme, parts.netloc.rpartition("@")[2], parts.path, parts.query, ""))
    beside = query.removesuffix("query") + "update" if parts.path.endswith("/query") else query
    update, _, graphs = (one.strip() for one in fragment.partition(","))
    return EndpointConfig(
        query,
        urljoin(query, update) if update else beside,
        urljoin(query, graphs) if graphs else None,
        bool(update),
        unquote(parts.username or "") or known.get(USER, ""),
        unquote(parts.password or "") or known.get(PASSWORD, ""),
        known.get(TOKEN, ""),
    )


@dataclass(frozen=True)
class EndpointResponse:
    """The answer of an endpoint.

    `max_rows` is the number of rows after which it truncated the result, None for all rows;
    `is_partial` says that it ran out of time, and sent an incomplete result.
    """

    body: bytes
    server: str = ""
    max_rows: int | None = None
    is_partial: bool = False


class EndpointAuth(httpx.Auth):
    """Authentication by the scheme that the server requests: digest, basic, or a bearer token."""

    def __init__(self, address: EndpointConfig) -> None:
        self._address = address
        self._scheme: httpx.Auth | None = None

    def auth_flow(self, request: httpx.Request) -> Generator[httpx.Request, httpx.Response]:
        """Send the request, and again with credentials when the server requests them."""
        address = self._address
        if address.token:
            request.headers["Authorization"] = f"Bearer {address.token}"
        if self._scheme is None:
            response = yield request
            requested = response.headers.get("www-authenticate", "").lower()
            if response.status_code == UNAUTHORIZED and address.user and not address.token:
                scheme = httpx.DigestAuth if "digest" in requested else httpx.BasicAuth
                self._scheme = scheme(address.user, address.password)
        if self._scheme is not None:
            yield from self._scheme.auth_flow(request)


class EndpointTransport:
    """Sends requests to one endpoint; it is thread-safe."""

    def __init__(
        self,
        address: EndpointConfig,
        *,
        pause: Callable[[float], None] = time.sleep,
        connection: httpx.BaseTransport | None = None,
    ) -> None:
        """Prepare requests; `pause` waits [s] before a retry, `connection` is TCP by default."""
        self.address = address
        self._pause = pause
        self._client = httpx.Client(auth=EndpointAuth(address), transport=connection)

    def close(self) -> None:
        """Close the connections."""
        self._client.close()

    def post(
        self,
        url: str,
        *,
        limits: QueryLimits,
        accept: str = "*/*",
        form: Mapping[str, str | Sequence[str]] | None = None,
        ntriples: bytes | None = None,
        may_repeat: bool = True,
    ) -> EndpointResponse:
        """Send a POST request and read the complete answer.

        The body is the fields of a `form`, or else `ntriples`; `accept` are the media types that
        can be read. `limits` are the time for the whole call, and the size of its answer.
        `may_repeat` says that the request is idempotent. QueryError if the server says that the
        query is wrong, or it took too long; StoreError if it cannot be reached, refuses, or fails.
        """
        headers = {"Accept": accept} | ({"Content-Type": N_TRIPLES} if ntriples is not None else {})
        timeout = httpx.Timeout(limits.seconds, connect=min(CONNECT_S, limits.seconds))
        request = self._client.build_request(
            "POST", url, data=form, content=ntriples, headers=headers, timeout=timeout
        )
        asked = form.get("query") or form.get("update") if form else "statements"
        for attempt in range(TRIES):
            is_last = attempt == TRIES - 1
            try:
                with timed(__name__, "request %s %s", url, asked):
                    status, response, wait = self._once(request, limits)
            except httpx.TransportError as error:
                self._raise_unless_retried(error, is_last, may_repeat, limits)
                wait = None
            else:
                if status not in BUSY or is_last or not may_repeat:
                    if response.is_partial:
                        raise limits.time_error()
                    self._check(status, response.body, url)
                    return response
            self._pause(min(wait or FIRST_PAUSE_S * 2**attempt, MAX_PAUSE_S))
        raise AssertionError("the last try returns or raises")

    def _once(
        self, request: httpx.Request, limits: QueryLimits
    ) -> tuple[int, EndpointResponse, float | None]:
        deadline = time.monotonic() + limits.seconds
        received = bytearray()
        with closing(self._client.send(request, stream=True)) as response:
            for chunk in response.iter_bytes():
                received += chunk
                if time.monotonic() > deadline:
                    raise limits.time_error()
                if len(received) > limits.megabytes * 1_000_000:
                    raise limits.memory_error()
            headers = response.headers
            max_rows = headers.get("x-sparql-maxrows", "")
            wait = headers.get("retry-after", "")
            answer = EndpointResponse(
                bytes(received),
                headers.get("server", ""),
                int(max_rows) if max_rows.isdigit() else None,
                headers.get("x-sql-state", "") == OUT_OF_TIME,
            )
            return response.status_code, answer, float(wait) if wait.isdigit() else None

    def _raise_unless_retried(
        self, error: httpx.TransportError, is_last: bool, may_repeat: bool, limits: QueryLimits
    ) -> None:
        if isinstance(error, (httpx.ReadTimeout, httpx.WriteTimeout)):
            raise limits.time_error() from error
        was_not_sent = isinstance(error, (httpx.ConnectError, httpx.ConnectTimeout))
        if is_last or not (was_not_sent or may_repeat):
            text = re.sub(r"^\[Errno -?\d+\] ", "", str(error)).strip().rstrip(".")
            reason = text[:1].lower() + text[1:] or type(error).__name__
            raise StoreError(
                f'The endpoint "{self.address.query}" cannot be reached: {reason}. '
                "Is it running, and is the address right?"
            ) from error

    def _check(self, status: int, body: bytes, url: str) -> None:
        if status < REDIRECT:
            return
        message = _first_line(body)
        if status in LOGIN or NO_PERMISSION.search(message):
            hint = f"Set {USER} and {PASSWORD}, or {TOKEN}."
            if self.address.user or self.address.token:
                hint = "The given credentials are not sufficient."
            raise StoreError(f'The endpoint "{url}" refuses: {message} {hint}')
        if status == BAD_REQUEST:
            raise QueryError(f"The endpoint says: {message}")
        if status in NOT_THERE:
            raise StoreError(
                f'The endpoint "{url}" does not accept this (HTTP {status}). Name the address of '
                'updates after a "#", as in http://host:3030/ds/query#update.'
            )
        raise StoreError(f'The endpoint "{url}" failed (HTTP {status}): {message}')


def _first_line(body: bytes) -> str:
    with suppress(ValueError, KeyError, TypeError):  # a problem document
        return str(json.loads(body)["detail"])[:MAX_MESSAGE].rstrip(".") + "."
    lines = body[:10_000].decode("utf-8", "replace").strip().splitlines()
    text = next((line.strip() for line in lines if line.strip()), "no message")
    return text[:MAX_MESSAGE].rstrip(".") + "."
