"""How much faster an evaluation is with more worker processes.

Runs `hilt evaluate WHAT...` with 1, 2, ... workers, checks that the results are the same bytes, and
prints for each run the wall-clock time, the processor time of all processes, and two speed-ups: by
wall-clock time, and by processor time (with a core for every worker and nothing else running). If
other programs are running, only the second one is meaningful:

    python benchmarks/scaling.py --workers 1,2 paper --sim
"""

import argparse
import os
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from resource import RUSAGE_CHILDREN, getrusage

HILT = (sys.executable, "-c", "from hilt.agent.cli import main; main()", "evaluate")


@dataclass(frozen=True)
class Run:
    """One run of the command.

    Attributes:
        workers: number of worker processes.
        clock_s: wall-clock time [s].
        cpu_s: processor time of the command and its workers [s].
        results: content of the results file.
    """

    workers: int
    clock_s: float
    cpu_s: float
    results: bytes


def measure(what: list[str], workers: int) -> Run:
    """Run the command once and return its times and results."""
    with tempfile.TemporaryDirectory() as folder:
        command = [*HILT, *what, "--workers", str(workers), "--out", folder, "--json"]
        before, began = _cpu_s(), time.perf_counter()
        # Exit code 1 means that a case is wrong, which does not matter here.
        subprocess.run(command, check=False)  # noqa: S603
        clock_s, cpu_s = time.perf_counter() - began, _cpu_s() - before
        return Run(workers, clock_s, cpu_s, Path(folder, "results.jsonl").read_bytes())


def _cpu_s() -> float:
    used = getrusage(RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Measure and print."""
    parser = argparse.ArgumentParser(description="Speed-up of an evaluation by workers.")
    parser.add_argument(
        "--workers", default="1,2", help="numbers of workers, the first is compared"
    )
    parser.add_argument("what", nargs=argparse.REMAINDER, help="evaluation and its options")
    given = parser.parse_args()
    print(f"{os.cpu_count()} cores, load {os.getloadavg()[0]:.1f}")
    runs = [measure(given.what, int(workers)) for workers in given.workers.split(",")]
    first = runs[0]
    for run in runs:
        assert run.results == first.results, "the results differ"
        clock = first.clock_s / run.clock_s
        ideal = first.cpu_s / first.workers / (run.cpu_s / run.workers)
        print(
            f"{run.workers} workers: {run.clock_s:7.1f} s, {run.cpu_s:7.1f} s of processor, "
            f"{clock:.2f} times as fast ({ideal:.2f} by processor time)"
        )


if __name__ == "__main__":
    main()
