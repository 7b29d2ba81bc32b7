"""Start-up of the commands: processor time and time of the clock of whole processes.

Each command runs in a process of its own, over a base with two rules, in turn with the others, so
that a change of the machine's speed meets all alike. Beside them stand the bare interpreter and,
as a peer, what any program pays that imports rdflib. Run it as

    python benchmarks/startup.py [RUNS]

The first runs, which compile modules and fill the cache, do not count.
"""

from __future__ import annotations

import os
import resource
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Mapping, Sequence
from pathlib import Path

TOLD = ("A knife is used for cutting", "To pass a knife, grab it by the blade")
HILT = (str(Path(sys.executable).with_name("hilt")),)
COMMANDS: dict[str, tuple[str, ...]] = {
    "python -c pass": (sys.executable, "-c", "pass"),
    "import rdflib": (sys.executable, "-c", "import rdflib"),
    "hilt --version": (*HILT, "--version"),
    "hilt rules": (*HILT, "rules"),
    "hilt ask": (*HILT, "ask", "what is a knife used for?"),
    "hilt tell": (*HILT, "tell", TOLD[0]),
    "hilt do --no-sim": (*HILT, "do", "pass me the knife", "--no-sim"),
}


def measure(command: Sequence[str], environment: Mapping[str, str]) -> tuple[float, float]:
    """The processor time and the time of the clock of one run [s]."""
    before, started = _processor_time(), time.perf_counter()
    subprocess.run(command, env=environment, check=True, capture_output=True)  # noqa: S603
    return _processor_time() - before, time.perf_counter() - started


def _processor_time() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main(runs: int) -> None:
    """Print the median and the least time of each command."""
    with tempfile.TemporaryDirectory() as folder:
        environment = {
            **{name: value for name, value in os.environ.items() if not name.startswith("PYTHON")},
            "HILT_KB": str(Path(folder) / "kb"),
            "HILT_CACHE": str(Path(folder) / "cache"),
        }
        for sentence in TOLD:
            measure((*HILT, "tell", sentence), environment)
        measured = {name: list[tuple[float, float]]() for name in COMMANDS}
        for run in range(runs + 1):
            for name, command in COMMANDS.items():
                found = measure(command, environment)
                if run:
                    measured[name].append(found)
    print(f"{'[s]':18}{'processor':>18}{'clock':>18}\n{'':18}{'   median    least' * 2}")
    for name, times in measured.items():
        figures = (
            f"{statistic(each):9.3f}"
            for each in zip(*times, strict=True)
            for statistic in (statistics.median, min)
        )
        print(f"{name:18}{''.join(figures)}")


if __name__ == "__main__":
    main(int(sys.argv[1]) if len(sys.argv) > 1 else 7)
