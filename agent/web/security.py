"""Who asks, what that one may do, and how often.

A bearer token counts everywhere. The cookie of the page counts for the page and `/api` only: any
other page could post a form to `/update`, which needs no preflight.
"""

from __future__ import annotations

import secrets
import time
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, field
from ipaddress import ip_address
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from fastapi import Depends
from limits import RateLimitItem, parse
from limits.storage import MemoryStorage
from limits.strategies import MovingWindowRateLimiter
from starlette.requests import HTTPConnection

from .problems import Problem, forbidden
from .tokens import ROLES, Caller, TokenFile

OWNER = "owner"
CALLER = "hilt.caller"  # in the scope of a request, once it is known
_READS = {"GET", "HEAD", "OPTIONS"}


@dataclass(frozen=True)
class ServiceSettings:
    """Where and for whom a service listens, and what it allows.

    Attributes:
        port: 0 for a free one.
        names: further host names by which it is reached.
        origins: other sites whose pages may ask, with a bearer token.
        certificate, key_file: of TLS, in PEM.
        behind_proxy: whether a proxy does TLS.
        needs_key: whether the owner shows a one-time key.
        speaker: for whom the owner speaks.
        requests: of a token; so many may come at once. "" for any number.
        failures: wrong keys of an address.
        most_body, most_file: bytes of what is sent; of what takes whole files.
        pace: seconds of the world in one of the clock, at most, while somebody looks; 0 for any.
    """

    host: str = "127.0.0.1"
    port: int = 8765
    names: tuple[str, ...] = ()
    origins: tuple[str, ...] = ()
    certificate: Path | None = None
    key_file: Path | None = None
    behind_proxy: bool = False
    needs_key: bool = True
    speaker: str = "sam"
    requests: str = "30/3 seconds"
    failures: str = "5/minute"
    most_body: int = 2**20
    most_file: int = 2**28
    pace: float = 1.0

    @property
    def has_tls(self) -> bool:
        """Whether what is asked is encrypted on its way."""
        return self.certificate is not None or self.behind_proxy


@dataclass
class Gate:
    """Knows who asks, by a token, a session or the one-time key, and how much they ask.

    Attributes:
        key: opens the next session of the owner; None when none is needed.
    """

    settings: ServiceSettings
    tokens: TokenFile
    key: str | None = None
    _limiter: MovingWindowRateLimiter = field(
        default_factory=lambda: MovingWindowRateLimiter(MemoryStorage())
    )

    def __post_init__(self) -> None:
        self.key = secrets.token_urlsafe(24) if self.settings.needs_key else None

    @property
    def owner(self) -> Caller:
        """Who started the service."""
        return Caller(OWNER, self.settings.speaker, frozenset(ROLES))

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
        found = self.tokens.find(secret)
        if found is None:
            self._limiter.hit(failures, address)
            raise _unknown("No such key or token, or it has expired.")
        return found.caller

    def caller_of(self, asked: HTTPConnection, *, cookies: bool = True) -> Caller:
        """Who asks; Problem 401 if nobody is known, 429 if that one asks too much."""
        scheme, _, secret = asked.headers.get("authorization", "").partition(" ")
        session = self._in_session(asked) if cookies else None
        if scheme.lower() == "bearer":
            caller = self.caller_with(asked, secret.strip())
        elif not self.settings.needs_key:
            caller = self.owner
        elif session:
            caller = session
        else:
            raise _unknown("Show a token (Authorization: Bearer hilt_...), or open the page.")
        asked.scope[CALLER] = caller
        if caller.id != OWNER and self.settings.requests:
            requests = parse(self.settings.requests)
            if not self._limiter.hit(requests, caller.id):
                raise self._too_many(requests, caller.id)
        return caller

    def _in_session(self, asked: HTTPConnection) -> Caller | None:
        known: str | None = asked.session.get("caller")
        valid = {each.id: each.caller for each in self.tokens.tokens() if each.is_valid}
        caller = ({OWNER: self.owner} | valid).get(known or "")
        changes = asked.scope.get("method", "GET") not in _READS
        is_own = asked.headers.get("sec-fetch-site") == "same-origin" or "origin" in asked.headers
        if caller and changes and not is_own:  # an origin is checked before
            raise forbidden("A cookie counts for requests of the page only.")
        return caller

    def _too_many(self, limit: RateLimitItem, who: str) -> Problem:
        left = self._limiter.get_window_stats(limit, who)
        seconds = max(1, round(left.reset_time - time.time()))
        detail = f"At most {limit}."
        headers = {"Retry-After": str(seconds)}
        return Problem(429, "too-many", "Too many requests", detail, headers=headers)


def _unknown(detail: str) -> Problem:
    headers = {"WWW-Authenticate": "Bearer"}
    return Problem(401, "who", "Who asks?", detail, headers=headers)


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
        detail = f"This needs the role {role}; this token has: {has}."
        raise forbidden(detail, needs=role)


Reader: TypeAlias = Annotated[Caller, Depends(needs("reader"))]
Teacher: TypeAlias = Annotated[Caller, Depends(needs("teacher"))]
Operator: TypeAlias = Annotated[Caller, Depends(needs("operator"))]
Admin: TypeAlias = Annotated[Caller, Depends(needs("admin"))]
