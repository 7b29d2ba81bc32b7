# SPDX-License-Identifier: Apache-2.0
"""HTTP to an endpoint: logging in, time-outs, trying again, and errors that a person can act on.

A call that may be repeated without harm is tried again, a little later each time, when the
connection fails or the server says that it is busy. Redirects are not followed, so credentials
reach nobody else.
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
LONGEST_PAUSE_S = 5.0  # however long a server asks to wait
CONNECT_S = 10.0
FIRST_NOT_DONE, BAD_REQUEST, UNAUTHORIZED = 300, 400, 401  # HTTP status
NOT_THERE = frozenset({404, 405})
BUSY = frozenset({429, 502, 503, 504})
LOGIN = frozenset({401, 403, 407})
NO_PERMISSION = re.compile(r"\bSR186\b|permission|not authori[sz]ed", re.IGNORECASE)
OUT_OF_TIME = "S1TAT"  # what Virtuoso says beside an answer that is not whole
MAX_TOLD = 300  # characters of a server's message that are shown

Form = Mapping[str, "str | Sequence[str]"]


@dataclass(frozen=True)
class Address:
    """The addresses of one endpoint, and who asks.

    Attributes:
        query: where queries go; without credentials, as it is shown.
        update: where updates go.
        graphs: where whole graphs are put (Graph Store Protocol); None where that is not known.
        is_update_given: whether somebody said where updates go.
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
        """Whether there is anything to log in with."""
        return bool(self.user or self.token)


def parse_address(location: str, environment: Mapping[str, str] | None = None) -> Address:
    """The addresses that a location stands for.

    >>> found = parse_address("http://localhost:3030/ds/query#update,data", {})
    >>> found.update, found.graphs
    ('http://localhost:3030/ds/update', 'http://localhost:3030/ds/data')

    Args:
        location: what was given to `--kb`.
        environment: where credentials are looked up; the process's by default.

    Raises:
        StoreError: it is no http or https address.
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
        # Not shown: what cannot be read may hold a password all the same.
        raise StoreError("The address of the endpoint is none: expected http(s)://host:port/path.")
    return parts


def _update_beside(query: str) -> str:
    is_query = urlsplit(query).path.endswith("/query")
    return query.removesuffix("query") + "update" if is_query else query


@dataclass(frozen=True)
class Response:
    """What an endpoint answered.

    Attributes:
        body: all of it.
        server: how the server calls itself.
        most_rows: how many rows it gave when it gave no more; None when it gave all.
        is_partial: whether it gave up because of the time, and sent what it had.
    """

    body: bytes
    server: str = ""
    most_rows: int | None = None
    is_partial: bool = False


class Challenged(httpx.Auth):
    """Logs in by the scheme that the server asks for: digest, basic, or a bearer token."""

    def __init__(self, address: Address) -> None:
        self._token = address.token
        self._basic = httpx.BasicAuth(address.user, address.password)
        self._digest = httpx.DigestAuth(address.user, address.password)
        self._has_name = bool(address.user)
        self._scheme = "bearer" if address.token else ""

    def auth_flow(self, request: httpx.Request) -> Generator[httpx.Request, httpx.Response]:
        """Send the request, and once more with credentials when the server asks for them."""
        if self._scheme:
            yield from self._with(self._scheme, request)
            return
        response = yield request
        asked = response.headers.get("www-authenticate", "").lower()
        found = next((scheme for scheme in ("digest", "basic") if scheme in asked), "")
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
    """Sends requests to one endpoint; threads may share it."""

    def __init__(
        self,
        address: Address,
        *,
        pause: Callable[[float], None] = time.sleep,
        connection: httpx.BaseTransport | None = None,
    ) -> None:
        """Prepare to talk to an endpoint; nothing is sent yet.

        Args:
            address: of the endpoint.
            pause: waits some seconds before the next try.
            connection: how bytes travel; by TCP by default.
        """
        self.address = address
        self._pause = pause
        self._client = httpx.Client(auth=Challenged(address), transport=connection)

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
        """Send something and read the whole answer.

        Args:
            url: where to.
            accept: the media types that can be read.
            limits: time for the whole call, and size of its answer.
            form: fields of a form; or else
            content: the body, of a
            content_type: media type.
            may_repeat: whether doing it twice is as good as once.

        Raises:
            QueryError: the server says that the query is wrong, or it took too long.
            StoreError: the server is away, refuses, or fails.
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
                self._again(error, is_last, may_repeat, limits)
                wait = None
            else:
                if status not in BUSY or is_last or not may_repeat:
                    if response.is_partial:
                        raise limits.time_error()
                    self._check(status, response.body, url)
                    return response
            self._pause(min(wait or FIRST_PAUSE_S * 2**attempt, LONGEST_PAUSE_S))
        raise AssertionError("the last try returns or raises")

    def _once(self, request: httpx.Request, limits: Limits) -> tuple[int, Response, float | None]:
        """One try: status, answer, and how many seconds the server asks to wait."""
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
            most = headers.get("x-sparql-maxrows", "")
            wait = headers.get("retry-after", "")
            answer = Response(
                bytes(received),
                headers.get("server", ""),
                int(most) if most.isdigit() else None,
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

    def _again(
        self, error: httpx.TransportError, is_last: bool, may_repeat: bool, limits: Limits
    ) -> None:
        """Raise, unless another try makes sense."""
        if isinstance(error, (httpx.ReadTimeout, httpx.WriteTimeout)):
            raise limits.time_error() from error
        never_arrived = isinstance(error, (httpx.ConnectError, httpx.ConnectTimeout))
        if is_last or not (never_arrived or may_repeat):
            raise StoreError(
                f'The endpoint "{self.address.query}" cannot be reached: {_reason(error)} '
                "Is it running, and is the address right?"
            ) from error

    def _check(self, status: int, body: bytes, url: str) -> None:
        """Raise what the status of an answer means."""
        if status < FIRST_NOT_DONE:
            return
        told = _first_line(body)
        if status in LOGIN or NO_PERMISSION.search(told):
            raise StoreError(f'The endpoint "{url}" refuses: {told} {self._login_hint()}')
        if status == BAD_REQUEST:
            raise QueryError(f"The endpoint says: {told}")
        if status in NOT_THERE:
            raise StoreError(
                f'The endpoint "{url}" does not take this (HTTP {status}). Name the address of '
                'updates after a "#", as in http://host:3030/ds/query#update.'
            )
        raise StoreError(f'The endpoint "{url}" failed (HTTP {status}): {told}')

    def _login_hint(self) -> str:
        if self.address.has_credentials:
            return "The credentials that were given are not enough."
        return f"Set {USER} and {PASSWORD}, or {TOKEN}."


def _timeout(limits: Limits) -> httpx.Timeout:
    return httpx.Timeout(limits.seconds, connect=min(CONNECT_S, limits.seconds))


def _reason(error: Exception) -> str:
    text = re.sub(r"^\[Errno -?\d+\] ", "", str(error)).strip().rstrip(".")
    return (text[:1].lower() + text[1:] if text else type(error).__name__) + "."


def _first_line(body: bytes) -> str:
    lines = body[:10_000].decode("utf-8", "replace").strip().splitlines()
    text = next((line.strip() for line in lines if line.strip()), "nothing else was said")
    return text[:MAX_TOLD].rstrip(".") + "."
