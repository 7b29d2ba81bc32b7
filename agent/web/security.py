"""Who asks, what that one may do, and how often.

A bearer token counts everywhere. The cookie of the page counts for the page and `/api` only: any
other page could post a form to `/update`, which needs no preflight.
"""

from __future__ import annotations

import secrets
import time
from collections import defaultdict, deque
from collections.abc import Callable, Coroutine
from dataclasses import dataclass, field
from ipaddress import ip_address
from typing import Annotated, Any, TypeAlias

from fastapi import Depends
from starlette.requests import HTTPConnection

from .problems import Problem, forbidden
from .tokens import ROLES, Caller, TokenFile

_FAILED_KEYS, _MINUTE = 5, 60.0  # of an address


@dataclass(frozen=True)
class ServiceSettings:
    """What a service allows.

    Attributes:
        hosts: the names that it is reached by, without ports.
        speaker: for whom the owner speaks, who has the key.
        key: the first one-time key; None lets everybody in as the owner.
        origins: other sites whose pages may ask with a bearer token.
        rate, burst: requests a second of a token, and how many may come at once; 0 for no limit.
        most_body, most_import: bytes.
        secure: whether cookies go over TLS only.
    """

    hosts: frozenset[str] = frozenset({"127.0.0.1", "localhost", "::1"})
    speaker: str = "sam"
    key: str | None = None
    origins: frozenset[str] = frozenset()
    rate: float = 10.0
    burst: int = 30
    most_body: int = 2**20
    most_import: int = 2**28
    secure: bool = False
    cookie: str = "hilt"


@dataclass
class Gate:
    """Knows who asks, by their token or their session, and how much they ask.

    Attributes:
        key: the one-time key that opens the next session; None when none is needed.
    """

    settings: ServiceSettings
    tokens: TokenFile
    key: str | None = None
    _sessions: dict[str, str] = field(default_factory=dict[str, str])  # to ids of callers
    _failed: dict[str, deque[float]] = field(default_factory=lambda: defaultdict(deque))
    _buckets: dict[str, tuple[float, float]] = field(default_factory=dict[str, tuple[float, float]])

    def __post_init__(self) -> None:
        self.key = self.settings.key

    @property
    def owner(self) -> Caller:
        """Who started the service."""
        return Caller("owner", self.settings.speaker, frozenset(ROLES))

    def open_session(self, key: str, address: str) -> str:
        """The cookie for a one-time key or a token; Problem 401 if it is neither."""
        caller = self.owner if self._is_key(key) else self.caller_with(key, address)
        self._sessions[session := secrets.token_urlsafe(32)] = caller.id
        return session

    def close_session(self, session: str) -> None:
        """Forget a session."""
        self._sessions.pop(session, None)

    def _is_key(self, key: str) -> bool:
        if self.key is None or not secrets.compare_digest(key.encode(), self.key.encode()):
            return False
        self.key = secrets.token_urlsafe(24)  # each opens one session
        return True

    def caller_with(self, secret: str, address: str) -> Caller:
        """Who shows a token; Problem 401 or, after too many wrong ones, 429."""
        failed, now = self._failed[address], time.monotonic()
        while failed and failed[0] < now - _MINUTE:
            failed.popleft()
        if len(failed) >= _FAILED_KEYS:
            raise _too_many("Too many wrong keys.", _MINUTE)
        found = self.tokens.find(secret)
        if found is None:
            failed.append(now)
            raise _unknown("No such key or token, or it has expired.")
        return found.caller

    def caller_of(self, asked: HTTPConnection, *, cookies: bool = True) -> Caller:
        """Who asks; Problem 401 if nobody is known, 429 if that one asks too much."""
        scheme, _, secret = asked.headers.get("authorization", "").partition(" ")
        session = self._in_session(asked.cookies.get(self.settings.cookie, "")) if cookies else None
        if scheme.lower() == "bearer":
            caller = self.caller_with(secret.strip(), address_of(asked))
        elif session:
            _check_own_page(asked)
            caller = session
        elif self.settings.key is None:
            caller = self.owner
        else:
            raise _unknown("Show a token (Authorization: Bearer hilt_...), or open the page.")
        asked.scope["hilt.caller"] = caller
        self._count(caller)
        return caller

    def _in_session(self, session: str) -> Caller | None:
        known = self._sessions.get(session)
        if known == self.owner.id:
            return self.owner
        valid = (each for each in self.tokens.tokens() if not each.is_expired)
        return next((each.caller for each in valid if each.id == known), None)

    def _count(self, caller: Caller) -> None:
        if caller.id == self.owner.id or not self.settings.rate:
            return
        left, then = self._buckets.get(caller.id, (self.settings.burst, time.monotonic()))
        now = time.monotonic()
        left = min(self.settings.burst, left + (now - then) * self.settings.rate)
        self._buckets[caller.id] = (max(0.0, left - 1), now)
        if left < 1:
            raise _too_many("Too many requests.", (1 - left) / self.settings.rate)


def _check_own_page(asked: HTTPConnection) -> None:
    changes = asked.scope.get("method", "GET") not in {"GET", "HEAD"}
    is_own = asked.headers.get("sec-fetch-site") == "same-origin"
    if changes and not is_own and "origin" not in asked.headers:  # else it was checked before
        raise forbidden("A cookie counts for requests of the page only.")


def _unknown(detail: str) -> Problem:
    headers = {"WWW-Authenticate": "Bearer"}
    return Problem(401, "who", "Who asks?", detail, headers=headers)


def _too_many(detail: str, seconds: float) -> Problem:
    headers = {"Retry-After": str(max(1, round(seconds)))}
    return Problem(429, "too-many", "Too many requests", detail, headers=headers)


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


def check_role(caller: Caller, *roles: str) -> None:
    """A problem 403 unless somebody has all of these roles."""
    for role in roles:
        if not caller.may(role):
            has = ", ".join(sorted(caller.roles)) or "none"
            detail = f"This needs the role {role}; this token has: {has}."
            raise forbidden(detail, needs=role)


Reader: TypeAlias = Annotated[Caller, Depends(needs("reader"))]
Teacher: TypeAlias = Annotated[Caller, Depends(needs("teacher"))]
Operator: TypeAlias = Annotated[Caller, Depends(needs("operator"))]
Admin: TypeAlias = Annotated[Caller, Depends(needs("admin"))]
