"""Runners on this machine: in this process, or in a pool of processes that may die or hang."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from multiprocessing import get_context

from pebble import ProcessExpired, ProcessPool

from ..case import Case, TimedResult, to_json_line
from ..experiment import Experiment
from .base import ATTEMPTS, TIMEOUT_S, run_case, run_in_pool, run_in_worker

START_S = 120.0  # how long the worker processes may take to start a case [s]


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
