# SPDX-License-Identifier: Apache-2.0
"""Queries that are stopped when they take too long or too much memory.

The engine has no way to stop a query, so one that nobody vouches for runs in a process of its own
over a snapshot, and that process is killed (`worker`). It is kept for the next query, and given a
new snapshot when the base has changed.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import IO, TypedDict, cast

from ...ontology.errors import QueryError, StoreError
from . import worker
from .limits import Limits
from .results import BooleanResult, Found, Statements, read_answer, read_solutions

MAX_SHARE = 4  # an answer takes several times its size here; it may have 1/4 of the memory


class Tried(TypedDict):
    """What came of an update to a copy."""

    sequence: int
    findings: list[str]


class Worker:
    """One process that answers queries, started when the first one comes."""

    def __init__(self) -> None:
        self._process: subprocess.Popen[bytes] | None = None
        self._megabytes = 0
        self._lock = threading.Lock()

    def run(self, source: Path, query: str, limits: Limits) -> Found:
        """The answer of a query over a snapshot, or a file of N-Quads.

        Raises:
            QueryError: it is wrong, or was stopped.
            StoreError: the source cannot be read.
        """
        kind, body = self._answered(limits, source=str(source), query=query)
        match kind:
            case worker.ROWS:
                return read_solutions(body)
            case worker.ANSWER:
                return BooleanResult(read_answer(body))
            case worker.TRIPLES:
                from ..stores.oxigraph import read_triples

                return Statements.of(read_triples(body, source=str(source)))
            case _:
                raise _failure(kind, body, limits)

    def try_updates(self, copy: Path, updates: Sequence[str], limits: Limits) -> Tried:
        """Run updates on a copy of a base and see what comes of it; errors as for `run`."""
        kind, body = self._answered(limits, source=str(copy), updates=list(updates))
        if kind != worker.UPDATED:
            raise _failure(kind, body, limits)
        return json.loads(body)

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.wait()
            for pipe in (self._process.stdin, self._process.stdout):
                if pipe:
                    pipe.close()
        self._process = None

    def _answered(self, limits: Limits, **request: str | list[str]) -> tuple[str, bytes]:
        line = json.dumps({**request, "megabytes": limits.megabytes}).encode() + b"\n"
        with self._lock:
            return self._asked(line, limits)

    def _asked(self, request: bytes, limits: Limits) -> tuple[str, bytes]:
        """Send a request and read the answer; the process is killed when it goes too far."""
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
            raise _ended(process.returncode, limits, was_stopped=stopped.is_set()) from None
        except BaseException:
            self.close()
            raise
        finally:
            timer.cancel()

    def _started(self, limits: Limits) -> subprocess.Popen[bytes]:
        is_running = self._process is not None and self._process.poll() is None
        if self._process is None or not is_running or self._megabytes != limits.megabytes:
            self.close()
            self._megabytes = limits.megabytes
            self._process = subprocess.Popen(  # noqa: S603 - our own module
                [sys.executable, "-m", worker.__name__],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                stderr=subprocess.DEVNULL,
            )
        return self._process


def _ended(code: int, limits: Limits, *, was_stopped: bool) -> QueryError:
    """Why the process is no more: killed by us, or by the system."""
    if was_stopped:
        return limits.too_long()
    if code == -signal.SIGSEGV:  # the engine's parser calls itself for each bracket
        return QueryError("The query is nested too deeply, and was stopped.")
    return limits.too_large()


def _failure(kind: str, body: bytes, limits: Limits) -> Exception:
    if kind == worker.TOO_LARGE:
        return limits.too_large()
    return (QueryError if kind == worker.WRONG_QUERY else StoreError)(body.decode())


def _exchange(
    process: subprocess.Popen[bytes], request: bytes, limits: Limits
) -> tuple[str, bytes]:
    to, answers = cast("IO[bytes]", process.stdin), cast("IO[bytes]", process.stdout)
    to.write(request)
    to.flush()
    line = answers.readline()
    if not line.endswith(b"\n"):
        raise EOFError
    head = json.loads(line)
    if head["size"] > limits.megabytes * 1_000_000 // MAX_SHARE:
        raise limits.too_large()
    body = answers.read(head["size"])
    if len(body) < head["size"]:
        raise EOFError
    return head["kind"], body
