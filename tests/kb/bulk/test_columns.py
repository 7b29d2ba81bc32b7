# SPDX-License-Identifier: Apache-2.0
"""Claims about tables that the engine's rows make: they say what the rules say."""

from __future__ import annotations

import csv
import io
from dataclasses import replace
from datetime import datetime, timezone
from itertools import cycle
from pathlib import Path
from typing import get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk import columns
from hilt.kb.bulk.columns import write_columns
from hilt.kb.formats.csv_table import write_table
from hilt.kb.formats.rule_yaml import write_row, write_sheet
from hilt.kb.rdf import rule_mapping
from hilt.kb.rule import Rule, Status
from hilt.kb.stores.base import Store
from hilt.kb.stores.oxigraph import open_folder, open_memory
from hilt.ontology.errors import ValidationError

from ..conftest import BLADE, CUTTING, HANDLE
from ..strategies import rules

TIMES = (None, datetime(2026, 11, 21, 9, 0, 0, 123_000, tzinfo=timezone.utc))


def written(store: Store) -> list[str]:
    """The lines of a table of a store."""
    table = io.StringIO()
    count = write_columns(store, table)
    lines = table.getvalue().splitlines()
    assert count == len(lines) - 1
    return lines


def expected(some: list[Rule]) -> list[str]:
    """The lines that the rules themselves give."""
    table = io.StringIO()
    write_table(some, table)
    return table.getvalue().splitlines()


@given(st.lists(rules, max_size=6, unique_by=lambda rule: rule.id))
@settings(deadline=None)
def test_columns_say_what_the_rules_say(some: list[Rule]):
    """Of every form, status and time, letter for letter."""
    statuses, times = cycle(get_args(Status)), cycle(TIMES)
    told = [replace(rule, status=next(statuses), time=next(times)) for rule in some]
    store = open_memory()
    store.apply(insert=[quad for rule in told for quad in rule_mapping.rule_quads(rule)])

    lines = written(store)

    assert lines[0] == expected([])[0]
    assert sorted(lines) == sorted(expected(told))
    rows = [write_row(row) for row in csv.reader(lines[1:])]
    assert sorted(rows) == sorted(line for line in write_sheet(told) if line.startswith(" "))


def test_order_is_that_of_the_base_and_not_of_its_making(tmp_path: Path):
    """Equal bases give equal tables."""
    some = [BLADE, CUTTING, replace(HANDLE, status="retracted")]
    tables: list[list[str]] = []
    for number, order in enumerate([some, some[::-1]]):
        with_store = open_folder(tmp_path / str(number))
        for rule in order:
            with_store.apply(insert=rule_mapping.rule_quads(rule))
        tables.append(written(with_store))
        with_store.close()

    assert tables[0] == tables[1]


@pytest.mark.parametrize("lost", [rule_mapping.FUNCTOR, rule_mapping.LOWER, rule_mapping.STATUS])
def test_rule_that_is_not_whole_is_told(lost: object):
    """It is never left out in silence."""
    store = open_memory()
    store.apply(insert=[q for q in rule_mapping.rule_quads(BLADE) if q.predicate != lost])

    with pytest.raises(ValidationError, match=f"{BLADE.id}>: a rule is not whole"):
        written(store)


def test_rule_with_two_bounds_is_told(tmp_path: Path):
    """Nothing is chosen among them."""
    store = open_folder(tmp_path / "base")
    twice = replace(BLADE, interval=replace(BLADE.interval, lower=0.5))
    node = rule_mapping.rule_iri(BLADE.id)
    other = [
        q._replace(subject=node)
        for q in rule_mapping.property_quads(twice)
        if q.predicate == rule_mapping.LOWER
    ]
    store.apply(insert=[*rule_mapping.rule_quads(BLADE), *other])

    with pytest.raises(ValidationError, match="something twice"):
        written(store)
    store.close()


def test_progress_is_told(monkeypatch: pytest.MonkeyPatch):
    """How many rules are written."""
    monkeypatch.setattr(columns, "_TOLD", 1)
    store, heard = open_memory(), list[int]()
    store.apply(insert=[*rule_mapping.rule_quads(BLADE), *rule_mapping.rule_quads(CUTTING)])

    write_columns(store, io.StringIO(), heard.append)

    assert heard == [1, 2]


def test_a_file_that_takes_no_more_is_the_files_fault():
    """Told as that, not as a fault of the store."""

    class Full(io.StringIO):
        def write(self, text: str) -> int:
            if "knife" in text:
                raise OSError(28, "No space left on device")
            return super().write(text)

    store = open_memory()
    store.apply(insert=rule_mapping.rule_quads(BLADE))

    with pytest.raises(OSError, match="No space left on device"):
        write_columns(store, Full())
