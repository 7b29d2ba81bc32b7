"""Queries of many, each in a process of its own that is killed when it exceeds its limits.

The processes read a snapshot of the store, so that nobody waits for a write. While queries come, a
new snapshot is taken in the background soon after a write. As many queries as there
are processes, but one, may take long; a further one is stopped, so that quick ones are answered at
any time. All of it runs in one event loop; requests and answers are those of `query_worker`.
"""

from __future__ import annotations

import asyncio
import os
import pickle
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import Callable, Coroutine, Mapping
from contextlib import suppress
from typing import Any, TypeAlias, cast

from ...ontology.errors import BusyError, HiltError
from ..sparql.results import QueryLimits
from .directory import Snapshot
from .oxigraph import OxigraphStore
from .query_subprocess import COMMAND, SIZE_BYTES, exit_error

PROCESSES = 4
LONG_S = 1.0  # from here on a query counts as one that takes long
PAUSE_S = 0.1  # between a write and the next snapshot, which has what else was written until then
IN_USE_S = 60.0  # after the last query; then a snapshot waits for the next one
_NICE = 10  # priority of a query that takes long
_BUFFER = 2**20  # bytes
Gone: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"


class QueryPool:
    """Evaluates queries over snapshots of a store; used in one event loop, and closed there."""

    def __init__(self, store: OxigraphStore) -> None:
        self._store = store
        self._workers = [_Worker() for _ in range(PROCESSES)]
        self._idle = asyncio.LifoQueue["_Worker"]()
        for worker in self._workers:
            self._idle.put_nowait(worker)
        self._long = 0  # queries that take long
        self._snapshot: Snapshot | None = None
        self._is_stale, self._forgotten, self._used = False, 0, 0.0
        self._renewal: asyncio.Future[None] | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        store.watchers.append(self._note_change)

    def forget_snapshot(self) -> None:
        """Let the next query see everything that was written before, and wait for it."""
        self._snapshot, self._forgotten = None, self._forgotten + 1

    async def answer(
        self, query: str, document: Mapping[str, object], limits: QueryLimits, *, gone: Gone
    ) -> tuple[str, bytes, int]:
        """The media type and the text of a result, and the number of the last utterance in it.

        Args:
            query: what is asked.
            document: the further arguments of `OxigraphStore.document`.
            limits: its time, as long as it may wait for a process too, and its memory.
            gone: ends when nobody waits for the answer; a query that takes long is stopped then.

        Raises:
            QueryError: the query is wrong, or was stopped; a BusyError if that is due to others.
            StoreError: the store cannot be read.
        """
        self._loop = asyncio.get_running_loop()
        self._used = self._loop.time()
        snapshot = self._snapshot or await self._renew()
        request = {"query": query, "document": document, "source": snapshot.path}
        try:
            worker = await asyncio.wait_for(self._idle.get(), limits.seconds)
        except asyncio.TimeoutError:
            raise BusyError("Too many queries are waiting. Ask again later.") from None
        try:
            answer = await self._ask(worker, request, limits, gone)
        finally:
            self._idle.put_nowait(worker)
        if isinstance(answer, MemoryError):
            raise limits.memory_error()
        if isinstance(answer, HiltError):
            raise answer
        return *answer, snapshot.number

    async def close(self) -> None:
        """End the processes."""
        self._store.watchers.remove(self._note_change)
        self._loop = self._snapshot = None
        if self._renewal:
            self._renewal.cancel()
        for worker in self._workers:
            await worker.end()

    async def _ask(
        self, worker: _Worker, request: Mapping[str, object], limits: QueryLimits, gone: Gone
    ) -> Any:
        request = {**request, "megabytes": limits.megabytes}
        asking: asyncio.Future[Any] | None = None
        try:
            await worker.start({**request, "query": "ASK {}"})  # its time does not count
            asking = asyncio.ensure_future(worker.ask(request))
            await asyncio.wait({asking}, timeout=min(LONG_S, limits.seconds))
            if not asking.done():
                await self._wait_long(asking, worker, limits, gone)
            return asking.result()
        except (asyncio.IncompleteReadError, ConnectionError):
            raise exit_error(await worker.end(), limits, was_stopped=False) from None
        except BaseException:
            if asking:
                asking.cancel()
            await worker.end()
            raise

    async def _wait_long(
        self, asking: asyncio.Future[Any], worker: _Worker, limits: QueryLimits, gone: Gone
    ) -> None:
        left_s = limits.seconds - LONG_S
        if left_s > 0 and self._long >= PROCESSES - 1:
            raise BusyError("Other queries that take long are running. Ask again later.")
        worker.lower_priority()
        leaving = asyncio.ensure_future(gone())
        self._long += 1
        try:
            either = asyncio.FIRST_COMPLETED
            await asyncio.wait({asking, leaving}, timeout=max(0, left_s), return_when=either)
        finally:
            self._long -= 1
            leaving.cancel()
        if not asking.done():
            raise limits.time_error()

    async def _renew(self) -> Snapshot:
        forgotten = self._forgotten
        found = await asyncio.to_thread(self._store.snapshot)
        if forgotten == self._forgotten:
            self._snapshot = found
        return found

    def _note_change(self) -> None:
        if self._loop is not None:
            with suppress(RuntimeError):  # it has ended
                self._loop.call_soon_threadsafe(self._plan_renewal, self._loop)

    def _plan_renewal(self, loop: asyncio.AbstractEventLoop) -> None:
        self._is_stale = True
        is_planned = self._renewal is not None and not self._renewal.done()
        if not is_planned and loop.time() < self._used + IN_USE_S:
            self._renewal = asyncio.ensure_future(self._renew_after_pause())

    async def _renew_after_pause(self) -> None:
        while self._is_stale:
            await asyncio.sleep(PAUSE_S)
            self._is_stale = False  # until the next change, perhaps while this snapshot is taken
            with suppress(HiltError, OSError):  # who asks next is told
                await self._renew()


class _Worker:
    """A process, started when a request comes and there is none."""

    def __init__(self) -> None:
        self._process: Process | None = None
        self._is_low = False

    async def start(self, request: object) -> None:
        if self._process is None or self._is_low:
            await self.end()
            self._process = await asyncio.create_subprocess_exec(
                *COMMAND, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=_BUFFER
            )
            await self.ask(request)

    async def ask(self, request: object) -> Any:
        process = cast(Process, self._process)
        to = cast(asyncio.StreamWriter, process.stdin)
        answers = cast(asyncio.StreamReader, process.stdout)
        to.write(pickle.dumps(request))
        size = int.from_bytes(await answers.readexactly(SIZE_BYTES), "big")
        return pickle.loads(await answers.readexactly(size))  # noqa: S301 - of a module of Hilt

    def lower_priority(self) -> None:
        self._is_low = True  # for good, so that this process is ended after the query
        if self._process and hasattr(os, "setpriority"):
            with suppress(OSError):
                os.setpriority(os.PRIO_PROCESS, self._process.pid, _NICE)

    async def end(self) -> int:
        """Kill the process, and return the code with which it ended."""
        process, self._process, self._is_low = self._process, None, False
        if process is None:
            return 0
        with suppress(ProcessLookupError):
            process.kill()
        return await process.wait()
