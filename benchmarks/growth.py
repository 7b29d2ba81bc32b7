"""How the time and memory of each kind of work grow with the number of rules.

    python benchmarks/growth.py 1000 10000 100000          # some minutes
    python benchmarks/growth.py 1000 10000 100000 1000000  # an hour, and 10 GB of disk

Each command is a process of its own over a base in a folder; processor time includes that of its
child processes and the engine's threads. A query of a node and "best-for" are medians of 20 in one
process. An exponent says how the processor time grows from the second-largest number of rules to
the largest one: 0 is not at all, 1 in proportion.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import random
import shutil
import subprocess
import sys
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

HILT = (sys.executable, "-c", "from hilt.agent.cli import main; main()")
UPDATE = """INSERT DATA { GRAPH graph:beliefs {
  speaker:anna a hilt:Speaker ; rdfs:label "anna" ; hilt:trustLower 0.5 ; hilt:trustUpper 1.0 } }"""
QUERIES = """
import json, statistics, sys, time
from hilt.kb import KnowledgeBase

def median(work):
    times = []
    for _ in range(20):
        start = time.process_time()
        work()
        times.append(time.process_time() - start)
    return statistics.median(times)

with KnowledgeBase.open(sys.argv[1], read_only=True) as kb:
    print(json.dumps([median(lambda: kb.rules(object="thing 7")),
                      median(lambda: kb.answer("best-for", affordance="use 7"))]))
"""


class Cost(NamedTuple):
    """What a process needed."""

    wall_s: float
    cpu_s: float
    peak_mb: float


def write_rules(file: Path, number: int) -> None:
    """Write a table of so many rules: of ten rules of a thing, five are uses and five grasps."""
    rng = random.Random(number)  # noqa: S311 - nothing secret
    with file.open("w") as table:
        table.write("features,contexts,functor,argument,lower,upper,speaker\n")
        for count in range(number):
            thing, lower = f"thing {count // 10}", round(rng.random(), 4)
            if count % 2:
                action, part = f"action {rng.randrange(20)}", f"part {count % 10}"
                table.write(f"{thing},{action},graspObject,{part},{lower},1,sam\n")
            else:
                use = f"use {rng.randrange(max(10, number // 20))}"
                table.write(f"{thing},,usedFor,{use},{lower},1,sam\n")


def measure(*command: str | Path) -> Cost:
    """Run a command to its end, and return what it needed; exit code 1 is a difference."""
    start = time.perf_counter()
    quiet = {"stdout": subprocess.DEVNULL, "stderr": subprocess.DEVNULL}
    with subprocess.Popen([*HILT, *map(str, command)], **quiet) as process:  # noqa: S603 - our own
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode not in {0, 1}:
        raise RuntimeError(f"{command}: exit code {process.returncode}")
    cpu = used.ru_utime + used.ru_stime
    return Cost(time.perf_counter() - start, cpu, used.ru_maxrss / 1024)


def measure_all(rules: int, place: Path) -> dict[str, Cost]:
    """What each kind of work needs with so many rules."""
    table, base, text = place / "rules.csv", place / "kb", place / "base.nq"
    write_rules(table, rules)
    costs = {"import of CSV": measure("import", table, "--kb", base)}
    costs["export of N-Quads"] = measure("export", text, "--kb", base)
    costs["import of N-Quads"] = measure("import", text, "--kb", place / "again")
    costs["validate"] = measure("validate", "--kb", base)
    costs["diff with an equal base"] = measure("diff", base, place / "again")
    shutil.rmtree(place / "again")
    costs["update of one statement"] = measure("update", UPDATE, "--kb", base)
    costs["tell"] = measure("tell", "A knife is used for cutting.", "--kb", base)
    costs["merge into an empty base"] = measure("merge", place / "merged", base)
    found = subprocess.run(  # noqa: S603 - our own
        [sys.executable, "-c", QUERIES, str(base)], check=True, capture_output=True, text=True
    )
    for name, seconds in zip(
        ("rules of a thing", "best-for"), json.loads(found.stdout), strict=True
    ):
        costs[name] = Cost(seconds, seconds, 0)
    return costs


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rules", type=int, nargs="+")
    sizes = sorted(parser.parse_args().rules)
    found = list[dict[str, Cost]]()
    for rules in sizes:
        with tempfile.TemporaryDirectory(prefix="hilt-growth-") as place:
            found.append(measure_all(rules, Path(place)))
        print(json.dumps({"rules": rules, **found[-1]}), file=sys.stderr, flush=True)
    heads = ("CPU [s] (clock; peak MB)", *(f"{rules:,}" for rules in sizes), "exponent")
    print("|", " | ".join(heads), "|")
    print("|---" * len(heads) + "|")
    for name in found[0]:
        costs = [each[name] for each in found]
        cells = (
            f"{one.cpu_s:.1f} ({one.wall_s:.1f}; {one.peak_mb:.0f})"
            if one.peak_mb
            else f"{one.cpu_s * 1000:,.1f} ms"
            for one in costs
        )
        growth = math.log(costs[-1].cpu_s / costs[-2].cpu_s) / math.log(sizes[-1] / sizes[-2])
        print("|", " | ".join((name, *cells, f"{growth:.2f}")), "|")


if __name__ == "__main__":
    main()
