"""The outermost layer of the service, which every request passes before anything else sees it.

`Host` must be a name that is served, against DNS rebinding, and the `Origin` of a browser must be
ours, also for WebSockets. Bodies are counted while they come. What was asked is counted and noted:
who, what and how it ended, never a token and never a body.
"""

from __future__ import annotations

import asyncio
import logging
import time
from urllib.parse import urlsplit

from prometheus_client import CollectorRegistry, Counter, Histogram
from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .problems import Problem, forbidden
from .security import ServiceSettings
from .tokens import Caller

_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; "
    "worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "object-src 'none'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}
_IMPORT = "/api/v1/import"
_BODY_SECONDS = 120.0  # in which a body must be there
_POLICY_VIOLATED = 1008
_audit = logging.getLogger("hilt.audit")


class Doorkeeper:
    """An ASGI middleware; counts into a registry of Prometheus."""

    def __init__(
        self, app: ASGIApp, settings: ServiceSettings, registry: CollectorRegistry
    ) -> None:
        self._app, self._settings = app, settings
        labels = ("method", "route", "status")
        self._asked = Counter("hilt_requests", "Requests", labels, registry=registry)
        self._took = Histogram("hilt_request_seconds", "Time of requests", registry=registry)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] not in {"http", "websocket"}:
            await self._app(scope, receive, send)
            return
        started, status = time.monotonic(), 101

        async def sending(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                headers = MutableHeaders(scope=message)
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
            elif message["type"] == "websocket.close":
                status = message.get("code", status)
            await send(message)

        try:
            self._check(Headers(scope=scope))
            await self._app(scope, self._bounded(scope, receive), sending)
        except Problem as problem:  # of the check; what the app raises it answers itself
            if scope["type"] == "http":
                await problem.response(scope, receive, sending)
            else:
                await sending({"type": "websocket.close", "code": _POLICY_VIOLATED})
        finally:
            self._note(scope, status, time.monotonic() - started)

    def _check(self, headers: Headers) -> None:
        host, origin = headers.get("host", ""), headers.get("origin")
        if _hostname(host) not in self._settings.hosts:
            raise Problem(421, "host", "Unknown host", "This service has another name.")
        is_ours = origin is None or origin.partition("://")[2] == host
        is_known = origin in self._settings.origins and "cookie" not in headers
        if not (is_ours or is_known):
            raise forbidden("Pages of other sites may not ask here.")

    def _bounded(self, scope: Scope, receive: Receive) -> Receive:
        if scope["type"] != "http":
            return receive
        is_import = scope["path"] == _IMPORT
        most = self._settings.most_import if is_import else self._settings.most_body
        left, end = most, time.monotonic() + _BODY_SECONDS * (10 if is_import else 1)
        is_whole = False

        async def counted() -> Message:
            nonlocal left, is_whole
            if is_whole:  # it waits for the end of the connection
                return await receive()
            try:
                message = await asyncio.wait_for(receive(), max(0.0, end - time.monotonic()))
            except asyncio.TimeoutError:
                raise Problem(408, "slow", "Too slow", "The body did not end in time.") from None
            left -= len(message.get("body", b""))
            if left < 0:
                raise Problem(413, "too-large", "Too large", f"A body has at most {most} bytes.")
            is_whole = not message.get("more_body")
            return message

        return counted

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        route = getattr(scope.get("route"), "path", "-")
        method, caller = scope.get("method", "WS"), scope.get("hilt.caller")
        self._asked.labels(method, route, status).inc()
        self._took.observe(seconds)
        if isinstance(caller, Caller):
            _audit.info("%s %s %s %s %s", caller.id, caller.speaker, method, route, status)
        else:
            _audit.info("- - %s %s %s", method, route, status)


def _hostname(host: str) -> str | None:
    try:
        return urlsplit(f"//{host}").hostname
    except ValueError:
        return None
