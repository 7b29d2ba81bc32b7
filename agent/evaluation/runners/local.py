# SPDX-License-Identifier: Apache-2.0
"""Several processes on this machine, any of which may die or hang.

Each worker has a pipe of its own and, where cases are short, some waiting in it, so that it never
waits for the driver. A worker that dies, or is killed because a case takes too long, is replaced;
the case it was at is begun again, a few times at most, and those that waited behind it simply
again. (A pool of the standard library loses everything that is pending when one worker dies.)
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from time import monotonic

from ....ontology.errors import WorkersError
from ..case import Case, Done, line_of
from ..experiment import Experiment
from .base import ATTEMPTS, TIMEOUT_S
from .worker import READY, lost, read_done, serve

IN_PIPE = 3  # cases that a worker has: the one it is at, and some so that it need not wait
SHORT_S = 0.05  # slower cases do not wait in a pipe while another worker may be idle [s]
START_S = 120.0  # how long a worker may take to start [s]
FAILED_STARTS = 3  # as many workers that die before they are ready mean that none will start


@dataclass(frozen=True)
class _Task:
    case: Case
    attempts: int = 0  # how often a worker was lost at it


class Processes:
    """Runs cases in processes that are started for it (spawned, on every platform).

    Args:
        workers: how many.
        timeout_s: how long a case may take before its worker is killed [s].
        attempts: how often a case is begun whose worker dies or hangs.
    """

    def __init__(
        self, workers: int, *, timeout_s: float = TIMEOUT_S, attempts: int = ATTEMPTS
    ) -> None:
        self.workers = workers
        self.timeout_s = timeout_s
        self.attempts = attempts

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[Done]:
        """Run the cases in as many processes.

        Raises:
            WorkersError: no worker could be started.
        """
        waiting = deque(_Task(case) for case in cases)
        crew = _Crew(experiment, min(self.workers, len(cases)), self.timeout_s)
        try:
            while waiting or crew.is_busy:
                crew.hand_out(waiting)
                yield from crew.collect()
                for case, behind in crew.replace_lost():
                    waiting.extendleft(reversed(behind))
                    if case and case.attempts < self.attempts:
                        waiting.append(case)
                    elif case:
                        why = f"its worker was lost {case.attempts} times"
                        yield lost(case.case, why, case.attempts)
        finally:
            crew.close()


class _Crew:
    """The workers there are, and what each has in its pipe."""

    def __init__(self, experiment: Experiment, size: int, timeout_s: float) -> None:
        self._experiment = experiment
        self._timeout_s = timeout_s
        self._failed_starts = 0
        self._cpu_s, self._count = 0.0, 0
        self._workers = [_Worker(experiment) for _ in range(size)]

    @property
    def is_busy(self) -> bool:
        return any(worker.tasks for worker in self._workers)

    def hand_out(self, waiting: deque[_Task]) -> None:
        """Fill the pipes evenly, as far as there are cases."""
        are_short = self._count > 0 and self._cpu_s / self._count < SHORT_S
        for depth in range(IN_PIPE if are_short else 1):
            for worker in self._workers:
                if waiting and len(worker.tasks) == depth:
                    worker.give(waiting.popleft())

    def collect(self) -> Iterator[Done]:
        """Wait until something comes, or until the next worker is out of time."""
        limit = min(worker.deadline(self._timeout_s) for worker in self._workers)
        ready = wait([w.connection for w in self._workers], max(0.0, limit - monotonic()))
        for worker in self._workers:
            for done in worker.take() if worker.connection in ready else ():
                self._cpu_s, self._count = self._cpu_s + done.cpu_s, self._count + 1
                yield done

    def replace_lost(self) -> Iterator[tuple[_Task | None, list[_Task]]]:
        """Put a new worker where one is gone or hangs.

        Yields:
            The case it was lost at, one attempt more; and those that waited behind it.
        """
        for index, worker in enumerate(self._workers):
            if not worker.is_gone and worker.deadline(self._timeout_s) > monotonic():
                continue
            worker.close()
            self._failed_starts = 0 if worker.is_ready else self._failed_starts + 1
            if self._failed_starts >= FAILED_STARTS:
                raise WorkersError(
                    "No worker process could be started. Run with one worker to see why."
                )
            self._workers[index] = _Worker(self._experiment)
            tasks = list(worker.tasks)
            if worker.is_ready and tasks:
                yield _Task(tasks[0].case, tasks[0].attempts + 1), tasks[1:]
            else:
                yield None, tasks

    def close(self) -> None:
        for worker in self._workers:
            worker.close()


class _Worker:
    """One process, our end of its pipe, and the cases in it; the first is the one it is at."""

    def __init__(self, experiment: Experiment) -> None:
        context = get_context("spawn")
        self.connection: Connection
        self.connection, theirs = context.Pipe()
        self.tasks: deque[_Task] = deque()
        self.is_ready = False
        self.is_gone = False
        self._since = monotonic()
        self._process = context.Process(
            target=serve,
            args=(theirs, experiment.name, line_of(experiment.options)),
            daemon=True,
        )
        self._process.start()
        theirs.close()  # so that its end is the only one, and is seen to close

    def give(self, task: _Task) -> None:
        """Put a case into the pipe."""
        if not self.tasks:
            self._since = monotonic()
        self.tasks.append(task)
        try:
            self.connection.send_bytes(line_of(task.case.as_json()).encode())
        except OSError:
            self.is_gone = True

    def take(self) -> Iterator[Done]:
        """All that has come through the pipe."""
        try:
            while self.connection.poll():
                message = self.connection.recv_bytes()
                self._since = monotonic()
                if message == READY:
                    self.is_ready = True
                else:
                    yield read_done(message, self.tasks.popleft().attempts + 1)
        except (EOFError, OSError):
            self.is_gone = True

    def deadline(self, timeout_s: float) -> float:
        """When it must have said something; never, if there is nothing to say."""
        if not self.is_ready:
            return self._since + START_S
        return self._since + timeout_s if self.tasks else float("inf")

    def close(self) -> None:
        """Kill the process."""
        self._process.kill()
        self._process.join()
        self.connection.close()
