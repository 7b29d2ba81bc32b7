"""Queries of many, each in a process of its own that is killed when it exceeds its limits.

The processes read a snapshot of the store, so that nobody waits for a write. While queries come, a
new snapshot is taken in the background some time after the last write. As many queries as there
are processes, but one, may take long; a further one is stopped, so that quick ones are answered at
any time. All of it runs in one event loop; pickled requests and answers are those of
`query_worker`.
"""

from __future__ import annotations

import asyncio
import os
import pickle
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import Awaitable, Callable, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Any, TypeAlias, cast

from ...ontology.errors import HiltError, QueryLimitError
from ..sparql.results import QueryLimits
from .directory import Snapshot
from .oxigraph import OxigraphStore
from .query_subprocess import COMMAND, SIZE_BYTES, exit_error

PROCESSES = 4
LONG_S = 1.0  # from here on a query counts as one that takes long
PAUSE_S, MOST_PAUSES = 0.1, 20  # without a write before the next snapshot; then it is taken anyway
IN_USE_S = 60.0  # after the last query snapshots are taken no more until the next one
_NICE = 10  # priority of a query that takes long
_BUFFER = 2**20  # bytes
Gone: TypeAlias = "Callable[[], Awaitable[object]] | None"


class BusyError(QueryLimitError):
    """As many queries that take long run as may; the same one may be asked again later."""


@dataclass(frozen=True)
class PooledQuery:
    """A query, and what `OxigraphStore.document` besides needs to answer it."""

    text: str
    formats: Sequence[str | None]
    base: str | None = None
    dataset: tuple[Sequence[str], Sequence[str]] | None = None
    is_union: bool = True


@dataclass(frozen=True)
class QueryDocument:
    """The result of a query in UTF-8, its media type (empty if it has none that is accepted).

    `as_of` is the number of the last utterance that it may speak of.
    """

    media_type: str
    body: bytes
    as_of: int


class QueryPool:
    """Evaluates queries over snapshots of a store; to be used in one event loop, and closed."""

    def __init__(self, store: OxigraphStore, *, processes: int = PROCESSES) -> None:
        self._store, self._processes = store, processes
        self._workers = [_Worker() for _ in range(processes)]
        self._idle = asyncio.LifoQueue["_Worker"]()
        for worker in self._workers:
            self._idle.put_nowait(worker)
        self._snapshot: Snapshot | None = None
        self._changes, self._is_stale, self._used = 0, True, 0.0
        self._renewing = asyncio.Lock()
        self._renewal: asyncio.Future[None] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self.long = 0  # queries that take long
        store.watchers.append(self._note_change)

    @property
    def has_room(self) -> bool:
        """Whether a further query may take long."""
        return self.long < self._processes - 1

    def forget_snapshot(self) -> None:
        """Let the next query see everything that was written before, and wait for it."""
        self._snapshot = None

    async def answer(
        self,
        query: PooledQuery,
        limits: QueryLimits,
        *,
        is_fresh: bool = False,
        gone: Gone = None,
    ) -> QueryDocument:
        """The result of a query.

        Args:
            query: what is asked.
            limits: its time, in which it waits for a process too, and its memory.
            is_fresh: whether it sees all that was written until now.
            gone: ends when nobody waits for the answer any more; a long query is stopped then.

        Raises:
            QueryError: the query is wrong, or was stopped; a BusyError if that is due to others.
            StoreError: the store cannot be read.
        """
        self._loop = asyncio.get_running_loop()
        self._used = self._loop.time()
        snapshot = await self._current(is_fresh=is_fresh)
        document = {name: value for name, value in vars(query).items() if name != "text"}
        request = {"query": query.text, "document": document, "source": snapshot.path}
        request |= {"megabytes": limits.megabytes}
        try:
            worker = await asyncio.wait_for(self._idle.get(), limits.seconds)
        except asyncio.TimeoutError:
            raise BusyError("Too many queries are waiting. Ask again later.") from None
        try:
            watch = _Watch(self, await worker.started(), limits, gone)
            found = await self._asked(watch, worker, request, limits)
        finally:
            self._idle.put_nowait(worker)
        return QueryDocument(*found, snapshot.number)

    async def _asked(
        self, watch: _Watch, worker: _Worker, request: object, limits: QueryLimits
    ) -> tuple[str, bytes]:
        try:
            answer = await watch.ask(request)
        except BaseException as error:
            code = await worker.ended()
            if isinstance(error, (asyncio.IncompleteReadError, ConnectionError)):
                raise watch.reason or exit_error(code, limits, was_stopped=False) from None
            raise
        if watch.is_long:  # its priority cannot be raised again
            await worker.ended()
        if isinstance(answer, MemoryError):
            raise limits.memory_error()
        if isinstance(answer, HiltError):
            raise answer
        return answer

    async def close(self) -> None:
        """End the processes."""
        self._store.watchers.remove(self._note_change)
        self._loop = None
        if self._renewal:
            self._renewal.cancel()
        for worker in self._workers:
            await worker.ended()
        self._snapshot = None

    async def _current(self, *, is_fresh: bool) -> Snapshot:
        if self._snapshot is None or (is_fresh and self._is_stale):
            await self._renew()
        return cast(Snapshot, self._snapshot)

    async def _renew(self) -> None:
        async with self._renewing:
            if self._is_stale or self._snapshot is None:
                self._is_stale = False  # what is written from here on makes it so again
                self._snapshot = await asyncio.to_thread(self._store.snapshot)

    def _note_change(self) -> None:
        self._changes, self._is_stale = self._changes + 1, True
        if self._loop is not None:
            with suppress(RuntimeError):  # the loop has ended
                self._loop.call_soon_threadsafe(self._plan_renewal)

    def _plan_renewal(self) -> None:
        is_used = self._loop is not None and self._loop.time() < self._used + IN_USE_S
        if is_used and (self._renewal is None or self._renewal.done()):
            self._renewal = asyncio.ensure_future(self._renew_after_pause())

    async def _renew_after_pause(self) -> None:
        for _ in range(MOST_PAUSES):
            seen = self._changes
            await asyncio.sleep(PAUSE_S)
            if seen == self._changes:
                break
        with suppress(HiltError):  # who asks next is told
            await self._renew()


