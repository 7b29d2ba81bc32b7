"""The server: where it listens, what it says when it is ready, and how it ends."""

from __future__ import annotations

import logging
import secrets
import socket
from collections.abc import Callable
from logging.handlers import RotatingFileHandler
from pathlib import Path
from tempfile import mkdtemp

import uvicorn
from starlette.applications import Starlette

from ...kb.stores.opening import open_store
from ...kb.stores.oxigraph import OxigraphStore
from ...ontology.errors import DataError, StoreError
from ..agent import Agent
from .app import make_app, make_bare_app
from .security import Gate, ServiceSettings, is_loopback
from .service import Service
from .tokens import TokenFile, write_secret

_GRACE_SECONDS = 3  # for connections that stay open after their streams were ended
_AUDIT_BYTES, _AUDIT_FILES = 10 * 2**20, 5


class _Server(uvicorn.Server):
    def __init__(
        self, config: uvicorn.Config, service: Service | None, ready: Callable[[], None]
    ) -> None:
        super().__init__(config)
        self._service, self._ready = service, ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        if self._service:
            await self._service.stop()
        await super().shutdown(sockets)


Ready = Callable[[str, "str | None", int], None]  # takes the URL with the key, the key, the port


def serve(agent: Agent, settings: ServiceSettings, tokens: Path | None, ready: Ready) -> None:
    """Serve an agent until a signal ends it; the agent is closed then.

    DataError if it may not listen there; StoreError if the port is taken.
    """
    gate = Gate(settings, TokenFile(tokens))
    check_place(gate)
    listener, service = _bound(settings), Service(agent, pace=settings.pace)
    folder = tokens.with_suffix(".evaluations") if tokens else Path(mkdtemp(prefix="hilt-"))
    port: int = listener.getsockname()[1]
    app = make_app(service, gate, secret=_cookie_secret(tokens), port=port, folder=folder)
    _keep_audit_log(tokens)
    _run(app, settings, listener, ready, (gate.key, service))


def serve_bare(location: str, settings: ServiceSettings, ready: Ready) -> None:
    """Serve a plain store, without the laws of a base, to whoever asks on this machine.

    Errors are those of `serve`.
    """
    if not is_loopback(settings.host):
        raise DataError("--bare is for this machine only (127.0.0.1).", source=settings.host)
    store, listener = open_store(location), _bound(settings)
    if not isinstance(store, OxigraphStore):
        raise StoreError(f'"{location}" is an endpoint already.')
    _run(make_bare_app(store, settings), settings, listener, ready)


def _run(
    app: Starlette,
    settings: ServiceSettings,
    listener: socket.socket,
    ready: Ready,
    owner: tuple[str | None, Service | None] = (None, None),
) -> None:
    config = uvicorn.Config(
        app,
        ws="websockets-sansio",
        log_config=None,
        access_log=False,  # the address may hold a key; the audit log has all else
        server_header=False,
        proxy_headers=settings.behind_proxy,
        ssl_certfile=settings.certificate,
        ssl_keyfile=settings.key_file,
        timeout_graceful_shutdown=_GRACE_SECONDS,
    )
    port, (key, service) = listener.getsockname()[1], owner
    host = f"[{settings.host}]" if ":" in settings.host else settings.host
    address = f"http{'s' * bool(settings.certificate)}://{host}:{port}/"
    url = f"{address}?key={key}" if key else address
    _Server(config, service, lambda: ready(url, key, port)).run([listener])


def check_place(gate: Gate) -> None:
    """Check that a service may listen there: beyond this machine only with tokens and TLS."""
    settings, where = gate.settings, gate.settings.host
    if is_loopback(where):
        return
    if not settings.needs_key:
        raise DataError("--no-auth is for this machine only (127.0.0.1).", source=where)
    if not gate.tokens.tokens():
        problem = "there are no tokens: hilt token add NAME --speaker NAME --role reader"
        raise DataError(f"others may ask there, but {problem}", source=where)
    if not settings.has_tls:
        problem = "tokens need TLS: --certificate FILE --key FILE, or --behind-proxy."
        raise DataError(problem, source=where)


def tokens_beside(location: str) -> Path | None:
    """The file of the tokens of a base; None for one in memory.

    Those of an endpoint are among the user's own data.
    """
    from platformdirs import user_data_path

    if location == "memory:":
        return None
    if location.startswith(("http://", "https://")):
        return user_data_path("hilt") / "endpoint.tokens.json"
    folder = Path(location).expanduser().absolute()
    return folder.with_name(f"{folder.name}.tokens.json")


def _bound(settings: ServiceSettings) -> socket.socket:
    try:
        family = socket.AF_INET6 if ":" in settings.host else socket.AF_INET
        return socket.create_server((settings.host, settings.port), family=family)
    except OSError as error:
        place = f"{settings.host}:{settings.port}"
        raise StoreError(f"Cannot listen at {place}: {error.strerror}.") from error


def _cookie_secret(tokens: Path | None) -> str:
    """What signs cookies; kept beside the tokens, so that a session outlives the process."""
    if tokens is None:
        return secrets.token_urlsafe(32)
    file = tokens.with_suffix(".cookies")
    if not file.exists():
        file.parent.mkdir(parents=True, exist_ok=True)
        write_secret(file, secrets.token_urlsafe(32).encode())
    return file.read_text(encoding="ascii")


def _keep_audit_log(tokens: Path | None) -> None:
    log = logging.getLogger("hilt.audit")
    log.setLevel(logging.INFO)
    log.propagate = False
    if tokens:
        file = tokens.with_suffix(".audit.log")
        handler = RotatingFileHandler(file, maxBytes=_AUDIT_BYTES, backupCount=_AUDIT_FILES)
        handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
        log.addHandler(handler)
