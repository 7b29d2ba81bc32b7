# SPDX-License-Identifier: Apache-2.0
"""Engines run the cases of an experiment: in this process, in several, or on a Ray cluster.

Which one does makes no difference to a result. `run` adds what they have in common: what the
journal holds is not run again, what comes is written to it, and a bar shows how far it is.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Protocol

from ..case import Case, Done
from ..experiment import Experiment
from .progress import progress
from .worker import run_case

if TYPE_CHECKING:
    from rich.console import Console

    from .journal import RunJournal

TIMEOUT_S = 600.0  # what takes longer hangs: no case of ours takes a tenth of it
ATTEMPTS = 3  # how often a case is begun whose worker dies or hangs


class Runner(Protocol):
    """Runs cases."""

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[Done]:
        """Run the cases; results come in the order in which they are ready, each case once."""
        ...


class Serial:
    """Runs cases in this process, one after the other; nothing stops one that hangs."""

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[Done]:
        """Run the cases in their order."""
        return (run_case(experiment, case) for case in cases)


def open_engine(
    workers: int | None = None, ray: str | None = None, *, timeout_s: float = TIMEOUT_S
) -> Runner:
    """The engine that the options of a command ask for.

    Args:
        workers: how many cases run at once; None is one, or as many as the cluster has room for.
        ray: the address of a Ray cluster, "auto" for the one that this machine belongs to, or
            "local" for one of our own.
        timeout_s: how long a case may take before its worker is killed [s].

    Raises:
        MissingExtraError: Ray is not installed.
    """
    if ray:
        from .ray import Cluster

        return Cluster(ray, workers, timeout_s=timeout_s)
    if workers is None or workers == 1:
        return Serial()
    from .local import Processes

    return Processes(workers, timeout_s=timeout_s)


def run(
    experiment: Experiment,
    cases: Sequence[Case] | None = None,
    *,
    engine: Runner | None = None,
    journal: RunJournal | None = None,
    console: Console | None = None,
) -> tuple[Done, ...]:
    """Run an experiment, or go on with it.

    Args:
        experiment: what is run.
        cases: its cases, if they are listed already.
        engine: what runs them; None runs them here.
        journal: where results are written as they come; what it holds is not run again.
        console: where the progress is shown; None shows none.

    Returns:
        What came of every case, in their order.
    """
    cases = experiment.cases() if cases is None else cases
    done = dict(journal.done) if journal else {}
    left = [case for case in cases if case.key not in done]
    with progress(experiment.name, len(cases), len(cases) - len(left), console) as advance:
        for each in (engine or Serial()).run(experiment, left):
            done[each.result.key] = each
            if journal:
                journal.add(each)
            advance()
    ordered = tuple(done[case.key] for case in cases)
    if journal:
        journal.finish(cases, experiment.files([each.result for each in ordered]))
    return ordered
