"""Runners of cases on this machine: in this process, or in others that may die or hang.

A worker process gets the name and options of an experiment and constructs it again; cases and
results are transferred as lines of JSON.
"""

import json
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import islice
from multiprocessing import get_context
from queue import Empty, SimpleQueue
from time import process_time

from pebble import ProcessExpired, ProcessPool

from ....ontology.errors import WorkersUnavailableError
from ..experiment import Case, CaseResult, Experiment, TimedResult, make_experiment, to_json_line

START_S = 120.0  # how long the worker processes may take to start a case [s]
TIMEOUT_S = 600.0  # [s]; ten times as long as any case of ours takes
ATTEMPTS = 3  # how often a case is started whose worker dies or times out


Runner = Callable[[Experiment, Sequence[Case]], Iterator[TimedResult]]
"""Runs each case once, and yields the results as they become available."""


def run_case(experiment: Experiment, case: Case) -> TimedResult:
    """Run one case in this process; an exception becomes a result of kind "error"."""
    start = process_time()
    try:
        result = experiment.run(case)
    except Exception as error:  # any exception of a case is its result
        found = f"{type(error).__name__}: {error}"
        result = CaseResult(case.key, False, "error", 0, found, "no error")
    return TimedResult(result, process_time() - start)


def run_in_worker(name: str, options: str, case: str) -> str:
    """Run a case in a worker process; arguments and result are JSON.

    WorkersError if the experiment cannot be constructed in this process.
    """
    try:
        experiment = _experiment(name, options)
    except Exception as error:  # an exception with a single text can be sent to any process
        raise WorkersUnavailableError(f"A worker process could not be started: {error}") from None
    return to_json_line(run_case(experiment, Case(**json.loads(case))))


@lru_cache(maxsize=1)  # keeps what is expensive to set up for the next cases
def _experiment(name: str, options: str) -> Experiment:
    return make_experiment(name, json.loads(options))


def run_in_pool(
    cases: Sequence[Case],
    start: Callable[[str], Future[str]],
    failures: tuple[type[Exception], ...],
    *,
    attempts: int,
    at_once: int | None = None,
    patience_s: float | None = None,
) -> Iterator[TimedResult]:
    """Run cases in other processes, and yield the results as they become available.

    Args:
        cases: what is run.
        start: starts `run_in_worker` with a case.
        failures: what it raises where the process died or timed out; then the case is started
            again.
        attempts: how often a case is started.
        at_once: how many cases are started at the same time; None starts all.
        patience_s: how long the processes may take to start a case [s].

    Raises:
        WorkersError: no process can be started.
    """
    finished: SimpleQueue[tuple[Case, int, Future[str]]] = SimpleQueue()
    pending: set[Future[str]] = set()
    waiting = iter(cases)

    def begin(case: Case, attempt: int) -> None:
        future = start(to_json_line(case))
        pending.add(future)
        future.add_done_callback(lambda done: finished.put((case, attempt, done)))

    for case in islice(waiting, at_once):
        begin(case, 1)
    while pending:
        try:
            case, attempt, future = finished.get(timeout=patience_s)
        except Empty:
            if any(future.running() for future in pending):
                continue
            problem = f"No worker process has started in {patience_s:g} s."
            raise WorkersUnavailableError(f"{problem} Run with one worker to see why.") from None
        pending.remove(future)
        try:
            yield replace(TimedResult.from_json(json.loads(future.result())), attempts=attempt)
        except failures:
            if attempt < attempts:
                begin(case, attempt + 1)
                continue
            reason = f"its worker process died or timed out {attempt} times"
            lost = CaseResult(case.key, False, "lost", 0, reason, "a result")
            yield TimedResult(lost, 0.0, attempt)
        for each in islice(waiting, 1):
            begin(each, 1)


def run_serially(experiment: Experiment, cases: Sequence[Case]) -> Iterator[TimedResult]:
    """Run cases in this process, one after the other; those that hang are not stopped."""
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

    def __call__(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[TimedResult]:
        """Run the cases, each in one of the processes; WorkersError if none can be started."""
        if not cases:
            return
        pool = ProcessPool(min(self.workers, len(cases)), context=get_context("spawn"))
        name, options = experiment.name, to_json_line(experiment.options)
        try:
            yield from run_in_pool(
                cases,
                lambda case: pool.schedule(
                    run_in_worker, args=(name, options, case), timeout=self.timeout_s
                ),
                (ProcessExpired, TimeoutError),
                attempts=self.attempts,
                patience_s=START_S,
            )
        finally:
            pool.stop()
            pool.join()
