"""Time and memory of validation by SHACL, and of the checks that an import makes as it reads.

    pytest benchmarks/test_kb_validation.py -s

The figure to reach: 10,000 rules by SHACL in at most 30 s, telling how far it is. Each run is a
process of its own, so that its largest memory is its own. What is compared is processor time: it
is what an idle machine takes, as all this happens in one thread.
"""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from hilt.kb.interval import Interval
from hilt.kb.rdf.rule_mapping import rule_quads
from hilt.kb.rule import grasping
from hilt.kb.stores.rdf_text import write_rdf

pytestmark = pytest.mark.timeout(0)  # a busy machine takes several times as long

RULES = 10_000
SECONDS = 30
RUN = """
import json, resource, sys, time
from hilt.kb.formats.import_export import import_file, read_file
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.validation import check_shapes, findings
doing, file = sys.argv[1:]
told, start, cpu = [], time.perf_counter(), time.process_time()
if doing == "shapes":
    tell = lambda done, total: told.append((done, total))
    found = [*check_shapes(read_file(file)), *findings(read_file(file), progress=tell)]
else:
    found = import_file(KnowledgeBase.open("memory:"), file, dry_run=True)
seconds, cpu = time.perf_counter() - start, time.process_time() - cpu
peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
print(json.dumps({"seconds": seconds, "cpu": cpu, "megabytes": peak, "told": told[-1:],
                  "times": len(told), "found": str(found)}))
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The same rules as TriG and as a table."""
    folder = tmp_path_factory.mktemp("validation")
    rules = [
        grasping(f"thing {n}", f"part {n % 50}", f"act {n % 70}", interval=Interval(n / RULES, 1))
        for n in range(RULES)
    ]
    quads = [quad for rule in rules for quad in rule_quads(rule)]
    (folder / "rules.trig").write_bytes(write_rdf(quads, format="trig"))
    rows = (
        f"{rule.object},{rule.context},graspObject,{rule.part},{rule.interval.lower}\n"
        for rule in rules
    )
    (folder / "rules.csv").write_text("features,contexts,functor,argument,lower\n" + "".join(rows))
    return folder


def measured(doing: str, file: Path) -> dict[str, object]:
    """Run one check and print what it took."""
    command = [sys.executable, "-c", RUN, doing, str(file)]
    found = json.loads(subprocess.run(command, check=True, capture_output=True, text=True).stdout)  # noqa: S603 - our own program
    print(
        f"\n{doing} of {RULES} rules, {file.name}: {found['seconds']:.1f} s "
        f"({found['cpu']:.1f} s of processor time), {found['megabytes']:.0f} MB"
    )
    assert found["cpu"] <= SECONDS
    return found


def test_shapes_keep_to_their_time_and_tell_how_far_they_are(files: Path):
    """SHACL over all rules and everything that they speak of; nothing is wrong."""
    found = measured("shapes", files / "rules.trig")

    ((done, total),) = found["told"]  # pyright: ignore[reportGeneralTypeIssues]
    assert found["found"] == "[]"
    assert found["times"] >= RULES // 1000  # pyright: ignore[reportOperatorIssue]
    assert done == total >= 2 * RULES


@pytest.mark.parametrize("name", ["rules.trig", "rules.csv"])
def test_import_checks_keep_to_their_time(files: Path, name: str):
    """All that an import does but for the writing."""
    found = measured("import", files / name)

    assert f"new={RULES}" in str(found["found"])
