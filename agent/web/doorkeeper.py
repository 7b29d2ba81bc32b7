"""What every request passes before anything else sees it.

`Host` must be a name that is served, against DNS rebinding, and the `Origin` of a browser must be
ours, also for WebSockets. Bodies are counted while they come. What was asked is counted and noted:
who, what and how it ended, never a token and never a body.
"""

from __future__ import annotations

import logging
import time

from prometheus_client import CollectorRegistry, Counter, Histogram
from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.trustedhost import TrustedHostMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .problems import Problem, forbidden
from .security import CALLER, ServiceSettings
from .tokens import Caller

_HEADERS = {
    "Content-Security-Policy": "default-src 'self'; script-src 'self' 'wasm-unsafe-eval'; "
    "worker-src 'self' blob:; style-src 'self' 'unsafe-inline'; img-src 'self' data: blob:; "
    "object-src 'none'; base-uri 'none'; frame-ancestors 'none'",
    "X-Content-Type-Options": "nosniff",
    "Referrer-Policy": "no-referrer",
}
_OWN_HOSTS = ("127.0.0.1", "localhost", "::1", "[::1]")
_TOO_LARGE = 413
_FILES = ("/api/v1/import", "/store")  # take whole files
_audit = logging.getLogger("hilt.audit")


class Doorkeeper:
    """The outermost middleware; counts into a registry of Prometheus."""

    def __init__(
        self, app: ASGIApp, settings: ServiceSettings, registry: CollectorRegistry
    ) -> None:
        self._settings = settings
        hosts = [*_OWN_HOSTS, settings.host, *settings.names]
        self._app = TrustedHostMiddleware(app, hosts, www_redirect=False)
        labels = ("method", "route", "status")
        self._asked = Counter("hilt_requests", "Requests", labels, registry=registry)
        self._took = Histogram("hilt_request_seconds", "Time of requests", registry=registry)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on, or refuse it."""
        if scope["type"] == "lifespan":
            await self._app(scope, receive, send)
            return
        started, status = time.monotonic(), 101

        async def sending(message: Message) -> None:
            nonlocal status
            if message["type"] in {"http.response.start", "websocket.http.response.start"}:
                status = message["status"]
                headers = MutableHeaders(scope=message)
                if status == _TOO_LARGE:  # the rest of the body is not awaited
                    headers["Connection"] = "close"
                for name, value in _HEADERS.items():
                    headers.setdefault(name, value)
            await send(message)

        app: ASGIApp = self._app
        if not self._is_welcome(Headers(scope=scope)):
            app = forbidden("Pages of other sites may not ask here.").answer
        try:
            await app(scope, self._counted(scope, receive), sending)
        finally:
            self._note(scope, status, time.monotonic() - started)

    def _is_welcome(self, headers: Headers) -> bool:
        origin = headers.get("origin")
        is_ours = origin is None or origin.partition("://")[2] == headers.get("host")
        return is_ours or (origin in self._settings.origins and "cookie" not in headers)

    def _counted(self, scope: Scope, receive: Receive) -> Receive:
        settings = self._settings
        most = settings.most_file if scope["path"].startswith(_FILES) else settings.most_body
        left = most

        async def counted() -> Message:
            nonlocal left
            message = await receive()
            left -= len(message.get("body", b""))
            if left < 0:
                detail = f"At most {most} bytes are taken here."
                raise Problem(_TOO_LARGE, "too-large", "Too large", detail)
            return message

        return counted

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        route = getattr(scope.get("route"), "path", "-")
        method, caller = scope.get("method", "WS"), scope.get(CALLER)
        self._asked.labels(method, route, status).inc()
        self._took.observe(seconds)
        who = f"{caller.id} {caller.speaker}" if isinstance(caller, Caller) else "- -"
        _audit.info("%s %s %s %s", who, method, route, status)
