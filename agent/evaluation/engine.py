# SPDX-License-Identifier: Apache-2.0
"""Running the cases of an experiment, one after the other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from time import process_time

from rich.console import Console
from rich.progress import track

from .case import Case, Done, Result
from .experiment import Experiment


def run(experiment: Experiment, *, console: Console) -> Iterator[Done]:
    """Run all cases with a progress bar."""
    cases = experiment.cases()
    shown: Iterable[Case] = track(
        cases, description=experiment.name, total=len(cases), console=console, transient=True
    )
    for case in shown:
        yield run_case(experiment, case)


def run_case(experiment: Experiment, case: Case) -> Done:
    """Run one case here; an error is a result too."""
    began = process_time()
    try:
        result = experiment.run(case)
    except Exception as error:  # whatever a case raises is what came of it
        found = f"{type(error).__name__}: {error}"
        result = Result(case.key, False, "error", 0, found, "no error")
    return Done(result, process_time() - began)
