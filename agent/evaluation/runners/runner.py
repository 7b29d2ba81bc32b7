"""Running an experiment in this process, in others that may die or hang, or on a Ray cluster.

A worker process gets the name and options of an experiment and constructs it again; cases and
results are transferred as lines of JSON. For a cluster Hilt must be installed on every node; the
cases of a failed node are started again on another one.
"""

import faulthandler
import json
import os
import socket
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future
from concurrent.futures.process import BrokenProcessPool
from dataclasses import replace
from functools import lru_cache, partial
from itertools import islice
from multiprocessing import get_context
from queue import Empty, SimpleQueue
from time import process_time
from typing import Any

from pebble import ProcessExpired, ProcessPool
from rich import progress
from rich.console import Console

from ....ontology.errors import WorkersUnavailableError, extra_required
from ...presentation.console import progress_bar
from ..experiment import Case, CaseResult, Experiment, TimedResult, make_experiment, to_json_line
from .journal import RunJournal

START_S = 120.0  # how long the worker processes may take to start a case [s]
TIMEOUT_S = 600.0  # [s]; ten times as long as any case of ours takes
ATTEMPTS = 3  # how often a case is started whose worker dies or times out
LOCAL = "local"
CONNECT_S = 10.0  # how long the head node may take to answer [s]

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
    """Run a case, as JSON, in a worker; WorkersError if its experiment cannot be constructed."""
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
    at_once: int | None = None,
    patience_s: float | None = None,
) -> Iterator[TimedResult]:
    """Run cases in other processes and yield results as they come; WorkersError if none can start.

    `start` starts `run_in_worker` with a case. It raises one of `failures` where the process died
    or timed out; then the case is started again, `ATTEMPTS` times in all. `at_once` cases are
    started at the same time (None: all); the processes may take `patience_s` to start one [s].
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
            if attempt < ATTEMPTS:
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


def run_in_processes(
    experiment: Experiment, cases: Sequence[Case], *, workers: int, timeout_s: float = TIMEOUT_S
) -> Iterator[TimedResult]:
    """Run cases in a pool of processes, started by "spawn" on every platform.

    A process is killed when its case exceeds the time-out [s]. WorkersError if none can be started.
    """
    pools: list[ProcessPool] = []
    name, options = experiment.name, to_json_line(experiment.options)

    def start(case: str) -> Future[str]:
        # A worker that dies before it reports its case breaks its pool.
        if not pools or not pools[-1].active:
            pools.append(ProcessPool(min(workers, len(cases)), context=get_context("spawn")))
        return pools[-1].schedule(run_in_worker, args=(name, options, case), timeout=timeout_s)

    failures = (ProcessExpired, BrokenProcessPool, TimeoutError)
    try:
        yield from run_in_pool(cases, start, failures, patience_s=START_S)
    finally:
        for pool in pools:
            pool.stop()
            pool.join()


def _import_ray() -> Any:
    # Ray reads this when it is imported: no usage statistics are sent.
    os.environ.setdefault("RAY_USAGE_STATS_ENABLED", "0")
    with extra_required("cluster", "ray"):
        import ray  # pyright: ignore[reportMissingImports] - an extra

    return ray


def run_on_ray(
    experiment: Experiment,
    cases: Sequence[Case],
    *,
    address: str,
    workers: int | None = None,
    timeout_s: float = TIMEOUT_S,
) -> Iterator[TimedResult]:
    """Run cases on a Ray cluster; MissingExtraError if Ray is not installed.

    The address is that of its head node, "auto", or "local" to start a cluster. `workers` are cases
    at the same time, None for the number of processors. A case is stopped when it takes longer than
    the time-out [s]. WorkersError if the cluster cannot be reached.
    """
    ray, is_own = _import_ray(), address == LOCAL
    host, colon, port = address.removeprefix("ray://").rpartition(":")
    try:
        if colon:  # Ray itself would retry for minutes
            socket.create_connection((host, int(port)), CONNECT_S).close()
        ray.init(
            address=None if is_own else address,
            num_cpus=workers if is_own else None,
            include_dashboard=False if is_own else None,
            log_to_driver=False,
            logging_level="ERROR",
        )
    except (OSError, RuntimeError, ValueError) as error:
        raise WorkersUnavailableError(f'No Ray cluster at "{address}": {error}') from error
    work = (timeout_s, experiment.name, to_json_line(experiment.options))
    task, failures = ray.remote(_run_within).options(max_retries=0), (ray.exceptions.RayError,)
    try:
        yield from run_in_pool(
            cases, lambda case: task.remote(*work, case).future(), failures, at_once=workers
        )
    finally:
        ray.shutdown()


def _run_within(timeout_s: float, *work: str) -> str:
    faulthandler.dump_traceback_later(timeout_s, exit=True)
    try:
        return run_in_worker(*work)
    finally:
        faulthandler.cancel_dump_traceback_later()


def make_runner(
    workers: int | None = None, ray: str | None = None, *, timeout_s: float = TIMEOUT_S
) -> Runner:
    """Return the runner for the options of a command; MissingExtraError if there is no Ray."""
    if ray:
        _import_ray()
        return partial(run_on_ray, address=ray, workers=workers, timeout_s=timeout_s)
    if workers is None or workers == 1:
        return run_serially
    return partial(run_in_processes, workers=workers, timeout_s=timeout_s)


def run_experiment(
    experiment: Experiment,
    cases: Sequence[Case] | None = None,
    *,
    runner: Runner | None = None,
    journal: RunJournal | None = None,
    console: Console | None = None,
) -> tuple[TimedResult, ...]:
    """Run an experiment, or resume it, and return the results of all cases in their order.

    `cases` are its cases, if listed already; without a runner they run in this process. The journal
    gets the results as they come, and its cases are not run again. The console shows the progress.
    """
    cases = experiment.cases() if cases is None else cases
    runs = dict(journal.runs) if journal else {}
    left = [case for case in cases if case.key not in runs]
    with case_progress(console) as bar:
        task = bar.add_task(experiment.name, total=len(cases), completed=len(runs))
        for run in (runner or run_serially)(experiment, left):
            runs[run.result.key] = run
            if journal:
                journal.add(run)
            bar.advance(task)
    ordered = tuple(runs[case.key] for case in cases)
    if journal:
        journal.finish(cases, experiment.files([run.result for run in ordered]))
    return ordered


def case_progress(console: Console | None) -> progress.Progress:
    """Return a bar of cases; it shows nothing if the console is None or not a terminal."""
    left = (progress.TimeRemainingColumn(compact=True), "left")
    return progress_bar(console, progress.MofNCompleteColumn(), *left)
