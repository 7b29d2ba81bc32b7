"""Claims about what a dying process leaves behind: everything acknowledged, nothing torn.

Each kind of writing is killed a few times in every run of the tests; a hundred times by

    HILT_KILLS=100 pytest tests/kb/stores/test_durability.py -k kill
"""

from __future__ import annotations

import os
import random
import shutil
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from hilt.kb.bulk.exporter import scan_rules
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import functional, grasping
from hilt.kb.validation import check_invariants

# Teaches two rules an utterance and takes the one before back, for ever; prints each number as
# soon as it is acknowledged.
TEACHER = """
import sys
from hilt.kb import Interval, KnowledgeBase, functional, grasping
kb = KnowledgeBase.open(sys.argv[1])
high = Interval(0.95, 1)
print(kb.sequence, flush=True)
while True:
    number = kb.sequence + 1
    name = f"object {number}"
    rules = [
        functional(name, "cutting", interval=high),
        grasping(name, "handle", "pass", interval=high),
    ]
    gone = [one for one in kb.utterance(number - 1).asserts[:1]] if number > 1 else []
    said = kb.believe(f"Sentence {number}.", "implies(x,y,high)", "sam", rules, retracts=gone)
    print(said.sequence, flush=True)
"""


def teach_and_kill(folder: Path, seconds: float, program: str = TEACHER) -> int:
    """Run the teacher, kill it after a time, and give the last number it acknowledged."""
    teacher = subprocess.Popen(
        [sys.executable, "-c", program, str(folder)], stdout=subprocess.PIPE, text=True
    )
    assert teacher.stdout is not None
    try:
        first = teacher.stdout.readline()
        time.sleep(seconds)
    finally:
        teacher.send_signal(signal.SIGKILL)
        rest = teacher.stdout.read().split("\n")
        teacher.stdout.close()
        teacher.wait()
    return int([first, *rest][-2] or first)  # what follows the last newline is no number yet


KILLS = int(os.environ.get("HILT_KILLS", "4"))


