"""Claims about exports: every statement and every rule is written, as it stands in the base."""

from __future__ import annotations

import io
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from datetime import datetime, timezone
from decimal import Decimal
from itertools import cycle
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import cast, get_args

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk import exporter
from hilt.kb.bulk.exporter import scan_rules
from hilt.kb.formats import import_export
from hilt.kb.formats.import_export import write_base
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.rule_mapping import BELIEFS
from hilt.kb.rdf.terms import Literal, Quad, Term, as_sparql, ungrouped
from hilt.kb.rule import Rule, Status
from hilt.kb.stores.base import Store
from hilt.kb.stores.oxigraph import open_folder, open_memory
from hilt.kb.stores.rdf_text import read_groups
from hilt.ontology.errors import ValidationError
from hilt.ontology.vocabulary import Iri, iri, term

from ..conftest import BLADE, CUTTING, HANDLE
from ..strategies import rules

HISTORY = iri("graph", "history")
TIME = datetime(2026, 11, 21, 9, tzinfo=timezone.utc)
TIMES = (None, TIME.replace(microsecond=123_000))
NODES = st.sampled_from(
    [*(iri("object", name) for name in ("knife", "a b", "1")), iri("rule", "3f9c"), Iri("urn:x:1")]
)
KEYS = st.sampled_from(
    [rule_mapping.TYPE, rule_mapping.STATUS, rule_mapping.DERIVED_FROM, term("x"), Iri("urn:x:2")]
)
VALUES: st.SearchStrategy[Term] = st.one_of(
    NODES,
    st.sampled_from([*rule_mapping.CLASSES.values(), term("active")]),
    st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=5),
    *(st.booleans(), st.integers(-9, 9), st.just(TIME), st.sampled_from([0.5, 1e30])),
    st.decimals(0, 1, places=2).map(Decimal.normalize),
    st.sampled_from([Literal("messer", language="de"), Literal("x", "urn:t")]),
)
STATEMENTS = st.lists(
    st.builds(Quad, NODES, KEYS, VALUES, st.sampled_from([BELIEFS, HISTORY])), max_size=8
)
KINDS = ["large folder", "memory", "endpoint"]


class PlainStore:
    """A store that gives statements and writes no rows, as those behind an endpoint."""

    def __init__(self, store: Store) -> None:
        self.quads, self.select, self.writing = store.quads, store.select, store.writing


@contextmanager
def filled(kind: str, quads: list[Quad]) -> Iterator[Store]:
    """A store with some statements."""
    with TemporaryDirectory() as folder, pytest.MonkeyPatch.context() as patch:
        is_large = kind == "large folder"
        patch.setattr(exporter, "MAX_SORTED", 0 if is_large else 200_000)
        store = open_folder(Path(folder) / "base") if is_large else open_memory()
        store.apply(insert=quads)
        yield cast(Store, PlainStore(store)) if kind == "endpoint" else store
        store.close()


def written(
    kind: str, quads: list[Quad], form: str, *, rules_only: bool = False
) -> tuple[set[tuple[str, ...]], int]:
    """The statements that are read from an export, spelled out, and how many it counts."""
    stream = io.BytesIO()
    with filled(kind, quads) as store:
        count = write_base(store, stream, format=form, rules_only=rules_only)
    stream.seek(0)
    found = ungrouped(read_groups(stream, format=form, source="x", default=BELIEFS))
    return spelled(quad for quad in found if isinstance(quad, Quad)), count


def spelled(quads: Iterator[Quad]) -> set[tuple[str, ...]]:
    """Statements as they are written."""
    return {tuple(as_sparql(one) for one in quad if one is not None) for quad in quads}


def scanned(store: Store) -> list[Rule]:
    """The rules of a store as an export passes them on."""
    return list(scan_rules(store))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("form", ["nquads", "trig"])
@given(STATEMENTS)
@settings(deadline=None, max_examples=15)
def test_every_statement_of_every_form_is_written(kind: str, form: str, quads: list[Quad]):
    """Whatever its terms are."""
    found, count = written(kind, quads, form)

    assert found == spelled(iter(quads))
    assert count == len(found)


