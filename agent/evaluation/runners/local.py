"""Runners on this machine: in this process, or in a pool of processes that may die or hang."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass
from multiprocessing import get_context
from queue import Empty, SimpleQueue

from pebble import ProcessExpired, ProcessPool

from ....ontology.errors import WorkersUnavailableError
from ..case import Case, TimedResult, to_json_line
from ..experiment import Experiment
from .base import ATTEMPTS, TIMEOUT_S, lost_case, parse_case_run, run_case, run_cases

START_S = 120.0  # how long the worker processes may take to start a case [s]

Started = tuple[Case, int, "Future[list[str]]"]  # case, its attempt, its result


class SerialRunner:
    """Runs cases in this process, one after the other; cases that hang are not stopped."""

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[TimedResult]:
        """Run the cases in their order."""
        return (run_case(experiment, case) for case in cases)


@dataclass(frozen=True)
class ProcessRunner:
    """Runs cases in a pool of processes (started by "spawn" on every platform).

    A process is killed when its case takes longer than `timeout_s` [s]. A case whose process dies
    or times out is started `attempts` times.
    """

    workers: int
    timeout_s: float = TIMEOUT_S
    attempts: int = ATTEMPTS

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[TimedResult]:
        """Run the cases, each in one of the processes.

        Raises:
            WorkersError: no process can be started.
        """
        if not cases:
            return
        pool = ProcessPool(min(self.workers, len(cases)), context=get_context("spawn"))
        finished: SimpleQueue[Started] = SimpleQueue()
        pending: set[Future[list[str]]] = set()
        name, options = experiment.name, to_json_line(experiment.options)

        def start(case: Case, attempt: int) -> None:
            work = (name, options, [to_json_line(case.as_json())])
            future = pool.schedule(run_cases, args=work, timeout=self.timeout_s)
            pending.add(future)
            future.add_done_callback(lambda done: finished.put((case, attempt, done)))

        try:
            for case in cases:
                start(case, 1)
            while pending:
                case, attempt, future = _next_finished(finished, pending)
                pending.remove(future)
                try:
                    (line,) = future.result()
                    yield parse_case_run(line, attempt)
                except (ProcessExpired, TimeoutError):
                    if attempt < self.attempts:
                        start(case, attempt + 1)
                    else:
                        reason = f"its worker process died or timed out {attempt} times"
                        yield lost_case(case, reason, attempt)
        finally:
            pool.stop()
            pool.join()


def _next_finished(finished: SimpleQueue[Started], pending: set[Future[list[str]]]) -> Started:
    """Wait for the next finished case, as long as any case has started within `START_S`."""
    while True:
        try:
            return finished.get(timeout=START_S)
        except Empty:
            if not any(future.running() for future in pending):
                problem = f"No worker process has started in {START_S:g} s."
                raise WorkersUnavailableError(
                    f"{problem} Run with one worker to see why."
                ) from None
