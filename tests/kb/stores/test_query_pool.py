"""Claims about queries of many at once."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Awaitable, Callable
from contextlib import asynccontextmanager
from pathlib import Path

import pytest

from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import functional
from hilt.kb.sparql.results import QueryLimits
from hilt.kb.stores.oxigraph import OxigraphStore
from hilt.kb.stores.query_pool import PROCESSES, QueryPool
from hilt.ontology.errors import BusyError, QueryError

from ..conftest import BLADE, CUTTING, HIGH, teach
from .test_query_subprocess import CROSS, PLENTY, USES

DOCUMENT = {"formats": ("text/csv", "application/json", "text/turtle")}
COUNT = CROSS.replace("*", "(COUNT(*) AS ?n)").partition(" ORDER")[0]  # slow, and of little memory
SAW = functional("saw", "cutting", interval=HIGH)


async def never() -> None:
    """Somebody who waits for ever."""
    await asyncio.Event().wait()


@asynccontextmanager
async def pooled(base: KnowledgeBase) -> AsyncIterator[Callable[..., Awaitable[str]]]:
    """A pool over a base; asks a query, and gives the text of the answer."""
    assert isinstance(base.store, OxigraphStore)
    pool = QueryPool(base.store)

    async def ask(query: str, limits: QueryLimits = PLENTY, gone: Callable = never) -> str:
        _, body, number = await pool.answer(query, DOCUMENT, limits, gone=gone)
        return f"{number}: {' '.join(body.decode().split()[1:])}"

    try:
        yield ask
    finally:
        await pool.close()


def with_pool(
    base: KnowledgeBase, work: Callable[[Callable[..., Awaitable[str]]], Awaitable[None]]
) -> None:
    """Run a test in an event loop."""

    async def run() -> None:
        async with pooled(base) as ask:
            await work(ask)

    asyncio.run(run())


@pytest.fixture(params=["memory", "folder"])
def told(request: pytest.FixtureRequest, tmp_path: Path):
    """A base that knows a little."""
    with KnowledgeBase.open("memory:" if request.param == "memory" else tmp_path / "kb") as kb:
        teach(kb, BLADE, CUTTING)
        yield kb


def test_answers_follow_the_base_by_themselves(told: KnowledgeBase):
    """Each says of when it is; what was written meanwhile is there soon."""

    async def work(ask: Callable[..., Awaitable[str]]) -> None:
        first = await ask(USES)
        await asyncio.to_thread(teach, told, SAW)
        while (last := await ask(USES)) == first:
            await asyncio.sleep(0.01)

        assert first == "2: https://w3id.org/hilt/object/knife"
        assert last.startswith("3: ") and last.endswith("object/saw")

    with_pool(told, work)


def test_only_so_many_queries_take_long(told: KnowledgeBase):
    """One process is for those that do not."""

    async def work(ask: Callable[..., Awaitable[str]]) -> None:
        limits = QueryLimits(seconds=4)
        slow = [ask(COUNT, limits) for _ in range(PROCESSES)]
        ended = await asyncio.gather(*slow, return_exceptions=True)

        assert sum(isinstance(one, BusyError) for one in ended) == 1
        assert sum("longer than 4 s" in str(one) for one in ended) == PROCESSES - 1
        assert "knife" in await ask(USES)

    with_pool(told, work)


def test_more_queries_than_processes_wait_for_their_turn(told: KnowledgeBase):
    """All are answered."""

    async def work(ask: Callable[..., Awaitable[str]]) -> None:
        found = await asyncio.gather(*(ask(USES) for _ in range(10 * PROCESSES)))

        assert len(set(found)) == 1

    with_pool(told, work)


def test_query_ends_when_nobody_waits(told: KnowledgeBase):
    """Long before its time is over."""

    async def leave() -> None:
        await asyncio.sleep(0)

    async def work(ask: Callable[..., Awaitable[str]]) -> None:
        with pytest.raises(QueryError):
            await asyncio.wait_for(ask(CROSS, QueryLimits(seconds=250), leave), 60)

    with_pool(told, work)


@pytest.mark.parametrize(
    ("query", "limits", "message"),
    [
        ("SELECT WHERE", PLENTY, "ends too early"),
        (CROSS, QueryLimits(seconds=0.5), r"longer than 0\.5 s"),
        (CROSS, QueryLimits(seconds=60, megabytes=30), "more than 30 MB"),
        (f"ASK {{ FILTER({'(' * 20_000}1{')' * 20_000}) }}", PLENTY, "nested too deeply"),
    ],
)
def test_query_that_cannot_be_answered_ends_alone(
    told: KnowledgeBase, query: str, limits: QueryLimits, message: str
):
    """It is told why, and the next one is answered."""

    async def work(ask: Callable[..., Awaitable[str]]) -> None:
        with pytest.raises(QueryError, match=message):
            await ask(query, limits)
        assert "knife" in await ask(USES)

    with_pool(told, work)
