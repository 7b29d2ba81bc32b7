"""Claims about backups, and about reading a base that another process has open."""

from __future__ import annotations

import os
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from hilt.kb.backup import backup, restore
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import functional
from hilt.kb.stores import directory
from hilt.kb.stores.directory import replaced_place
from hilt.kb.stores.opening import open_store
from hilt.kb.validation import check_invariants
from hilt.ontology.errors import InUseError, StoreError

from .conftest import BLADE, CUTTING, HIGH, teach
from .stores.test_durability import TEACHER


@pytest.mark.parametrize("kind", ["memory", "folder"])
def test_backup_holds_the_base_as_it_is(tmp_path: Path, kind: str):
    """Whatever is told afterwards is not in it; the base goes on."""
    with KnowledgeBase.open("memory:" if kind == "memory" else tmp_path / "kb") as kb:
        teach(kb, CUTTING)
        assert backup(kb, tmp_path / "backup") == 1
        before = set(kb.store.quads())
        teach(kb, BLADE)

    with KnowledgeBase.open(tmp_path / "backup") as saved:
        assert set(saved.store.quads()) == before


def test_backup_is_whole_while_others_teach(tmp_path: Path):
    """Taken in the middle of teaching, each one is a lawful base."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        stop = threading.Event()

        def go_on() -> None:
            number = 0
            while not stop.is_set():
                number += 1
                teach(kb, functional(f"thing {number}", "cutting", interval=HIGH))

        teaching = threading.Thread(target=go_on)
        teaching.start()
        numbers = [backup(kb, tmp_path / f"backup{one}") for one in range(4)]
        stop.set()
        teaching.join()

    assert numbers == sorted(numbers)
    for one in range(4):
        with KnowledgeBase.open(tmp_path / f"backup{one}", read_only=True) as saved:
            assert list(check_invariants(saved.store)) == []
            assert len(saved.rules()) == saved.sequence == numbers[one]


def test_backup_never_overwrites(tmp_path: Path):
    """What is there stays there."""
    (tmp_path / "mine").mkdir()

    with KnowledgeBase.open("memory:") as kb, pytest.raises(StoreError, match="is there already"):
        backup(kb, tmp_path / "mine")


def test_restored_base_is_what_was_saved(tmp_path: Path):
    """In the place of another one only when that is said."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        teach(kb, CUTTING)
        backup(kb, tmp_path / "backup")
        teach(kb, BLADE)

    with pytest.raises(StoreError, match="holds a knowledge base"):
        restore(tmp_path / "backup", str(tmp_path / "kb"))
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        assert kb.sequence == 2
    assert restore(tmp_path / "backup", str(tmp_path / "kb"), replace=True) == 1
    assert restore(tmp_path / "backup", str(tmp_path / "new" / "kb")) == 1

    for folder in (tmp_path / "kb", tmp_path / "new" / "kb"):
        with KnowledgeBase.open(folder) as kb:
            assert [rule.id for rule in kb.rules()] == [CUTTING.id]
    assert sorted(p.name for p in tmp_path.iterdir()) == ["backup", "kb", "new"]


def test_base_in_use_is_not_replaced(tmp_path: Path):
    """Its owner would go on writing into nothing."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        backup(kb, tmp_path / "backup")

        with pytest.raises(InUseError):
            restore(tmp_path / "backup", str(tmp_path / "kb"), replace=True)


def test_broken_backup_is_not_restored(tmp_path: Path):
    """The base that is there is not touched."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        backup(kb, tmp_path / "backup")
        teach(kb, CUTTING)
    (tmp_path / "backup" / "CURRENT").write_bytes(b"garbage")

    with pytest.raises(StoreError, match="is damaged"):
        restore(tmp_path / "backup", str(tmp_path / "kb"), replace=True)

    with KnowledgeBase.open(tmp_path / "kb") as kb:
        assert kb.sequence == 1


def test_crash_while_restoring_brings_the_old_base_back(tmp_path: Path):
    """Between taking one away and putting the other there, the old one is only renamed."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        teach(kb, CUTTING)
    (tmp_path / "kb").rename(replaced_place(tmp_path / "kb"))

    with KnowledgeBase.open(tmp_path / "kb") as kb:
        assert kb.sequence == 1


def test_second_process_reads_while_the_first_one_teaches(tmp_path: Path):
    """It sees a whole base with everything that was acknowledged before, again and again."""
    teacher = subprocess.Popen(
        [sys.executable, "-c", TEACHER, str(tmp_path / "kb")], stdout=subprocess.PIPE, text=True
    )
    assert teacher.stdout is not None
    try:
        for _ in range(12):
            for _ in range(5):
                acknowledged = int(teacher.stdout.readline())
            with KnowledgeBase.open(tmp_path / "kb", read_only=True) as reading:
                assert reading.sequence >= acknowledged
                assert list(check_invariants(reading.store)) == []
                assert all(len(said.asserts) == 2 for said in reading.history())
        with pytest.raises(InUseError, match="in use by another process"):
            open_store(tmp_path / "kb")
    finally:
        teacher.kill()
        teacher.stdout.close()
        teacher.wait()


def test_what_a_killed_reader_left_is_removed(tmp_path: Path):
    """When the owner opens the folder the next time; a living reader's is kept."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        teach(kb, CUTTING)
    stale = tmp_path / "kb" / directory.SNAPSHOTS / "999999999-x"
    stale.mkdir(parents=True)
    alive = tmp_path / "kb" / directory.SNAPSHOTS / f"{os.getpid()}-x"
    alive.mkdir()

    with KnowledgeBase.open(tmp_path / "kb"):
        assert not stale.exists() and alive.exists()


def test_snapshot_can_be_bounded_and_copied(tmp_path: Path):
    """Who only reads can ask what may have to be stopped, and make backups."""
    from hilt.kb.sparql.results import BooleanResult, QueryLimits

    with KnowledgeBase.open(tmp_path / "kb") as kb:
        teach(kb, CUTTING)
        with KnowledgeBase.open(tmp_path / "kb", read_only=True) as reading:
            teach(kb, BLADE)
            assert reading.query(
                "ASK { ?s hilt:graspedBy ?o }", limits=QueryLimits()
            ) == BooleanResult(False)
            assert backup(reading, tmp_path / "backup") == 1

    assert not (tmp_path / "kb" / directory.SNAPSHOTS).exists()


def test_killed_restore_leaves_nothing_for_long(tmp_path: Path):
    """What it had prepared is removed when the base is opened next, but not of one that runs."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        backup(kb, tmp_path / "saved")
    program = """
import os, sys
from pathlib import Path
from hilt.kb import backup
backup._sync = lambda folder: os._exit(1)
backup.restore(Path(sys.argv[1]), sys.argv[2], replace=True)
"""
    ended = subprocess.run(
        [sys.executable, "-c", program, str(tmp_path / "saved"), str(tmp_path / "kb")], check=False
    )
    assert ended.returncode == 1
    (left,) = tmp_path.glob(".kb.*")
    running = tmp_path / f".kb.unfinished-{os.getpid()}-x"
    running.mkdir()

    KnowledgeBase.open(tmp_path / "kb").close()

    assert not left.exists() and running.exists()
