# SPDX-License-Identifier: Apache-2.0
"""Running one case, here or in another process.

A worker process is given the name and the options of an experiment and makes it again; then it
reads cases and writes what came of them, as lines of JSON.
"""

from __future__ import annotations

import json
import signal
from collections.abc import Sequence
from functools import lru_cache
from multiprocessing.connection import Connection
from time import process_time
from typing import cast

from ...execution.outcome import Json
from ..case import Case, Done, Result, line_of
from ..experiment import Experiment, make_experiment

READY = b"ready"


def run_case(experiment: Experiment, case: Case) -> Done:
    """Run one case here; an error is a result too."""
    began = process_time()
    try:
        result = experiment.run(case)
    except Exception as error:  # whatever a case raises is what came of it
        found = f"{type(error).__name__}: {error}"
        result = Result(case.key, False, "error", 0, found, "no error")
    return Done(result, process_time() - began)


def lost(case: Case, why: str, attempts: int) -> Done:
    """What is left of a case that no worker lived to finish."""
    return Done(Result(case.key, False, "lost", 0, why, "a result"), 0.0, attempts)


def serve(connection: Connection, name: str, options: str) -> None:
    """Run the cases that come in, until the other side is gone.

    Args:
        connection: where cases come from and results go.
        name: of the experiment.
        options: of the experiment, as JSON.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the driver ends its workers
    experiment = make_experiment(name, json.loads(options))
    try:
        connection.send_bytes(READY)
        while True:
            case = Case.from_json(json.loads(connection.recv_bytes()))
            connection.send_bytes(_line(run_case(experiment, case)))
    except (EOFError, OSError):
        return


def run_cases(name: str, options: str, cases: Sequence[str]) -> list[str]:
    """Run several cases; all that goes in and comes out is JSON."""
    experiment = _kept(name, options)
    return [
        _line(run_case(experiment, Case.from_json(json.loads(case)))).decode() for case in cases
    ]


@lru_cache(maxsize=1)  # a worker of a cluster keeps what it has set up for the next cases
def _kept(name: str, options: str) -> Experiment:
    return make_experiment(name, json.loads(options))


def read_done(line: str | bytes, attempts: int) -> Done:
    """What a worker wrote."""
    document = cast("Json", json.loads(line))
    result = Result.from_json(cast("Json", document["result"]))
    return Done(result, cast("float", document["cpu_s"]), attempts)


def _line(done: Done) -> bytes:
    return line_of({"result": done.result.as_json(), "cpu_s": done.cpu_s}).encode()
