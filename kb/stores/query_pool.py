"""Queries of many, each in a process of its own that is killed when it exceeds its limits.

The processes read a snapshot of the store, so that nobody waits for a write: while queries come, a
new one is taken in the background soon after a write. As many queries as there
are processes, but one, may take long; a further one is stopped, so that quick ones are answered at
any time. All of it runs in one event loop; requests and answers are those of `query_worker`.
"""

import asyncio
import os
import pickle
import subprocess
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
Gone: TypeAlias = "Callable[[], Coroutine[Any, Any, None]]"


class QueryPool:
    """Evaluates queries over snapshots of a store; used in one event loop, and closed there."""

    def __init__(self, store: OxigraphStore) -> None:
        self._store = store
        self._idle = asyncio.LifoQueue["_Worker | None"]()  # None for one that is not started
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
                await worker.end()

    async def _ask(self, request: Mapping[str, object], limits: QueryLimits, gone: Gone) -> Any:
        worker = kept = await self._idle_worker(limits)
        try:
            if worker is None:
                start = asyncio.get_running_loop().subprocess_exec
                _, worker = await start(_Worker, *COMMAND, stderr=subprocess.DEVNULL)
                await worker.ask({**request, "query": "ASK {}"})  # its time does not count
            kept, asking = None, worker.ask(request)
            await asyncio.wait({asking}, timeout=min(LONG_S, limits.seconds))
            if asking.done():
                kept = worker
            else:
                await self._wait_long(asking, worker, limits, gone)
            return asking.result()
        except EOFError as error:
            kept = None
            raise exit_error(error.args[0], limits, was_stopped=False) from None
        finally:
            self._idle.put_nowait(kept)
            if worker and not kept:
                await worker.end()

    async def _idle_worker(self, limits: QueryLimits) -> "_Worker | None":
        if not self._idle.empty():
            return self._idle.get_nowait()
        try:
            return await asyncio.wait_for(self._idle.get(), limits.seconds)
        except asyncio.TimeoutError:
            raise BusyError("Too many queries are waiting. Ask again later.") from None

    async def _wait_long(
        self, asking: asyncio.Future[Any], worker: "_Worker", limits: QueryLimits, gone: Gone
    ) -> None:
        left_s = limits.seconds - LONG_S
        if left_s > 0 and self._long >= PROCESSES - 1:
            raise BusyError("Other queries that take long are running. Ask again later.")
        worker.lower_priority()  # for good, so that this process is ended after the query
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


class _Worker(asyncio.SubprocessProtocol):
    """A process that answers one request at a time; an EOFError has the code of its end."""

    def connection_made(self, transport: asyncio.BaseTransport) -> None:
        self._process = cast("asyncio.SubprocessTransport", transport)
        self._to = cast("asyncio.WriteTransport", self._process.get_pipe_transport(0))
        self._over = asyncio.get_running_loop().create_future()

    def ask(self, request: object) -> asyncio.Future[Any]:
        self._got, self._answer = bytearray(), asyncio.get_running_loop().create_future()
        self._to.write(pickle.dumps(request))
        return self._answer

    def pipe_data_received(self, fd: int, data: bytes) -> None:
        self._got += data
        size = int.from_bytes(self._got[:SIZE_BYTES], "big")
        is_whole = len(self._got) > SIZE_BYTES and len(self._got) >= SIZE_BYTES + size
        if is_whole and not self._answer.done():
            found = pickle.loads(self._got[SIZE_BYTES:])  # noqa: S301 - of a module of Hilt
            self._answer.set_result(found)

    def process_exited(self) -> None:
        if not self._answer.done():
            self._answer.set_exception(EOFError(self._process.get_returncode()))

    def connection_lost(self, exc: Exception | None) -> None:
        self._over.set_result(None)

    def lower_priority(self) -> None:
        if hasattr(os, "setpriority"):
            with suppress(OSError):
                os.setpriority(os.PRIO_PROCESS, self._process.get_pid(), _NICE)

    async def end(self) -> None:
        with suppress(ProcessLookupError):
            self._process.kill()
        await self._over
        self._process.close()