@pytest.mark.parametrize("kind", KINDS)
def test_turtle_abbreviates_datatypes(kind: str):
    """A datatype is written with its prefix."""
    stream = io.BytesIO()
    quad = Quad(iri("object", "knife"), term("x"), TIME, BELIEFS)

    with filled(kind, [quad]) as store:
        write_base(store, stream, format="turtle")

    assert b'"2026-11-21T09:00:00Z"^^xsd:dateTime' in stream.getvalue()


@pytest.mark.parametrize("form", ["ntriples", "turtle"])
@given(STATEMENTS)
@settings(deadline=None, max_examples=15)
def test_formats_without_graphs_have_the_rules_and_their_sources(form: str, quads: list[Quad]):
    """The rest of the history is left out."""
    found, _ = written("large folder", quads, form, rules_only=True)

    sources = {
        quad.object for quad in quads
        if (quad.graph, quad.predicate) == (BELIEFS, rule_mapping.DERIVED_FROM)
    }  # fmt: skip
    expected = [q for q in quads if q.graph == BELIEFS or q.subject in sources]
    assert found == spelled(quad._replace(graph=BELIEFS) for quad in expected)


@pytest.mark.parametrize("kind", KINDS)
@given(st.lists(rules, max_size=6, unique_by=lambda rule: rule.id))
@settings(deadline=None, max_examples=20)
def test_rules_are_those_of_the_naive_mapping(kind: str, some: list[Rule]):
    """Of every form, status and time."""
    statuses, times = cycle(cast("list[Status]", get_args(Status))), cycle(TIMES)
    some = [replace(rule, status=next(statuses), time=next(times)) for rule in some]

    with filled(kind, [quad for rule in some for quad in rule_mapping.rule_quads(rule)]) as store:
        found = scanned(store)

    assert sorted(found, key=lambda rule: rule.id) == sorted(some, key=lambda rule: rule.id)


def test_order_is_that_of_the_base_and_not_of_its_making():
    """Equal bases give equal exports, large ones too."""
    some = [BLADE, CUTTING, replace(HANDLE, status="retracted")]
    orders: list[list[Rule]] = []
    for order in (some, some[::-1]):
        quads = [quad for rule in order for quad in rule_mapping.rule_quads(rule)]
        with filled("large folder", quads) as store:
            orders.append(scanned(store))

    assert orders[0] == orders[1]


@pytest.mark.parametrize("lost", [rule_mapping.FUNCTOR, rule_mapping.LOWER, rule_mapping.STATUS])
def test_incomplete_rule_is_reported(lost: object):
    """It is never left out in silence."""
    some = [quad for quad in rule_mapping.rule_quads(BLADE) if quad.predicate != lost]

    with (
        filled("memory", some) as store,
        pytest.raises(ValidationError, match=f"{BLADE.id}>: A rule has no"),
    ):
        scanned(store)


def test_rule_with_two_bounds_is_reported():
    """Neither of them is chosen."""
    node = rule_mapping.rule_iri(BLADE.id)
    more = Quad(node, rule_mapping.LOWER, Decimal("0.5"), BELIEFS)

    with (
        filled("memory", [*rule_mapping.rule_quads(BLADE), more]) as store,
        pytest.raises(ValidationError, match="stands there 2 times"),
    ):
        scanned(store)


def test_progress_is_reported(monkeypatch: pytest.MonkeyPatch):
    """As the number of the statements that are done."""
    monkeypatch.setattr(import_export, "_STEP", 1)
    heard: list[int] = []

    some = [quad for rule in (BLADE, CUTTING) for quad in rule_mapping.rule_quads(rule)]
    with filled("memory", some) as store:
        count = write_base(store, io.BytesIO(), format="nquads", progress=heard.append)

    assert heard[-1] == count == len(set(some))


def test_full_disk_is_blamed_on_the_file():
    """And not on the store that is written."""

    class Full(io.BytesIO):
        def write(self, data: object) -> int:
            raise OSError(28, "No space left on device")

    with (
        filled("large folder", list(rule_mapping.rule_quads(BLADE))) as store,
        pytest.raises(OSError, match="No space left on device"),
    ):
        write_base(store, Full(), format="nquads")
