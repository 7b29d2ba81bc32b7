"""The server: its applications, where it listens, what it says when it is ready, how it ends."""

import asyncio
import logging
import secrets
import socket
import sys
from collections.abc import AsyncGenerator, Callable
from contextlib import AbstractAsyncContextManager, asynccontextmanager, nullcontext
from functools import partial
from importlib.metadata import version
from importlib.util import find_spec
from logging.handlers import RotatingFileHandler
from pathlib import Path
from tempfile import mkdtemp

import uvicorn
from anyio import to_thread
from fastapi import APIRouter, FastAPI, Request
from fastapi.staticfiles import StaticFiles
from prometheus_client import CollectorRegistry, Gauge, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from starlette.applications import Starlette
from starlette.middleware.cors import CORSMiddleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.middleware.sessions import SessionMiddleware
from starlette.responses import FileResponse, PlainTextResponse, RedirectResponse, Response

from ...kb.sparql.query_text import errors_as_typed
from ...kb.sparql_update import update as update_base
from ...kb.stores.opening import open_store
from ...kb.stores.oxigraph import OxigraphStore
from ...kb.stores.query_pool import QueryPool
from ...kb.stores.write_lease import WRITERS
from ...ontology.disk_cache import write_atomically
from ...ontology.errors import DataError, StoreError
from ..agent import Agent
from ..execution.outcome import Json
from . import evaluations, routes, streams
from .evaluations import Evaluations
from .problems import HANDLERS, RESPONSES, Problem
from .security import Doorkeeper, Gate, ServiceSettings, address_of, check_role, is_loopback
from .service import Service
from .sparql import LIMITS, SparqlEndpoint
from .tokens import OWNER_ONLY, TokenFile

STATIC = Path(__file__).resolve().with_name("static")  # served from where it is, not by links
READERS = 4  # threads
_OWNED = "This base has an owner, which alone writes to it. Tell it what is new, at /api/v1/tell."
_NO_PAGE = 'The page is not built. Run "make page" in the checkout.\n'
SWITCH_S = 0.001  # after which the thread of the robot gives way to an answer
_GRACE_SECONDS = 3  # for connections that stay open after their streams were ended
_AUDIT_BYTES, _AUDIT_FILES = 10 * 2**20, 5
_health = APIRouter(tags=["health"])


def make_app(service: Service, gate: Gate, *, secret: str, port: int, folder: Path) -> FastAPI:
    """Return the application of a service; its lifespan closes the service.

    Cookies are signed with the secret; they are known by the port, which browsers do not heed.
    Evaluations are kept in the folder.
    """

    @asynccontextmanager
    async def lifespan(_: FastAPI) -> AsyncGenerator[None]:
        to_thread.current_default_thread_limiter().total_tokens = READERS
        shown = asyncio.ensure_future(service.run(service.show_scene))
        async with models:
            yield
        await app.state.evaluations.stop()
        await service.stop()
        await asyncio.wait([shown])
        if sparql:
            await sparql.pool.close()
        await service.close()

    registry = CollectorRegistry()
    app = FastAPI(
        title="Hilt",
        responses=RESPONSES,
        exception_handlers=HANDLERS,
        version=version("hilt"),
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
    )
    app.state.service, app.state.gate, app.state.registry = service, gate, registry
    app.state.evaluations = Evaluations(folder, service.hub)
    sparql = _base_endpoint(service, gate)
    app.router.routes.extend(sparql.routes if sparql else [])  # first, for they are asked the most
    own = (routes.talk, routes.knowledge, evaluations.router, routes.administration)
    for router in (*own, streams.router, _health):
        app.include_router(router)
    models: AbstractAsyncContextManager[None] = nullcontext()
    if find_spec("mcp"):
        from .mcp_server import add_endpoint

        models = add_endpoint(app, service, gate)
    for name, told, read in (
        ("hilt_utterances", "Utterances in the history", lambda: service.base.sequence),
        ("hilt_waiting", "Utterances that wait to be heard", lambda: service.waiting),
        ("hilt_streams", "Readers of events", lambda: service.hub.readers),
    ):
        Gauge(name, told, registry=registry).set_function(read)
    _add_doors(app, gate.settings, registry, secret, port)
    if STATIC.exists():
        app.mount("/static", GZipMiddleware(StaticFiles(directory=STATIC)), name="static")
    return app


def _add_doors(
    app: FastAPI, settings: ServiceSettings, registry: CollectorRegistry, secret: str, port: int
) -> None:
    if settings.origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=settings.origins,
            allow_methods=["*"],
            allow_headers=["Authorization", "Content-Type", "Idempotency-Key", "Prefer"],
        )
    app.add_middleware(
        SessionMiddleware,
        secret_key=secret,
        session_cookie=f"hilt_{port}",
        same_site="strict",
        https_only=settings.has_tls,
    )
    app.add_middleware(Doorkeeper, settings=settings, metrics=registry)


