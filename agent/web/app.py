"""The application: the JSON interface, the page, health and metrics, behind one door."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator
from contextlib import AbstractAsyncContextManager, asynccontextmanager, nullcontext
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from anyio import to_thread
from fastapi import APIRouter, FastAPI, Request
from fastapi.staticfiles import StaticFiles
from prometheus_client import CollectorRegistry, Gauge, generate_latest
from prometheus_client.exposition import CONTENT_TYPE_LATEST
from starlette.middleware.cors import CORSMiddleware
from starlette.middleware.gzip import GZipMiddleware
from starlette.middleware.sessions import SessionMiddleware
from starlette.responses import FileResponse, PlainTextResponse, RedirectResponse, Response

from ..execution.outcome import Json
from .doorkeeper import Doorkeeper
from .problems import RESPONSES, Problem, answer_with_problems
from .routes import administration, conversation, evaluations, knowledge, robot, session, streams
from .routes.evaluations import Evaluations
from .security import Gate, address_of, is_loopback
from .service import Service
from .sparql_targets import base_target, sparql_routes

STATIC = Path(__file__).resolve().with_name("static")  # served from where it is, not by links
READERS = 4  # threads
_NO_PAGE = 'The page is not built. Run "make page" in the checkout.\n'
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
        if target:
            await target.pool.close()
        await service.close()

    registry = CollectorRegistry()
    app = FastAPI(
        title="Hilt",
        responses=RESPONSES,
        version=version("hilt"),
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
    )
    app.state.service, app.state.gate, app.state.registry = service, gate, registry
    app.state.evaluations = Evaluations(folder, service.hub)
    routes = (conversation, knowledge, robot, streams, session, evaluations, administration)
    for each in routes:
        app.include_router(each.router)
    app.include_router(_health)
    target = base_target(service, gate)
    app.router.routes.extend(sparql_routes(target) if target else [])
    models: AbstractAsyncContextManager[None] = nullcontext()
    if find_spec("mcp"):
        from .mcp_server import add_endpoint

        models = add_endpoint(app, service, gate)
    _count(service, registry)
    answer_with_problems(app)
    if gate.settings.origins:
        app.add_middleware(
            CORSMiddleware,
            allow_origins=gate.settings.origins,
            allow_methods=["*"],
            allow_headers=["Authorization", "Content-Type", "Idempotency-Key", "Prefer"],
        )
    app.add_middleware(
        SessionMiddleware,
        secret_key=secret,
        session_cookie=f"hilt_{port}",
        same_site="strict",
        https_only=gate.settings.has_tls,
    )
    app.add_middleware(Doorkeeper, settings=gate.settings, registry=registry)
    if STATIC.exists():
        app.mount("/static", GZipMiddleware(StaticFiles(directory=STATIC)), name="static")
    return app


def _count(service: Service, registry: CollectorRegistry) -> None:
    for name, told, read in (
        ("hilt_utterances", "Utterances in the history", lambda: service.base.sequence),
        ("hilt_waiting", "Utterances that wait to be heard", lambda: service.waiting),
        ("hilt_streams", "Readers of events", lambda: service.hub.readers),
    ):
        Gauge(name, told, registry=registry).set_function(read)


@_health.get("/healthz")
async def healthz() -> Json:
    """Whether the service is alive."""
    return {"alive": True}


@_health.get("/readyz")
def readyz(request: Request) -> Json:
    """Whether the base is open, and the robot able to move."""
    service: Service = request.app.state.service
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
