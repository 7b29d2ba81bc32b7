"""Claims about queries that are stopped."""

from __future__ import annotations

import math
import threading
import time
from pathlib import Path

import pytest

from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import functional
from hilt.kb.sparql.results import BooleanResult, QueryLimits, SelectResult
from hilt.ontology.errors import QueryError

from ..conftest import BLADE, CUTTING, HIGH, teach

CROSS = "SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l . ?m ?n ?o } ORDER BY ?a ?o"
COUNT = CROSS.replace("*", "(COUNT(*) AS ?n)").partition(" ORDER")[0]  # slow, and of little memory
USES = "SELECT ?s { ?s hilt:usedFor ?o } ORDER BY ?s"
PLENTY = QueryLimits(seconds=20)


@pytest.fixture(params=["memory", "folder"])
def told(request: pytest.FixtureRequest, tmp_path: Path):
    """A base that knows a little."""
    with KnowledgeBase.open("memory:" if request.param == "memory" else tmp_path / "kb") as kb:
        teach(kb, BLADE, CUTTING)
        yield kb


def test_bounded_query_finds_the_same(told: KnowledgeBase):
    """In the other process as in this one, of every form."""
    for text in (USES, "ASK { ?s hilt:usedFor ?o }", "CONSTRUCT WHERE { ?s hilt:usedFor ?o }"):
        assert told.query(text, limits=PLENTY) == told.query(text)


def test_bounded_query_sees_what_was_just_told(told: KnowledgeBase):
    """Each one sees the base as it is when it is asked."""
    before = told.query(USES, limits=PLENTY)
    teach(told, functional("saw", "cutting", interval=HIGH))

    after = told.query(USES, limits=PLENTY)

    assert isinstance(before, SelectResult) and isinstance(after, SelectResult)
    assert (len(before), len(after)) == (1, 2)


@pytest.mark.parametrize(
    "limits", [(0, 1), (-1, 1), (math.nan, 1), (math.inf, 1), (1, 0), (1, 10**15)]
)
def test_limits_that_cannot_be_kept_are_refused(limits: tuple[float, int]):
    """No time, endless time, no memory, more memory than there is anywhere."""
    with pytest.raises(QueryError, match=r"The (time|memory) of a query is"):
        QueryLimits(*limits)


def test_query_that_is_nested_too_deeply_is_stopped(told: KnowledgeBase):
    """It takes the other process with it, not this one."""
    deep = f"ASK {{ FILTER({'(' * 20_000}1{')' * 20_000}) }}"

    with pytest.raises(QueryError, match="nested too deeply"):
        told.query(deep, limits=PLENTY)
    assert told.query("ASK { ?s ?p ?o }", limits=PLENTY) == BooleanResult(True)


def test_query_that_takes_too_long_is_stopped(told: KnowledgeBase):
    """In time, and the next one is answered."""
    start = time.monotonic()

    with pytest.raises(QueryError, match=r"longer than 0\.7 s and was stopped"):
        told.query(CROSS, limits=QueryLimits(seconds=0.7))

    assert time.monotonic() - start < 5
    assert told.query("ASK { ?s ?p ?o }", limits=PLENTY) == BooleanResult(True)


def test_query_that_takes_too_much_memory_is_stopped(told: KnowledgeBase):
    """The process that works on it ends, not this one."""
    with pytest.raises(QueryError, match="more than 30 MB and was stopped"):
        told.query(CROSS, limits=QueryLimits(seconds=60, megabytes=30))

    assert told.query("ASK { ?s ?p ?o }", limits=PLENTY) == BooleanResult(True)


@pytest.mark.parametrize(
    "text", ["SELECT WHERE", "SELECT * { SERVICE <urn:x> {} }", "DROP ALL", ""]
)
def test_wrong_query_is_told_as_ever(told: KnowledgeBase, text: str):
    """Mistakes and what reaches outside are refused with the same words."""
    with pytest.raises(QueryError) as bounded:
        told.query(text, limits=PLENTY)
    with pytest.raises(QueryError) as direct:
        told.query(text)

    assert str(bounded.value) == str(direct.value)


def test_base_is_written_while_a_query_runs(tmp_path: Path):
    """A long query holds up nobody, and sees the base as it was."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        teach(kb, CUTTING)
        ended: list[str] = []

        def ask() -> None:
            try:
                kb.query(COUNT, limits=QueryLimits(seconds=1.5))
            except QueryError as error:
                ended.append(str(error))

        asking = threading.Thread(target=ask)
        asking.start()
        start = time.monotonic()
        for number in range(20):
            teach(kb, functional(f"thing {number}", "cutting", interval=HIGH))
        took = time.monotonic() - start
        asking.join()

    assert took < 1.4
    assert "longer than 1.5 s" in ended[0]
    assert not (tmp_path / "kb" / "snapshots").exists()
