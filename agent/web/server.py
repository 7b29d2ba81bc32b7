"""The server: where it listens, what it says when it is ready, and how it ends."""

from __future__ import annotations

import logging
import secrets
import socket
from collections.abc import Callable
from dataclasses import dataclass, replace
from logging.handlers import RotatingFileHandler
from pathlib import Path

import uvicorn

from ...ontology.errors import DataError, StoreError
from ..agent import Agent
from .app import make_app
from .security import Gate, ServiceSettings, is_loopback
from .service import Service
from .tokens import TokenFile

_GRACE_SECONDS = 3  # for connections that stay open after their streams were ended
_AUDIT_BYTES, _AUDIT_FILES = 10 * 2**20, 5


@dataclass(frozen=True)
class ServerOptions:
    """Where and for whom a server listens.

    Attributes:
        port: 0 for a free one.
        names: further host names by which it is reached.
        certificate, key_file: of TLS, in PEM.
        behind_proxy: whether a proxy on this machine or its network does TLS.
        needs_key: whether the owner shows a one-time key.
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
    rate: float = 10.0


@dataclass(frozen=True)
class Listening:
    """What a server says when it is ready; the URL has the key."""

    url: str
    key: str | None
    port: int


class _Server(uvicorn.Server):
    def __init__(self, config: uvicorn.Config, service: Service, ready: Callable[[], None]) -> None:
        super().__init__(config)
        self._service, self._ready = service, ready

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        await super().startup(sockets)
        self._ready()

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        await self._service.stop()
        await super().shutdown(sockets)


def serve(
    agent: Agent, options: ServerOptions, tokens: Path | None, ready: Callable[[Listening], None]
) -> None:
    """Serve an agent until a signal ends it; the agent is closed then.

    DataError if it may not listen there; StoreError if the port is taken.
    """
    gate = Gate(make_settings(options), TokenFile(tokens))
    check_place(options, gate.tokens)
    listener = _bound(options)
    port: int = listener.getsockname()[1]
    scheme = "https" if options.certificate else "http"
    host = f"[{options.host}]" if ":" in options.host else options.host
    query = f"?key={gate.key}" if gate.key else ""
    listening = Listening(f"{scheme}://{host}:{port}/{query}", gate.key, port)
    gate.settings = replace(gate.settings, cookie=f"hilt_{port}")
    service = Service(agent)
    config = uvicorn.Config(
        make_app(service, gate),
        ws="websockets-sansio",
        log_config=None,
        access_log=False,  # the address may hold a key; the audit log has all else
        server_header=False,
        proxy_headers=options.behind_proxy,
        ssl_certfile=options.certificate,
        ssl_keyfile=options.key_file,
        timeout_graceful_shutdown=_GRACE_SECONDS,
    )
    _keep_audit_log(tokens)
    _Server(config, service, lambda: ready(listening)).run([listener])


def make_settings(options: ServerOptions) -> ServiceSettings:
    """What a service allows by these options."""
    return ServiceSettings(
        hosts=ServiceSettings.hosts | {options.host, *options.names},
        speaker=options.speaker,
        key=secrets.token_urlsafe(24) if options.needs_key else None,
        origins=frozenset(options.origins),
        rate=options.rate,
        secure=bool(options.certificate) or options.behind_proxy,
    )


def check_place(options: ServerOptions, tokens: TokenFile) -> None:
    """Check that a server may listen there: beyond this machine only with tokens and TLS."""
    if is_loopback(options.host):
        return
    if not options.needs_key:
        raise DataError("--no-auth is for this machine only (127.0.0.1).", source=options.host)
    if not tokens.tokens():
        problem = "there are no tokens: hilt token add NAME --speaker NAME --role reader"
        raise DataError(f"others may ask there, but {problem}", source=options.host)
    if not (options.certificate or options.behind_proxy):
        problem = "tokens need TLS: --certificate FILE --key FILE, or --behind-proxy."
        raise DataError(problem, source=options.host)


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


def _bound(options: ServerOptions) -> socket.socket:
    try:
        address = socket.getaddrinfo(options.host, options.port, type=socket.SOCK_STREAM)[0]
        listener = socket.socket(address[0], socket.SOCK_STREAM)
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind(address[4])
    except OSError as error:
        place = f"{options.host}:{options.port}"
        raise StoreError(f"Cannot listen at {place}: {error.strerror}.") from error
    return listener


def _keep_audit_log(tokens: Path | None) -> None:
    log = logging.getLogger("hilt.audit")
    log.setLevel(logging.INFO)
    if tokens:
        name = tokens.name.replace(".tokens.json", ".audit.log")
        tokens.parent.mkdir(parents=True, exist_ok=True)
        handler = RotatingFileHandler(
            tokens.with_name(name), maxBytes=_AUDIT_BYTES, backupCount=_AUDIT_FILES
        )
        handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
        log.addHandler(handler)
