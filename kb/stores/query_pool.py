"""Queries of many, each in a process of its own that is killed when it exceeds its limits.

The processes read a snapshot of the store, so that nobody waits for a write: while queries come, a
new one is taken in the background soon after a write. As many queries as there
are processes, but one, may take long; a further one is stopped, so that quick ones are answered at
any time. All of it runs in one event loop; requests and answers are those of `query_worker`.
"""

import asyncio
import os
import pickle
from asyncio import StreamReader, StreamWriter, create_subprocess_exec
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import Callable, Coroutine, Mapping
from contextlib import suppress
from typing import Any, TypeAlias, cast

from ...ontology.errors import BusyError
from ..sparql.results import QueryLimits
from .directory import Snapshot
from .oxigraph import OxigraphStore
from .query_subprocess import COMMAND, SIZE_BYTES, checked_answer, exit_error

PROCESSES = 4
LONG_S = 1.0  # from here on a query counts as one that takes long
PAUSE_S = 0.1  # between a write and the next snapshot, which has what else was written until then
MOST_AGE_S = 1.0  # after which a query waits for the next snapshot
_NICE = 19  # priority of a query that takes long
_PIPES: dict[str, Any] = {"stdin": PIPE, "stdout": PIPE, "stderr": DEVNULL}
Gone: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"


class QueryPool:
    """Evaluates queries over snapshots of a store; used in one event loop, and closed there."""

    def __init__(self, store: OxigraphStore) -> None:
        self._store = store
        self._idle = asyncio.LifoQueue[Process | None]()  # None for one that is not started
        for _ in range(PROCESSES):
            self._idle.put_nowait(None)
        self._long = 0  # queries that take long
        self._snapshot: Snapshot | None = None
        self._seen = 0.0  # when it was that of today
        self._renewal: asyncio.Future[Snapshot] | None = None

    def forget_snapshot(self) -> None:
        """Let the next query see everything that was written before, and wait for it."""
        self._snapshot = None

    async def answer(
        self, query: str, document: Mapping[str, object], limits: QueryLimits, *, gone: Gone
    ) -> tuple[str, bytes, int]:
        """The media type and the text of a result, and the number of the last utterance in it.

        `document` has the further arguments of `OxigraphStore.document`. A query may wait for a
        process as long as it may take; one that takes long is stopped when `gone` ends, for nobody
        waits. QueryError if it is wrong, or was stopped, a BusyError if that is due to others;
        StoreError if the store cannot be read.
        """
        snapshot = await self._current()
        request = {"query": query, "document": document, "megabytes": limits.megabytes}
        answer = await self._ask({**request, "source": str(snapshot.path)}, limits, gone)
        return *checked_answer(answer, limits), snapshot.number

    async def close(self) -> None:
        """End the processes, when no query runs any more."""
        self._snapshot = None
        if self._renewal:
            self._renewal.cancel()
        for _ in range(PROCESSES):
            if worker := await self._idle.get():
                await _end(worker)

    async def _ask(self, request: Mapping[str, object], limits: QueryLimits, gone: Gone) -> Any:
        worker = kept = await self._idle_worker(limits)
        asking: asyncio.Future[Any] = asyncio.get_running_loop().create_future()
        try:
            if worker is None:
                worker = await create_subprocess_exec(*COMMAND, **_PIPES)
                await _answer(worker, {**request, "query": "ASK {}"})  # its time does not count
            kept, asking = None, asyncio.ensure_future(_answer(worker, request))
            await asyncio.wait({asking}, timeout=min(LONG_S, limits.seconds))
            if asking.done():
                kept = worker
            else:
                await self._wait_long(asking, worker.pid, limits, gone)
            return asking.result()
        except asyncio.IncompleteReadError:
            kept, code = None, await cast(Process, worker).wait()
            raise exit_error(code, limits, was_stopped=False) from None
        finally:
            self._idle.put_nowait(kept)
            asking.cancel()
            if worker and not kept:
                await _end(worker)

    async def _idle_worker(self, limits: QueryLimits) -> Process | None:
        if not self._idle.empty():
            return self._idle.get_nowait()
        try:
            return await asyncio.wait_for(self._idle.get(), limits.seconds)
        except asyncio.TimeoutError:
            raise BusyError("Too many queries are waiting. Ask again later.") from None

    async def _wait_long(
        self, asking: asyncio.Future[Any], process_id: int, limits: QueryLimits, gone: Gone
    ) -> None:
        if (left_s := limits.seconds - LONG_S) > 0 and self._long >= PROCESSES - 1:
            raise BusyError("Other queries that take long are running. Ask again later.")
        if hasattr(os, "setpriority"):  # for good, so that this process is ended after the query
            with suppress(OSError):
                os.setpriority(os.PRIO_PROCESS, process_id, _NICE)
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

    async def _current(self) -> Snapshot:
        now = asyncio.get_running_loop().time()
        if self._snapshot and self._store.is_current(self._snapshot):
            self._seen = now
        elif self._snapshot is None or now > self._seen + MOST_AGE_S:
            return await self._renew()
        elif self._renewal is None or self._renewal.done():
            self._renewal = asyncio.ensure_future(self._renew(PAUSE_S))
            self._renewal.add_done_callback(lambda done: done.cancelled() or done.exception())
        return self._snapshot

    async def _renew(self, pause_s: float = 0.0) -> Snapshot:
        await asyncio.sleep(pause_s)
        found = await asyncio.to_thread(self._store.snapshot)
        if self._store.is_current(found):
            self._snapshot, self._seen = found, asyncio.get_running_loop().time()
        return found


async def _answer(worker: Process, request: object) -> Any:
    to, answers = cast(StreamWriter, worker.stdin), cast(StreamReader, worker.stdout)
    to.write(pickle.dumps(request))
    size = int.from_bytes(await answers.readexactly(SIZE_BYTES), "big")
    return pickle.loads(await answers.readexactly(size))  # noqa: S301 - of a module of Hilt


async def _end(worker: Process) -> None:
    with suppress(ProcessLookupError):
        worker.kill()
    await worker.communicate()
