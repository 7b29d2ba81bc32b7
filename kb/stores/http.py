# SPDX-License-Identifier: Apache-2.0
"""HTTP requests to a SPARQL endpoint: addresses, authentication, time-outs, retries and errors.

`http://host/path` is the address of queries. After a `#` it may name the address of updates and,
after a comma, that of the Graph Store Protocol; both relative to the query address:

    http://host:3030/ds/query#update,data         Fuseki: /ds/update and /ds/data
    http://host:7200/repositories/kb#kb/statements    GraphDB

Without `#` updates go to the query address, but to `.../update` where that is `.../query`.
Credentials are part of the address (`http://name:password@host/...`) or in the environment, and
are never shown.

A request that may be repeated is retried after increasing pauses when the connection fails or the
server is busy. Redirects are not followed, so that no other server receives the credentials.
"""

from __future__ import annotations

import os
import re
import time
from collections.abc import Callable, Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from urllib.parse import SplitResult, unquote, urldefrag, urljoin, urlsplit, urlunsplit

import httpx

from ...ontology.errors import QueryError, StoreError
from ..sparql.results import Limits

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
OUT_OF_TIME = "S1TAT"  # Virtuoso's state of an incomplete answer
MAX_MESSAGE = 300  # characters of a server's message that are shown

Form = Mapping[str, "str | Sequence[str]"]


@dataclass(frozen=True)
class Address:
    """The addresses of one endpoint, with the credentials.

    Attributes:
        query: address of queries, without credentials.
        update: address of updates.
        graphs: address of the Graph Store Protocol; None where that is not known.
        is_update_given: whether the address of updates was given.
        user: name for basic or digest authentication; empty for none.
        password: the password of that name.
        token: for bearer authentication; empty for none.
    """

    query: str
    update: str
    graphs: str | None = None
    is_update_given: bool = False
    user: str = ""
    password: str = field(default="", repr=False)
    token: str = field(default="", repr=False)

    @property
    def has_credentials(self) -> bool:
        """Whether there are credentials."""
        return bool(self.user or self.token)


def parse_address(location: str, environment: Mapping[str, str] | None = None) -> Address:
    """The addresses of a location.

    >>> found = parse_address("http://localhost:3030/ds/query#update,data", {})
    >>> found.update, found.graphs
    ('http://localhost:3030/ds/update', 'http://localhost:3030/ds/data')

    Args:
        location: the value of `--kb`.
        environment: environment variables with credentials; the process's by default.

    Raises:
        StoreError: it is not an http or https address.
    """
    known = os.environ if environment is None else environment
    bare, fragment = urldefrag(location)
    parts = _split(bare)
    query = urlunsplit((parts.scheme, parts.netloc.rpartition("@")[2], parts.path, parts.query, ""))
    update, _, graphs = (one.strip() for one in fragment.partition(","))
    return Address(
        query,
        urljoin(query, update) if update else _update_beside(query),
        urljoin(query, graphs) if graphs else None,
        bool(update),
        unquote(parts.username or "") or known.get(USER, ""),
        unquote(parts.password or "") or known.get(PASSWORD, ""),
        known.get(TOKEN, ""),
    )


def _split(location: str) -> SplitResult:
    try:
        parts = urlsplit(location)
        valid = parts.scheme in {"http", "https"} and bool(parts.hostname) and parts.port != 0
    except ValueError:
        parts, valid = urlsplit(""), False
    if not valid:
        # Not shown: it may hold a password all the same.
        raise StoreError(
            "The address of the endpoint is not valid: expected http(s)://host:port/path."
        )
    return parts


def _update_beside(query: str) -> str:
    is_query = urlsplit(query).path.endswith("/query")
    return query.removesuffix("query") + "update" if is_query else query


@dataclass(frozen=True)
class Response:
    """The answer of an endpoint.

    Attributes:
        body: the complete body.
        server: name of the server software.
        max_rows: the number of rows after which it truncated the result; None for all rows.
        is_partial: whether it ran out of time, and sent an incomplete result.
    """

    body: bytes
    server: str = ""
    max_rows: int | None = None
    is_partial: bool = False


class EndpointAuth(httpx.Auth):
    """Authentication by the scheme that the server requests: digest, basic, or a bearer token."""

    def __init__(self, address: Address) -> None:
        self._token = address.token
        self._basic = httpx.BasicAuth(address.user, address.password)
        self._digest = httpx.DigestAuth(address.user, address.password)
        self._has_name = bool(address.user)
        self._scheme = "bearer" if address.token else ""

    def auth_flow(self, request: httpx.Request) -> Generator[httpx.Request, httpx.Response]:
        """Send the request, and again with credentials when the server requests them."""
        if self._scheme:
            yield from self._with(self._scheme, request)
            return
        response = yield request
        requested = response.headers.get("www-authenticate", "").lower()
        found = next((scheme for scheme in ("digest", "basic") if scheme in requested), "")
        if response.status_code == UNAUTHORIZED and found and self._has_name:
            self._scheme = found
            yield from self._with(found, request)

    def _with(
        self, scheme: str, request: httpx.Request
    ) -> Generator[httpx.Request, httpx.Response]:
        if scheme == "bearer":
            request.headers["Authorization"] = f"Bearer {self._token}"
            yield request
        else:
            yield from (self._digest if scheme == "digest" else self._basic).auth_flow(request)


