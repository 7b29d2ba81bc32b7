"""Processes that share an endpoint, and processes that are killed there."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

import pytest

from hilt.kb.backup import backup, restore
from hilt.kb.formats.import_export import export_file
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Rule, functional
from hilt.kb.stores.http import PASSWORD, USER
from hilt.kb.validation import check_invariants

from . import endpoints

SERVERS = {"oxigraph server": endpoints.oxigraph, "virtuoso": endpoints.virtuoso}
READY = "ready"

_TELL = """
import sys
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import functional

location, who, count = sys.argv[1:]
with KnowledgeBase.open(location) as base:
    print("ready", flush=True)
    sys.stdin.readline()
    for number in range(int(count)):
        rule = functional(f"thing {number % 10}", "cutting", interval=Interval(0.5, 1))
        said = base.believe(f"{who} says {number}.", "", "sam", [rule])
        print(said.sequence, said.text, sep="|", flush=True)
"""
_JOB = """
import sys
from pathlib import Path
from hilt.kb.backup import restore
from hilt.kb.bulk.importer import merge
from hilt.kb.formats.import_export import import_file
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.sparql_update import update
from hilt.kb.stores.opening import open_store

job, location, given = sys.argv[1:]
jobs = {
    "import": lambda base: import_file(base, given),
    "merge": lambda base: merge(base, other, source=given),
    "restore": lambda base: restore(Path(given), location, replace=True),
    "update": lambda base: update(base, given),
}
with KnowledgeBase.open(location) as base:
    other = open_store(given, read_only=True) if job == "merge" else None
    print("ready", flush=True)
    jobs[job](base)
    print("done", flush=True)
"""
_RETRACT_ALL = """
DELETE { GRAPH graph:beliefs { ?rule hilt:status hilt:active } }
INSERT { GRAPH graph:beliefs { ?rule hilt:status hilt:retracted } }
WHERE { GRAPH graph:beliefs { ?rule hilt:status hilt:active } }
"""


@contextmanager
def served(name: str) -> Generator[str]:
    """Run a server for the block, and name the location of an empty base there."""
    with (
        tempfile.TemporaryDirectory() as folder,
        pytest.MonkeyPatch.context() as patch,
        SERVERS[name](Path(folder) / "data") as found,
    ):
        patch.setenv(USER, found.user)
        patch.setenv(PASSWORD, found.password)
        KnowledgeBase.open(found.location).close()
        yield found.location


@dataclass(frozen=True)
class Told:
    """What processes told.

    Attributes:
        acknowledged: number and text of each sentence.
        seconds: from the first sentence to the end of the last process.
    """

    acknowledged: Sequence[tuple[int, str]]
    seconds: float


def tell_together(location: str, processes: int, sentences: int, *, kill: bool = False) -> Told:
    """Tell one base so many sentences by processes at the same time.

    With `kill` the first process is killed in the middle.
    """
    each = sentences // processes
    running = [
        _started(_TELL, location, f"robot {number}", str(each)) for number in range(processes)
    ]
    for one in running:
        assert one.stdout and one.stdout.readline().strip() == READY
    start = time.monotonic()
    for one in running:
        assert one.stdin
        one.stdin.write("go\n")
        one.stdin.flush()
    lines = list[str]()
    if kill:
        assert running[0].stdout
        lines += [running[0].stdout.readline() for _ in range(each // 2)]
        running[0].kill()
    for one in running:
        lines += one.communicate()[0].splitlines()
    found = [line.strip().partition("|") for line in lines if "." in line]
    numbered = [(int(number), text) for number, _, text in found]
    return Told(numbered, time.monotonic() - start)


def check_told(location: str, told: Told) -> None:
    """Assert that each acknowledged sentence is there once, under its number, in a sound base."""
    with KnowledgeBase.open(location) as base:
        there = [(said.sequence, said.text) for said in base.history()]
        check(base)
    assert set(told.acknowledged) <= set(there)
    assert len(told.acknowledged) == len({number for number, _ in told.acknowledged})
    assert len(there) == len({text for _, text in there})


def check(base: KnowledgeBase) -> None:
    """Assert that a base is valid, and each rule asserted by the utterance it derives from."""
    assert not list(check_invariants(base.store))
    said = {one.sequence: one for one in base.history()}
    assert base.sequence == max(said, default=0)
    for rule in base.rules(status=None):
        assert rule.utterance and rule.id in said[rule.utterance].asserts


@dataclass(frozen=True)
class Job:
    """What a process is killed at.

    Attributes:
        given: the file or folder that it reads, or an update.
        before, after: ids of the active rules.
    """

    given: str
    before: frozenset[str]
    after: frozenset[str]


def prepare_jobs(folder: Path, rules: int) -> Mapping[str, Job]:
    """The jobs for a base with `rules` rules, which are in `folder`/old, and as many others."""
    old, new = (frozenset(_rule(n).id for n in range(i, i + rules)) for i in (0, rules))
    for name, first in (("old", 0), ("new", rules)):
        with KnowledgeBase.open(folder / f"{name} base") as base:
            told = [_rule(number) for number in range(first, first + rules)]
            base.believe(f"The {name} ones.", "", "sam", told[::2])
            base.believe(f"More {name} ones.", "", "sam", told[1::2])
            export_file(base, str(folder / f"{name}.nq"))
            backup(base, folder / name)
    return {
        "import": Job(str(folder / "new.nq"), old, old | new),
        "merge": Job(str(folder / "new"), old, old | new),
        "restore": Job(str(folder / "new"), old, new),
        "update": Job(_RETRACT_ALL, old, frozenset()),
    }


def kill_job(location: str, name: str, job: Job, after_s: float | None = None) -> tuple[str, float]:
    """Kill a job so many seconds after its start; or never, without a time.

    Returns what is found ("before" or "after") and how long the job ran [s]; asserts that the base
    is one of both, and sound. It has the state before when this is called.
    """
    process = _started(_JOB, name, location, job.given)
    assert process.stdout and process.stdout.readline().strip() == READY
    start = time.monotonic()
    if after_s is not None:
        time.sleep(after_s)
        process.kill()
    done = "done" in process.communicate()[0]
    seconds = time.monotonic() - start
    with KnowledgeBase.open(location) as base:
        check(base)
        there = {one.id for one in base.rules()}
    found = {job.before: "before", job.after: "after"}.get(frozenset(there), "neither")
    assert found == "after" or (found == "before" and not done), f"{len(there)} rules"
    return found, seconds


def reset(location: str, folder: Path) -> None:
    """Put the state before the jobs back."""
    restore(folder / "old", location, replace=True)


def _rule(number: int) -> Rule:
    return functional(f"thing {number}", "cutting", interval=Interval(0.5, 1))


def _started(program: str, *arguments: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-c", program, *arguments]
    return subprocess.Popen(
        command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, env=dict(os.environ)
    )