class _Worker:
    """A process, started when the first request comes, and again when it was killed."""

    def __init__(self) -> None:
        self._process: Process | None = None
        self._starting = asyncio.Lock()

    async def started(self) -> Process:
        async with self._starting:
            if self._process is None:
                self._process = await asyncio.create_subprocess_exec(
                    *COMMAND, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=_BUFFER
                )
            return self._process

    async def ended(self) -> int:
        """Kill the process, and return the code with which it ended."""
        process, self._process = self._process, None
        if process is None:
            return 0
        _kill(process)
        return await process.wait()


class _Watch:
    """Asks one query, and ends it when its time is over or nobody waits for it."""

    def __init__(self, pool: QueryPool, process: Process, limits: QueryLimits, gone: Gone) -> None:
        self._pool, self._process, self._limits, self._gone = pool, process, limits, gone
        self._leaving: asyncio.Future[object] | None = None
        self.reason: HiltError | None = None  # why the process was killed
        self.is_long = False

    async def ask(self, request: object) -> Any:
        first_s, loop = min(LONG_S, self._limits.seconds), asyncio.get_running_loop()
        self._timer = loop.call_later(first_s, self._go_on, self._limits.seconds - first_s)
        to = cast(asyncio.StreamWriter, self._process.stdin)
        answers = cast(asyncio.StreamReader, self._process.stdout)
        try:
            to.write(pickle.dumps(request))
            size = int.from_bytes(await answers.readexactly(SIZE_BYTES), "big")
            return pickle.loads(await answers.readexactly(size))  # noqa: S301 - of a module of Hilt
        finally:
            self._timer.cancel()
            self._pool.long -= self.is_long
            if self._leaving:
                self._leaving.cancel()

    def _go_on(self, left_s: float) -> None:
        if not left_s:
            self._stop(self._limits.time_error())
        elif not self._pool.has_room:
            self._stop(BusyError("Other queries that take long are running. Ask again later."))
        else:
            self.is_long = True
            self._pool.long += 1
            loop = asyncio.get_running_loop()
            self._timer = loop.call_later(left_s, self._stop, self._limits.time_error())
            if hasattr(os, "setpriority"):
                os.setpriority(os.PRIO_PROCESS, self._process.pid, _NICE)
            if self._gone:
                self._leaving = asyncio.ensure_future(self._gone())
                self._leaving.add_done_callback(self._leave)

    def _leave(self, leaving: asyncio.Future[object]) -> None:
        if not leaving.cancelled():
            self._stop(BusyError("Nobody waits for the answer."))

    def _stop(self, reason: HiltError) -> None:
        self.reason = reason
        _kill(self._process)


def _kill(process: Process) -> None:
    with suppress(ProcessLookupError):
        process.kill()