class Transport:
    """Sends requests to one endpoint; it is thread-safe."""

    def __init__(
        self,
        address: Address,
        *,
        pause: Callable[[float], None] = time.sleep,
        connection: httpx.BaseTransport | None = None,
    ) -> None:
        """Prepare requests to an endpoint; nothing is sent yet.

        Args:
            address: the address of the endpoint.
            pause: waits some seconds before a retry.
            connection: the transport of httpx; TCP by default.
        """
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
        accept: str,
        limits: Limits,
        form: Form | None = None,
        content: bytes | None = None,
        content_type: str = "",
        may_repeat: bool = True,
    ) -> Response:
        """Send a POST request and read the complete answer.

        Args:
            url: the address.
            accept: the media types that can be read.
            limits: time for the whole call, and size of its answer.
            form: fields of a form; without it,
            content: the body, and
            content_type: its media type.
            may_repeat: whether the request is idempotent.

        Raises:
            QueryError: the server says that the query is wrong, or it took too long.
            StoreError: the server cannot be reached, refuses, or fails.
        """
        headers = {"Accept": accept} | ({"Content-Type": content_type} if content_type else {})
        request = self._client.build_request(
            "POST", url, data=form, content=content, headers=headers, timeout=_timeout(limits)
        )
        for attempt in range(TRIES):
            is_last = attempt == TRIES - 1
            try:
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

    def _once(self, request: httpx.Request, limits: Limits) -> tuple[int, Response, float | None]:
        """One attempt: status, answer, and the seconds that the server asks to wait."""
        deadline = time.monotonic() + limits.seconds
        received = bytearray()
        with self._sent(request) as response:
            for chunk in response.iter_bytes():
                received += chunk
                if time.monotonic() > deadline:
                    raise limits.time_error()
                if len(received) > limits.megabytes * 1_000_000:
                    raise limits.memory_error()
            headers = response.headers
            max_rows = headers.get("x-sparql-maxrows", "")
            wait = headers.get("retry-after", "")
            answer = Response(
                bytes(received),
                headers.get("server", ""),
                int(max_rows) if max_rows.isdigit() else None,
                headers.get("x-sql-state", "") == OUT_OF_TIME,
            )
            return response.status_code, answer, float(wait) if wait.isdigit() else None

    @contextmanager
    def _sent(self, request: httpx.Request) -> Generator[httpx.Response]:
        response = self._client.send(request, stream=True)
        try:
            yield response
        finally:
            response.close()

    def _raise_unless_retried(
        self, error: httpx.TransportError, is_last: bool, may_repeat: bool, limits: Limits
    ) -> None:
        """Raise the error of an attempt, unless it is to be retried."""
        if isinstance(error, (httpx.ReadTimeout, httpx.WriteTimeout)):
            raise limits.time_error() from error
        was_not_sent = isinstance(error, (httpx.ConnectError, httpx.ConnectTimeout))
        if is_last or not (was_not_sent or may_repeat):
            raise StoreError(
                f'The endpoint "{self.address.query}" cannot be reached: {_reason(error)} '
                "Is it running, and is the address right?"
            ) from error

    def _check(self, status: int, body: bytes, url: str) -> None:
        """Raise the error of an answer's status."""
        if status < REDIRECT:
            return
        message = _first_line(body)
        if status in LOGIN or NO_PERMISSION.search(message):
            raise StoreError(f'The endpoint "{url}" refuses: {message} {self._login_hint()}')
        if status == BAD_REQUEST:
            raise QueryError(f"The endpoint says: {message}")
        if status in NOT_THERE:
            raise StoreError(
                f'The endpoint "{url}" does not accept this (HTTP {status}). Name the address of '
                'updates after a "#", as in http://host:3030/ds/query#update.'
            )
        raise StoreError(f'The endpoint "{url}" failed (HTTP {status}): {message}')

    def _login_hint(self) -> str:
        if self.address.has_credentials:
            return "The given credentials are not sufficient."
        return f"Set {USER} and {PASSWORD}, or {TOKEN}."


def _timeout(limits: Limits) -> httpx.Timeout:
    return httpx.Timeout(limits.seconds, connect=min(CONNECT_S, limits.seconds))


def _reason(error: Exception) -> str:
    text = re.sub(r"^\[Errno -?\d+\] ", "", str(error)).strip().rstrip(".")
    return (text[:1].lower() + text[1:] if text else type(error).__name__) + "."


def _first_line(body: bytes) -> str:
    lines = body[:10_000].decode("utf-8", "replace").strip().splitlines()
    text = next((line.strip() for line in lines if line.strip()), "no message")
    return text[:MAX_MESSAGE].rstrip(".") + "."
