"""Who asks, what that one may do, and how often; and what every request passes first.

A bearer token counts everywhere. The cookie of the page counts for the page and `/api` only: any
other page could post a form to `/update`, which needs no preflight.

`Host` must be a name that is served, against DNS rebinding, and the `Origin` of a browser must be
ours, also for WebSockets. Bodies are counted while they come. What was asked is counted and noted:
who, what and how it ended, never a token and never a body.
"""

import logging
import secrets
import time
from collections.abc import Callable, Coroutine
from dataclasses import dataclass
from ipaddress import ip_address
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from fastapi import Depends
from limits import RateLimitItem, parse
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter
from prometheus_client import CollectorRegistry, Counter, Histogram
from starlette.datastructures import Headers
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.requests import HTTPConnection
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .problems import Problem, forbidden
from .tokens import ROLES, Caller, TokenFile

OWNER = "owner"
CALLER = "hilt.caller"  # in the scope of a request, once it is known
_READS = {"GET", "HEAD", "OPTIONS"}
_POLICY = (
    "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; worker-src 'self' blob:; "
    "style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; media-src 'self' blob:; "
    "object-src 'none'; base-uri 'none'; frame-ancestors 'none'"
)
_HEADERS = [
    (b"content-security-policy", _POLICY.encode()),
    (b"x-content-type-options", b"nosniff"),
    (b"referrer-policy", b"no-referrer"),
]
_OWN_HOSTS = ("127.0.0.1", "localhost", "::1", "[::1]")
_TOO_LARGE = 413
_FILES = ("/api/v1/import", "/store")  # take whole files
_audit, _log = logging.getLogger("hilt.audit"), logging.getLogger(__name__)


@dataclass(frozen=True)
class ServiceSettings:
    """Where and for whom a service listens, and what it allows."""

    host: str = "127.0.0.1"
    port: int = 8765  # 0 for a free one
    names: tuple[str, ...] = ()  # further ones of this host
    origins: tuple[str, ...] = ()  # other sites whose pages may ask, with a bearer token
    certificate: Path | None = None  # of TLS, in PEM
    key_file: Path | None = None
    behind_proxy: bool = False  # which does TLS
    needs_key: bool = True  # which the owner shows once
    speaker: str = "sam"  # for whom the owner speaks
    requests: str = "30/3 seconds"  # of a token; so many may come at once
    failures: str = "5/minute"  # wrong keys of an address
    most_body: int = 2**20  # bytes of what is sent
    most_file: int = 2**28  # bytes of what takes whole files
    pace: float = 1.0  # seconds of the world in one of the clock, while somebody looks; 0: any

    @property
    def has_tls(self) -> bool:
        """Whether what is asked is encrypted on its way."""
        return self.certificate is not None or self.behind_proxy


@dataclass
class Gate:
    """Knows who asks, by a token, a session or the one-time key, and how much they ask."""

    settings: ServiceSettings
    tokens: TokenFile

    def __post_init__(self) -> None:
        self._limiter = MovingWindowRateLimiter(MemoryStorage())
        self._owner = Caller(OWNER, self.settings.speaker, frozenset(ROLES))
        # It opens the next session of the owner.
        self.key = secrets.token_urlsafe(24) if self.settings.needs_key else None

    def begin_session(self, asked: HTTPConnection, key: str, *, tokens: bool = True) -> None:
        """Give a browser a cookie for the key, which counts once, or for a token; or Problem.

        No token is taken from an address (`tokens`): it would stand in the history of the browser.
        """
        if self.key and secrets.compare_digest(key.encode(), self.key.encode()):
            self.key = secrets.token_urlsafe(24)
            asked.session["caller"] = OWNER
        else:
            asked.session["caller"] = self.caller_with(asked, key if tokens else "").id

    def caller_with(self, asked: HTTPConnection, secret: str) -> Caller:
        """Who shows a token; Problem 401 or, after too many wrong ones, 429."""
        address, failures = address_of(asked), parse(self.settings.failures)
        if not self._limiter.test(failures, address):
            raise self._too_many(failures, address)
        if (found := self.tokens.find(secret)) is None:
            self._limiter.hit(failures, address)
            raise _unknown("No such key or token, or it has expired.")
        return found.caller

    def caller_of(self, asked: HTTPConnection, *, cookies: bool = True) -> Caller:
        """Who asks; Problem 401 if nobody is known, 429 if that one asks too much."""
        scheme, _, secret = asked.headers.get("authorization", "").partition(" ")
        caller = self._in_session(asked) if cookies else None
        if scheme.lower() == "bearer":
            caller = self.caller_with(asked, secret.strip())
        elif not self.settings.needs_key:
            caller = self._owner
        elif caller is None:
            raise _unknown("Show a token (Authorization: Bearer hilt_...), or open the page.")
        asked.scope[CALLER] = caller
        if caller.id != OWNER:
            requests = parse(self.settings.requests)
            if not self._limiter.hit(requests, caller.id):
                raise self._too_many(requests, caller.id)
        return caller

    def _in_session(self, asked: HTTPConnection) -> Caller | None:
        valid = {each.id: each.caller for each in self.tokens.tokens() if each.is_valid}
        caller = ({OWNER: self._owner} | valid).get(asked.session.get("caller", ""))
        is_own = asked.headers.get("sec-fetch-site") == "same-origin" or "origin" in asked.headers
        if caller and asked.scope.get("method", "GET") not in _READS and not is_own:
            raise forbidden("A cookie counts for requests of the page only.")
        return caller

    def _too_many(self, limit: RateLimitItem, who: str) -> Problem:
        left = self._limiter.get_window_stats(limit, who).reset_time - time.time()
        headers = {"Retry-After": str(max(1, round(left)))}
        return Problem(429, "too-many", "Too many requests", f"At most {limit}.", headers=headers)


