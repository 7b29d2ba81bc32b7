"""Queries with limits, run in another process that is killed when they exceed them.

pyoxigraph cannot stop a query, so a query with limits runs in a worker process over a snapshot of
the store, and that process is killed when it takes too long. It is kept for the next query, and
reads a new snapshot when the store has changed. Requests and answers are documented in
`query_worker`.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
from pathlib import Path
from typing import IO, cast

from ...ontology.errors import QueryError, StoreError
from ..sparql.results import (
    BooleanResult,
    ConstructResult,
    QueryLimits,
    QueryResult,
    read_boolean,
    read_solutions,
)

# Kinds of answers.
ROWS, BOOLEAN, TRIPLES, REPORT = "rows", "boolean", "triples", "report"
WRONG_QUERY, FAILED, TOO_LARGE = "wrong query", "failed", "too large"
QUERY_WORKER = f"{__package__}.query_worker"
MAX_SHARE = 4  # an answer takes several times its size here; it may have 1/4 of the memory


class WorkerProcess:
    """A process that answers requests, started when the first one comes."""

    def __init__(self, module: str = QUERY_WORKER) -> None:
        """Prepare a worker that runs a module as a script."""
        self._module = module
        self._process: subprocess.Popen[bytes] | None = None
        self._megabytes = 0
        self._lock = threading.Lock()

    def run(self, source: Path, query: str, limits: QueryLimits) -> QueryResult:
        """The answer of a query over a snapshot, or a file of N-Quads.

        Raises:
            QueryError: it is wrong, or was stopped.
            StoreError: the source cannot be read.
        """
        kind, body = self.request(limits, source=str(source), query=query)
        if kind == ROWS:
            return read_solutions(body)
        if kind == BOOLEAN:
            return BooleanResult(read_boolean(body))
        from .rdf_text import read_triples  # pyoxigraph, only when it is needed

        return ConstructResult.from_quads(read_triples(body, source=str(source)))

    def request(self, limits: QueryLimits, **fields: str | list[str]) -> tuple[str, bytes]:
        """Send a request; the kind of the answer, and its body. Errors as for `run`."""
        line = json.dumps({**fields, "megabytes": limits.megabytes}).encode() + b"\n"
        with self._lock:
            kind, body = self._answer(line, limits)
        if kind == TOO_LARGE:
            raise limits.memory_error()
        if kind in {WRONG_QUERY, FAILED}:
            raise (QueryError if kind == WRONG_QUERY else StoreError)(body.decode())
        return kind, body

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            for pipe in (self._process.stdin, self._process.stdout):
                if pipe:
                    pipe.close()
        self._process = None

    def _answer(self, request: bytes, limits: QueryLimits) -> tuple[str, bytes]:
        """Send a request and read its answer; the process is killed when the time is over."""
        process = self._started(limits)
        stopped = threading.Event()

        def stop() -> None:
            stopped.set()
            process.kill()

        timer = threading.Timer(limits.seconds, stop)
        timer.start()
        try:
            return _exchange(process, request, limits)
        except (EOFError, BrokenPipeError):
            process.wait()
            self.close()
            raise _exit_error(process.returncode, limits, was_stopped=stopped.is_set()) from None
        except BaseException:
            self.close()
            raise
        finally:
            timer.cancel()

    def _started(self, limits: QueryLimits) -> subprocess.Popen[bytes]:
        is_running = self._process is not None and self._process.poll() is None
        if self._process is None or not is_running or self._megabytes != limits.megabytes:
            self.close()
            self._megabytes = limits.megabytes
            self._process = subprocess.Popen(  # noqa: S603 - a module of Hilt
                [sys.executable, "-m", self._module],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )
        return self._process


def _exit_error(code: int, limits: QueryLimits, *, was_stopped: bool) -> QueryError:
    """Why the process ended: its time was over, or the system killed it."""
    if was_stopped:
        return limits.time_error()
    if code == -signal.SIGSEGV:  # pyoxigraph's parser recurses for each bracket
        return QueryError("The query is nested too deeply, and was stopped.")
    return limits.memory_error()


def _exchange(
    process: subprocess.Popen[bytes], request: bytes, limits: QueryLimits
) -> tuple[str, bytes]:
    to, answers = cast("IO[bytes]", process.stdin), cast("IO[bytes]", process.stdout)
    to.write(request)
    to.flush()
    line = answers.readline()
    if not line.endswith(b"\n"):
        raise EOFError
    head = json.loads(line)
    if head["size"] > limits.megabytes * 1_000_000 // MAX_SHARE:
        raise limits.memory_error()
    body = answers.read(head["size"])
    if len(body) < head["size"]:
        raise EOFError
    return head["kind"], body