def _base_endpoint(service: Service, gate: Gate) -> SparqlEndpoint | None:
    """SPARQL over a base: readers query it, admins change it as `hilt update` does."""
    base = service.base
    if not isinstance(base.store, OxigraphStore):
        return None

    def admit(request: Request, is_write: bool) -> str:
        caller = gate.caller_of(request, cookies=not is_write)
        check_role(caller, "admin" if is_write else "reader")
        return caller.speaker

    async def update(text: str, _: str, speaker: str) -> None:
        if WRITERS in text:  # another process of Hilt, which takes this for an endpoint
            raise Problem(409, "owned", "Has an owner", _OWNED)
        await service.run(partial(update_base, base, text, speaker=speaker, limits=LIMITS))
        service.agent.dialogue.conversation.expect_news()

    return SparqlEndpoint(base.store, QueryPool(base.store), admit, update, "/#ask")


def make_bare_app(store: OxigraphStore, settings: ServiceSettings) -> Starlette:
    """Return the application of a plain store, which is closed with it; who asks may do all."""

    async def update(text: str, base: str, _: str) -> None:
        sent = f"BASE <{base}> {text}"
        with errors_as_typed(text, sent):
            await asyncio.to_thread(store.update, sent)

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncGenerator[None]:
        yield
        await sparql.pool.close()
        store.close()

    sparql = SparqlEndpoint(store, QueryPool(store), lambda _, __: settings.speaker, update)
    app = Starlette(routes=sparql.routes, lifespan=lifespan, exception_handlers=HANDLERS)
    app.add_middleware(Doorkeeper, settings=settings, metrics=CollectorRegistry())
    return app


@_health.get("/healthz")
async def healthz() -> Json:
    """Whether the service is alive."""
    return {"alive": True}


@_health.get("/readyz")
def readyz(service: routes.TheService) -> Json:
    """Whether the base is open, and the robot able to move."""
    if service.is_stopping:
        raise Problem(503, "stopping", "Stopping", "The service ends.")
    return {"ready": True, "sequence": service.base.sequence, "moves": service.agent.simulate}


@_health.get("/metrics", response_class=PlainTextResponse)
async def metrics(request: Request) -> Response:
    """Counts and times, for Prometheus; readers and this machine may see them."""
    if not is_loopback(address_of(request)):
        request.app.state.gate.caller_of(request)
    return Response(generate_latest(request.app.state.registry), media_type=CONTENT_TYPE_LATEST)


@_health.get("/", include_in_schema=False)
async def page(request: Request, key: str | None = None) -> Response:
    """The page; a key in the address is exchanged for a cookie, and taken out of it."""
    if key is not None:
        request.app.state.gate.begin_session(request, key, tokens=False)
        return RedirectResponse("/", 303)
    return _built("index.html")


@_health.get("/docs", include_in_schema=False)
async def docs() -> Response:
    """The interface, to read and to try."""
    return _built("docs.html")


def _built(name: str) -> Response:
    file = STATIC / name
    headers = {"Cache-Control": "no-cache"}
    return FileResponse(file, headers=headers) if file.exists() else PlainTextResponse(_NO_PAGE)


Ready = Callable[[str, "str | None", int], None]  # takes the URL with the key, the key, the port


def serve(agent: Agent, settings: ServiceSettings, tokens: Path | None, ready: Ready) -> None:
    """Serve an agent until a signal ends it; the agent is closed then.

    DataError if it may not listen there; StoreError if the port is taken.
    """
    sys.setswitchinterval(SWITCH_S)
    gate = Gate(settings, TokenFile(tokens))
    check_place(gate)
    listener, service = _bound(settings), Service(agent, pace=settings.pace)
    folder = tokens.with_suffix(".evaluations") if tokens else Path(mkdtemp(prefix="hilt-"))
    port: int = listener.getsockname()[1]
    app = make_app(service, gate, secret=_cookie_secret(tokens), port=port, folder=folder)
    log = logging.getLogger("hilt.audit")
    log.setLevel(logging.INFO)
    log.propagate = False
    if tokens:
        file = tokens.with_suffix(".audit.log")
        handler = RotatingFileHandler(file, maxBytes=_AUDIT_BYTES, backupCount=_AUDIT_FILES)
        handler.setFormatter(logging.Formatter("%(asctime)s %(message)s"))
        log.addHandler(handler)
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

    class Server(uvicorn.Server):
        async def startup(self, sockets: list[socket.socket] | None = None) -> None:
            await super().startup(sockets)
            ready(url, key, port)

        async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
            if service:
                await service.stop()
            await super().shutdown(sockets)

    Server(config).run([listener])


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
    if not (file := tokens.with_suffix(".cookies")).exists():
        write_atomically(file, secrets.token_urlsafe(32), mode=OWNER_ONLY)
    return file.read_text(encoding="ascii")
