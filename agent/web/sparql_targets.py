"""What the SPARQL routes read and write: a base under its laws, or a plain store."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager
from functools import partial

from prometheus_client import CollectorRegistry
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.routing import Route

from ...kb.sparql.query_text import errors_as_typed
from ...kb.sparql_update import update as update_base
from ...kb.stores.oxigraph import OxigraphStore
from ...kb.stores.query_pool import QueryPool
from ...kb.stores.write_lease import WRITERS
from .doorkeeper import Doorkeeper
from .graph_store import GraphStore
from .problems import Problem, answer_with_problems
from .security import Gate, ServiceSettings, check_role
from .service import Service
from .sparql_protocol import LIMITS, SparqlProtocol, SparqlTarget

_PAGE = "/#ask"
_OWNED = "This base has an owner, which alone writes to it. Tell it what is new, at /api/v1/tell."


def sparql_routes(target: SparqlTarget) -> list[Route]:
    """Return the routes of the SPARQL 1.1 Protocol and the Graph Store Protocol."""
    return [*SparqlProtocol(target).routes, *GraphStore(target).routes]


def base_target(service: Service, gate: Gate) -> SparqlTarget | None:
    """The base of a service: readers query it, admins change it as `hilt update` does.

    Its pool is to be closed before the base. None for a base that has an endpoint of its own.
    """
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

    return SparqlTarget(base.store, QueryPool(base.store), admit, update, _PAGE)


def bare_app(store: OxigraphStore, settings: ServiceSettings) -> Starlette:
    """Return the application of a plain store, which is closed with it; who asks may do all."""

    async def update(text: str, base: str, _: str) -> None:
        sent = f"BASE <{base}> {text}"
        with errors_as_typed(text, sent):
            await asyncio.to_thread(store.update, sent)

    def admit(_: Request, __: bool) -> str:
        return settings.speaker

    @asynccontextmanager
    async def lifespan(_: Starlette) -> AsyncGenerator[None]:
        yield
        await target.pool.close()
        store.close()

    target = SparqlTarget(store, QueryPool(store), admit, update)
    app = Starlette(routes=sparql_routes(target), lifespan=lifespan)
    answer_with_problems(app)
    app.add_middleware(Doorkeeper, settings=settings, registry=CollectorRegistry())
    return app
