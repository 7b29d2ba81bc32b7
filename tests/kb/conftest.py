"""Bases and rules that the tests of the knowledge base share."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from datetime import datetime, timedelta, timezone
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest

from hilt.kb.bulk.reconciliation import ImportSummary
from hilt.kb.formats.import_export import import_file
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import Rule, functional, grasping
from hilt.kb.stores.base import Store
from hilt.kb.stores.opening import open_store

HIGH = Interval(0.95, 1)
CUTTING = functional("knife", "cutting", interval=HIGH)
HANDLE = grasping("knife", "handle", "pickUp", interval=HIGH)
BLADE = grasping("knife", "blade", "pass", interval=HIGH)
PAPER = (  # the three utterances of section 3.3
    ("A knife is used for cutting", "implies(knife,cutting,high)", CUTTING),
    (
        "To pickup a knife grab the knife by the handle",
        "implies(pickUp(self,knife),graspObject(self,partOf(handle,knife)),high)",
        HANDLE,
    ),
    (
        "To pass a knife grab the knife by the blade",
        "implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high)",
        BLADE,
    ),
)
START = datetime(2026, 11, 21, 9, tzinfo=timezone.utc)


def ticking() -> Callable[[], datetime]:
    """A clock that goes on by a second whenever it is read."""
    seconds = count()
    return lambda: START + timedelta(seconds=next(seconds))


def import_text(
    base: KnowledgeBase, data: bytes, *, format: str, source: str = "text", dry_run: bool = False
) -> ImportSummary:
    """Import a file of a name with some content."""
    with TemporaryDirectory() as folder:
        file = Path(folder) / source
        file.write_bytes(data)
        return import_file(base, file, format=format, dry_run=dry_run)


def teach(kb: KnowledgeBase, *rules: Rule, speaker: str = "sam") -> None:
    """Tell rules, an utterance each."""
    for rule in rules:
        kb.believe(f"Rule {rule.id}.", "implies(x,y,high)", speaker, [rule])


@pytest.fixture(params=["memory", "folder"])
def store(request: pytest.FixtureRequest, tmp_path: Path) -> Iterator[Store]:
    """An empty store of every kind there is."""
    opened = open_store("memory:" if request.param == "memory" else tmp_path / "store")
    yield opened
    opened.close()


@pytest.fixture
def kb() -> Iterator[KnowledgeBase]:
    """An empty base in memory, with a clock of its own."""
    with KnowledgeBase(open_store("memory:"), clock=ticking()) as base:
        yield base


@pytest.fixture
def paper(kb: KnowledgeBase) -> KnowledgeBase:
    """A base that was told the paper's three sentences."""
    for text, predicate, rule in PAPER:
        kb.believe(text, predicate, "sam", [rule])
    return kb
