"""Time and memory of large imports and exports.

    pytest benchmarks/test_kb_exchange.py -s
    HILT_BENCH_RULES=1000000 pytest benchmarks/test_kb_exchange.py -s    # some minutes

The figures to reach for 1,000,000 rules: at most 120 s and 3 GiB each way. Each run is a process
of its own, so that its largest memory is its own.
"""

from __future__ import annotations

import json
import os
import random
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.timeout(0)  # a million rules may take longer than a test may

RULES = int(os.environ.get("HILT_BENCH_RULES", "20000"))
SECONDS = 120 * max(RULES, 100_000) / 1_000_000
MEGABYTES = 3072
RUN = """
import json, resource, sys, time
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.formats.import_export import export_file, import_file
doing, base, file = sys.argv[1:]
with KnowledgeBase.open(base) as kb:
    start, cpu = time.perf_counter(), time.process_time()
    found = import_file(kb, file) if doing == "import" else export_file(kb, file)
    seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps({"seconds": seconds, "cpu": cpu, "megabytes": peak, "found": str(found)}))
"""


@pytest.fixture(scope="module")
def table(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A table of rules about 20,000 objects."""
    rng = random.Random(1)  # noqa: S311 - a seed, not a secret
    path = tmp_path_factory.mktemp("exchange") / "rules.csv"
    with path.open("w") as lines:
        lines.write("features,contexts,functor,argument,lower,speaker\n")
        for number in range(RULES):
            thing, lower = f"thing {rng.randrange(20_000)}", round(rng.random(), 6)
            if number % 2:
                lines.write(f"{thing},,usedFor,use {rng.randrange(500)},{lower},sam\n")
            else:
                action, part = f"action{rng.randrange(50)}", f"part {rng.randrange(50)}"
                lines.write(f"{thing},{action},graspObject,{part},{lower},sam\n")
    return path


def measured(doing: str, base: Path, file: Path) -> None:
    """Run one import or export, print what it took, and compare with what it may take."""
    command = [sys.executable, "-c", RUN, doing, str(base), str(file)]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)  # noqa: S603 - our own program

    print(
        f"\n{doing} {file.name}: {found['seconds']:.1f} s ({found['cpu']:.1f} s of processor), "
        f"{found['megabytes']:.0f} MB"
    )
    assert found["seconds"] <= SECONDS
    assert found["megabytes"] <= MEGABYTES


@pytest.fixture(scope="module")
def filled(table: Path) -> Path:
    """A base with the rules of the table."""
    base = table.parent / "base"
    measured("import", base, table)
    return base


@pytest.mark.parametrize("name", ["base.nq", "base.trig.gz", "rules.ttl", "rules.csv"])
def test_export_and_import_keep_to_their_time_and_memory(filled: Path, name: str):
    """Into a file, and from it into an empty base."""
    file = filled.parent / name

    measured("export", filled, file)
    measured("import", filled.parent / f"from-{name}", file)