@pytest.mark.parametrize("seed", range(KILLS // 2))
def test_kill_loses_nothing_that_was_acknowledged(tmp_path: Path, seed: int):
    """After kill -9 at a random moment, again and again, every acknowledged utterance is whole."""
    moments = random.Random(seed)  # noqa: S311 - nothing secret
    acknowledged = 0

    for _ in range(2):
        acknowledged = max(
            acknowledged, teach_and_kill(tmp_path / "kb", moments.uniform(0.05, 0.4))
        )

    with KnowledgeBase.open(tmp_path / "kb") as kb:
        last = kb.sequence
        assert acknowledged <= last <= acknowledged + 1
        assert [said.sequence for said in kb.history()] == list(range(1, last + 1))
        assert all(len(said.asserts) == 2 for said in kb.history())
        assert list(check_invariants(kb.store)) == []
        assert len(kb.rules(status="retracted")) == last - 1


def test_acknowledged_rule_is_there_without_closing(tmp_path: Path):
    """A process that just ends, without closing, has lost nothing."""
    program = TEACHER.replace("while True:", "for _ in range(3):") + "import os; os._exit(1)"
    subprocess.run(
        [sys.executable, "-c", program, str(tmp_path / "kb")], check=False, capture_output=True
    )

    with KnowledgeBase.open(tmp_path / "kb") as kb:
        assert kb.sequence == 3
        assert len(kb.rules()) + len(kb.rules(status="retracted")) == 6


def test_failed_write_leaves_the_base_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """When the store refuses, neither utterance nor rule nor number is there."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        high = Interval(0.95, 1)
        kb.believe("One.", "", "sam", [functional("knife", "cutting", interval=high)])

        def full(**_: object) -> None:
            raise OSError("No space left on device")

        monkeypatch.setattr(kb.store, "apply", full)
        with pytest.raises(OSError, match="No space"):
            kb.believe("Two.", "", "sam", [grasping("knife", "blade", interval=high)])
        monkeypatch.undo()

        assert (kb.sequence, len(kb.rules())) == (1, 1)
        assert kb.believe("Three.", "", "sam", []).sequence == 2


IMPORTER = """
import sys
from hilt.kb import Interval, KnowledgeBase, functional
kb = KnowledgeBase.open(sys.argv[1])
high = Interval(0.95, 1)
print(0, flush=True)
for size in range(1, 10_000):
    rules = [functional(f"thing {size} {n}", "cutting", interval=high) for n in range(400)]
    print(kb.believe("Many.", "", "sam", rules).sequence, flush=True)
"""


def test_kill_leaves_large_writes_whole(tmp_path: Path):
    """A unit of thousands of statements is there with all of them, or not at all."""
    moments = random.Random(7)  # noqa: S311 - nothing secret
    for number in range(max(2, KILLS // 3)):
        folder = tmp_path / f"kb{number // 5}"  # each is killed five times
        acknowledged = teach_and_kill(folder, moments.uniform(0.05, 0.5), IMPORTER)

        with KnowledgeBase.open(folder) as kb:
            assert acknowledged <= kb.sequence
            assert all(len(said.asserts) == 400 for said in kb.history())
            assert len(kb.rules()) == 400 * len({said.asserts for said in kb.history()})
            assert list(check_invariants(kb.store)) == []


# Imports tables that stream, for ever; prints the last number after each import.
STREAMER = """
import sys
from pathlib import Path
from hilt.kb import KnowledgeBase
from hilt.kb.formats import import_export
import_export.MAX_RULES = 100  # more than these stream
folder = Path(sys.argv[1])
kb = KnowledgeBase.open(folder)
print(kb.sequence, flush=True)
while True:
    table = folder.with_suffix(f".{kb.sequence}.csv")
    lines = [f"thing {kb.sequence} {n},pass,graspObject,handle,0.9" for n in range(RULES_OF_EACH)]
    table.write_text("\\n".join(["features,contexts,functor,argument,lower", *lines]))
    import_export.import_file(kb, table)
    table.unlink()
    print(kb.sequence, flush=True)
"""
RULES, TOLD = 2500, 3  # rules in each table, utterances that stand for them


@pytest.mark.parametrize("seed", range(KILLS // 2))
def test_kill_leaves_streamed_imports_whole(tmp_path: Path, seed: int):
    """All rules of a table are there with all their utterances, or none of either."""
    moments = random.Random(seed)  # noqa: S311 - nothing secret
    program = STREAMER.replace("RULES_OF_EACH", str(RULES))
    for _ in range(2):
        acknowledged = teach_and_kill(tmp_path / "kb", moments.uniform(0.05, 1.5), program)

        with KnowledgeBase.open(tmp_path / "kb") as kb:
            imports, rest = divmod(kb.sequence, TOLD)
            assert (acknowledged <= kb.sequence, rest) == (True, 0)
            assert [said.sequence for said in kb.history()] == list(range(1, kb.sequence + 1))
            assert len(list(scan_rules(kb.store))) == imports * RULES
            assert list(check_invariants(kb.store)) == []
            assert not list((tmp_path / "kb").glob("bulk-*"))  # parts of a load that was killed


def test_threads_teach_without_a_lost_sentence(tmp_path: Path):
    """Numbers are given once, and every rule is there; on disk, where the engine has no lock."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:

        def teach(name: str) -> None:
            for number in range(25):
                rule = functional(f"{name} {number}", "cutting", interval=Interval(0.95, 1))
                kb.believe(name, "", "sam", [rule])

        threads = [threading.Thread(target=teach, args=(f"thread {n}",)) for n in range(4)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()

        assert kb.sequence == len(kb.rules()) == len(list(kb.history())) == 100
        assert list(check_invariants(kb.store)) == []


FILLER = """
import resource, signal, sys
from hilt.kb import Interval, KnowledgeBase, functional
from hilt.ontology.errors import StoreError
kb = KnowledgeBase.open(sys.argv[1])
high = Interval(0.95, 1)
try:
    while True:
        number = kb.sequence + 1
        names = [f"{'x' * 60} {number} {n}" for n in range(50)]
        rules = [functional(name, "cutting", interval=high) for name in names]
        kb.believe("Many.", "", "sam", rules)
        print(number, flush=True)
except StoreError as error:
    print(error, flush=True)
print(len(kb.rules()), flush=True)
"""


@pytest.fixture
def small_disk(tmp_path: Path) -> Iterator[Path]:
    """A disk of 24 MB."""
    disk = tmp_path / "disk"
    disk.mkdir()
    command = ["mount", "-t", "tmpfs", "-o", "size=24m", "tmpfs", str(disk)]
    if (
        not shutil.which("mount")
        or subprocess.run(command, check=False, stderr=subprocess.DEVNULL).returncode
    ):
        pytest.skip("only who administers the system may mount a small disk")
    yield disk
    subprocess.run(["umount", "-l", str(disk)], check=True)


def test_full_disk_loses_nothing_that_was_acknowledged(small_disk: Path):
    """It is told in one line, reading goes on, and with room again so does teaching."""
    folder = small_disk / "kb"
    command = [sys.executable, "-c", FILLER, str(folder)]
    told = subprocess.check_output(command, text=True, timeout=120).splitlines()

    *numbers, said, rules = told
    assert "is full. The change was not written" in said and int(rules) >= 50 * len(numbers)
    shutil.copytree(folder, small_disk.parent / "kb")
    with KnowledgeBase.open(small_disk.parent / "kb") as kb:
        assert len(numbers) <= kb.sequence <= len(numbers) + 1
        assert list(check_invariants(kb.store)) == []
        kb.believe("Go on.", "", "sam", [functional("saw", "cutting", interval=Interval(0.9, 1))])