def _unknown(detail: str) -> Problem:
    return Problem(401, "who", "Who asks?", detail, headers={"WWW-Authenticate": "Bearer"})


def address_of(asked: HTTPConnection) -> str:
    """The address of who asks."""
    return asked.client.host if asked.client else ""


def is_loopback(host: str) -> bool:
    """Whether an address or a name is this machine's own."""
    try:
        return ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def needs(role: str) -> Callable[[HTTPConnection], Coroutine[Any, Any, Caller]]:
    """A dependency: who asks, who must have a role."""

    async def caller(connection: HTTPConnection) -> Caller:
        found: Caller = connection.app.state.gate.caller_of(connection)
        check_role(found, role)
        return found

    return caller


def check_role(caller: Caller, role: str) -> None:
    """A problem 403 unless somebody has this role."""
    if not caller.may(role):
        has = ", ".join(sorted(caller.roles)) or "none"
        raise forbidden(f"This needs the role {role}; this token has: {has}.", needs=role)


Reader: TypeAlias = Annotated[Caller, Depends(needs("reader"))]
Teacher: TypeAlias = Annotated[Caller, Depends(needs("teacher"))]
Operator: TypeAlias = Annotated[Caller, Depends(needs("operator"))]
Admin: TypeAlias = Annotated[Caller, Depends(needs("admin"))]


class Doorkeeper:
    """The outermost middleware; counts into a registry of Prometheus."""

    def __init__(self, app: ASGIApp, settings: ServiceSettings, metrics: CollectorRegistry) -> None:
        self._settings = settings
        hosts = [*_OWN_HOSTS, settings.host, *settings.names]
        self._app = TrustedHostMiddleware(app, hosts, www_redirect=False)
        labels = ("method", "route", "status")
        self._asked = Counter("hilt_requests", "Requests", labels, registry=metrics)
        self._took = Histogram("hilt_request_seconds", "Time of requests", registry=metrics)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] == "lifespan":
            return await self._app(scope, receive, send)
        started, status, is_gone = time.monotonic(), 101, False
        is_file = scope["path"].startswith(_FILES)
        left = most = self._settings.most_file if is_file else self._settings.most_body

        async def counted() -> Message:
            nonlocal left, is_gone
            message = await receive()
            left -= len(message.get("body", b""))
            is_gone = message["type"] == "http.disconnect"
            if left < 0:
                taken = f"At most {most} bytes are taken here."
                raise Problem(_TOO_LARGE, "too-large", "Too large", taken)
            return message

        async def sending(message: Message) -> None:
            nonlocal status
            if message["type"] in {"http.response.start", "websocket.http.response.start"}:
                status = message["status"]
                given = {name for name, _ in message["headers"]}
                close = [(b"connection", b"close")]  # the rest of the body is not awaited
                added = close * (status == _TOO_LARGE) + _HEADERS
                message["headers"] += [each for each in added if each[0] not in given]
            await send(message)

        app: ASGIApp = self._app
        if not self._is_welcome(Headers(scope=scope)):
            app = forbidden("Pages of other sites may not ask here.").answer
        try:
            await app(scope, counted, sending)
        except Exception:
            if not is_gone:
                raise
            _log.debug("What was sent to somebody who had left failed.", exc_info=True)
        finally:
            method, route = scope.get("method", "WS"), getattr(scope.get("route"), "path", "-")
            self._asked.labels(method, route, status).inc()
            self._took.observe(time.monotonic() - started)
            caller = scope.get(CALLER)
            who = f"{caller.id} {caller.speaker}" if isinstance(caller, Caller) else "- -"
            _audit.info("%s %s %s %s", who, method, route, status)

    def _is_welcome(self, headers: Headers) -> bool:
        origin = headers.get("origin")
        is_ours = origin is None or origin.partition("://")[2] == headers.get("host")
        return is_ours or (origin in self._settings.origins and "cookie" not in headers)
