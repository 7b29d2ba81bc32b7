"""Processor time of small SPARQL updates to bases of many rules, by the command line.

    python benchmarks/update_cost.py [RULES ...]

The figures to reach: 2 s for an update at 100,000 rules and 3 s at 1,000,000, with all processes
that it starts. Each base is imported once, into a temporary folder.
"""

from __future__ import annotations

import resource
import subprocess
import sys
import tempfile
from pathlib import Path

from hilt.kb.knowledge_base import KnowledgeBase

TRUST = (
    "DELETE { GRAPH graph:beliefs { speaker:sam hilt:trustLower ?was } } "
    "INSERT { GRAPH graph:beliefs { speaker:sam hilt:trustLower 0.5 } } "
    "WHERE { speaker:sam hilt:trustLower ?was }"
)
SPEAKER = 'INSERT DATA { GRAPH graph:beliefs { speaker:bob a hilt:Speaker ; rdfs:label "bob" } }'
STATUS = (
    "WITH graph:beliefs DELETE { %(rule)s hilt:status ?was } "
    "INSERT { %(rule)s hilt:status hilt:retracted } WHERE { %(rule)s hilt:status ?was }"
)
BROKEN = "INSERT DATA { GRAPH graph:beliefs { speaker:sam hilt:trustLower 7 } }"


def write_rules(file: Path, rules: int) -> None:
    """Write a table of rules about 2,000 things."""
    with file.open("w", encoding="utf-8") as table:
        table.write("features,contexts,functor,argument,lower\n")
        for n in range(rules):
            bound = f"{(n % 997) / 1000 + 0.001:.3f}"
            table.write(f"thing {n % 2000},act {n // 2000},graspObject,part {n % 50},{bound}\n")


def processor_seconds(*arguments: str) -> float:
    """The processor time of a command of Hilt and of the processes that it starts."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    command = [sys.executable, "-m", "hilt", *arguments]
    subprocess.run(command, check=False, capture_output=True)  # noqa: S603 - our own command
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def main(sizes: list[int]) -> None:
    """Print a line for each size of a base."""
    print("rules, import [s], and updates [s]: trust, a speaker, a status, one that is refused")
    for rules in sizes:
        with tempfile.TemporaryDirectory() as folder:
            file, kb = Path(folder) / "rules.csv", Path(folder) / "kb"
            write_rules(file, rules)
            took = [processor_seconds("import", str(file), "--kb", str(kb))]
            with KnowledgeBase.open(kb, read_only=True) as base:
                rule = base.rules(object="thing 7")[0].id.replace("/", ":")
            for update in (TRUST, SPEAKER, STATUS % {"rule": rule}, BROKEN):
                took.append(processor_seconds("update", update, "--kb", str(kb)))
        print(f"{rules:>9}", *(f"{seconds:7.2f}" for seconds in took), flush=True)


if __name__ == "__main__":
    main([int(size) for size in sys.argv[1:]] or [1_000, 10_000, 100_000])
