"""Queries with limits, run in another process that is killed when they exceed them.

pyoxigraph cannot stop a query, so one with limits runs in a worker process (`query_worker`) over a
snapshot of the store, and that process is killed when it takes too long. It is kept for the next
query, and reads a new snapshot when the store has changed.
"""

import pickle
import signal
import subprocess
import sys
import threading
import time
from typing import IO, Any, cast

from ...ontology.errors import HiltError, QueryError
from ..sparql.results import QueryLimits

COMMAND = (sys.executable, "-m", f"{__package__}.query_worker")
SIZE_BYTES = 8  # of the size before an answer


class WorkerProcess:
    """A process that answers requests, started when the first one comes."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._megabytes = 0
        self._lock = threading.Lock()

    def request(self, limits: QueryLimits, **fields: object) -> Any:
        """Send a request, and return the answer, as of a `query` over a snapshot, the `source`.

        QueryError if it is wrong, or was stopped; StoreError if the source cannot be read.
        """
        with self._lock:
            answer = self._answer({**fields, "megabytes": limits.megabytes}, limits)
        return checked_answer(answer, limits)

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
        self._process = None

    def _answer(self, request: dict[str, object], limits: QueryLimits) -> object:
        process, end = self._started(limits), time.monotonic() + limits.seconds
        to, answers = cast("IO[bytes]", process.stdin), cast("IO[bytes]", process.stdout)
        timer = threading.Timer(limits.seconds, process.kill)
        timer.start()
        try:
            pickle.dump(request, to)
            to.flush()
            size = int.from_bytes(answers.read(SIZE_BYTES), "big")
            return pickle.loads(answers.read(size))  # noqa: S301 - of a module of Hilt
        except (EOFError, BrokenPipeError, pickle.UnpicklingError):
            code, was_stopped = process.wait(), time.monotonic() >= end
            self.close()
            raise exit_error(code, limits, was_stopped=was_stopped) from None
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
                COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL
            )
        return self._process


def checked_answer(answer: Any, limits: QueryLimits) -> Any:
    """The answer of a process; raises it if it is an error."""
    if isinstance(answer, MemoryError):
        raise limits.memory_error()
    if isinstance(answer, HiltError):
        raise answer
    return answer


def exit_error(code: int, limits: QueryLimits, *, was_stopped: bool) -> QueryError:
    """The error of a process that ended with a code before it answered."""
    if was_stopped:
        return limits.time_error()
    if code == -signal.SIGSEGV:  # pyoxigraph's parser recurses for each bracket
        return QueryError("The query is nested too deeply, and was stopped.")
    return limits.memory_error()
