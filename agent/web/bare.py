"""A plain store over HTTP, without the laws of a base: the SPARQL protocols and nothing else."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager

from prometheus_client import CollectorRegistry
from starlette.applications import Starlette

from ...kb.sparql.query_text import errors_as_typed
from ...kb.stores.oxigraph import OxigraphStore
from ...kb.stores.query_pool import QueryPool
from .doorkeeper import Doorkeeper
from .graph_store import GraphStore
from .problems import answer_with_problems
from .security import ServiceSettings
from .sparql_protocol import SparqlProtocol, SparqlTarget


def make_bare_app(store: OxigraphStore, settings: ServiceSettings) -> Starlette:
    """Return the application of a store, which is closed with it; everybody may do everything."""
    pool = QueryPool(store)

    def change(text: str, base: str) -> None:
        sent = f"BASE <{base}> {text}"
        with errors_as_typed(text, sent):
            store.update(sent)

    async def update(text: str, base: str, _: str) -> None:
        await asyncio.to_thread(change, text, base)

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncGenerator[None]:
        yield
        await pool.close()
        store.close()

    target = SparqlTarget(store, pool, lambda *_: "", update)
    routes = [*SparqlProtocol(target).routes(), *GraphStore(target).routes()]
    app = Starlette(routes=routes, lifespan=lifespan)
    answer_with_problems(app)
    app.add_middleware(Doorkeeper, settings=settings, registry=CollectorRegistry())
    return app
