"""The protocol of a runner, and running cases in this or in a worker process.

A worker process gets the name and options of an experiment and constructs it again; cases and
results are transferred as lines of JSON.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from functools import lru_cache
from time import process_time
from typing import Protocol, cast

from ....ontology.errors import WorkersUnavailableError
from ...execution.outcome import Json
from ..case import Case, CaseResult, TimedResult, to_json_line
from ..experiment import Experiment
from ..experiments.registry import make_experiment

TIMEOUT_S = 600.0  # [s]; ten times as long as any case of ours takes
ATTEMPTS = 3  # how often a case is started whose worker dies or times out


class Runner(Protocol):
    """Runs cases."""

    def run(self, experiment: Experiment, cases: Sequence[Case]) -> Iterator[TimedResult]:
        """Run each case once, and yield the results as they become available."""
        ...


def run_case(experiment: Experiment, case: Case) -> TimedResult:
    """Run one case in this process; an exception becomes a result of kind "error"."""
    start = process_time()
    try:
        result = experiment.run(case)
    except Exception as error:  # any exception of a case is its result
        found = f"{type(error).__name__}: {error}"
        result = CaseResult(case.key, False, "error", 0, found, "no error")
    return TimedResult(result, process_time() - start)


def lost_case(case: Case, reason: str, attempts: int) -> TimedResult:
    """Return the result of a case that no worker has finished."""
    return TimedResult(CaseResult(case.key, False, "lost", 0, reason, "a result"), 0.0, attempts)


def run_cases(name: str, options: str, cases: Sequence[str]) -> list[str]:
    """Run cases in a worker process; arguments and results are JSON.

    Raises:
        WorkersError: the experiment cannot be constructed in this process.
    """
    try:
        experiment = _experiment(name, options)
    except Exception as error:  # an exception with a single text can be sent to any process
        raise WorkersUnavailableError(f"A worker process could not be started: {error}") from None
    runs = (run_case(experiment, Case.from_json(json.loads(case))) for case in cases)
    return [to_json_line({"result": r.result.as_json(), "cpu_s": r.cpu_s}) for r in runs]


@lru_cache(maxsize=1)  # keeps what is expensive to set up for the next cases
def _experiment(name: str, options: str) -> Experiment:
    return make_experiment(name, json.loads(options))


def parse_case_run(line: str, attempts: int) -> TimedResult:
    """Return the result that `run_cases` wrote."""
    document = cast("Json", json.loads(line))
    result = CaseResult.from_json(cast("Json", document["result"]))
    return TimedResult(result, cast("float", document["cpu_s"]), attempts)
