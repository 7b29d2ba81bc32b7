# SPDX-License-Identifier: Apache-2.0
"""Claims about going through a store once: every statement comes, as it stands there."""

from __future__ import annotations

import io
import tempfile
from dataclasses import replace
from datetime import datetime, timezone
from decimal import Decimal
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk.exporter import dump_statements
from hilt.kb.bulk.scanning import NUMBERS, TAILS
from hilt.kb.formats.registry import FORMATS
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.rule_mapping import BELIEFS
from hilt.kb.rdf.terms import Literal, Quad, Term, as_sparql
from hilt.kb.stores.oxigraph import open_folder
from hilt.kb.stores.rdf_text import read_rdf
from hilt.ontology.vocabulary import Iri, iri, term

from ..conftest import BLADE, CUTTING

HISTORY, NODE = iri("graph", "history"), iri("object", "knife")
TIME = datetime(2026, 11, 21, 9, tzinfo=timezone.utc)
NODES = st.sampled_from(
    [
        NODE,
        iri("object", "a b"),
        iri("object", "1"),
        rule_mapping.rule_iri("rule/3f9c"),
        Iri("urn:x:1"),
    ]
)
KEYS = st.sampled_from([*(tail.key for tail in TAILS), term("x"), Iri("urn:x:2")])
VALUES: st.SearchStrategy[Term] = st.one_of(
    NODES,
    st.sampled_from([tail.value for tail in TAILS if tail.value]),
    st.text(st.characters(codec="utf-8", exclude_characters="\0"), max_size=5),
    *(st.booleans(), st.integers(-9, 9), st.just(TIME), st.sampled_from([0.5, 1e30])),
    st.decimals(0, 1, places=2).map(Decimal.normalize),
    st.sampled_from([Literal("messer", language="de"), Literal("x", "urn:t")]),
)
STATEMENTS = st.lists(
    st.builds(Quad, NODES, KEYS, VALUES, st.sampled_from([BELIEFS, HISTORY])), max_size=8
)


def written(quads: list[Quad], form: str, *, rules_only: bool = False) -> tuple[list[Quad], int]:
    """The statements of a large store, read from what was written of it, and how many it says."""
    stream = io.BytesIO()
    with tempfile.TemporaryDirectory() as folder:
        store = open_folder(Path(folder) / "base")
        store.apply(insert=quads)
        count = dump_statements(store, stream, FORMATS[form], None, rules_only=rules_only)
        store.close()
    stream.seek(0)
    found = read_rdf(stream, format=form, source="x", default=BELIEFS)
    return [quad for quad in found if isinstance(quad, Quad)], count


def spelled(quads: list[Quad]) -> set[tuple[str, ...]]:
    """Statements as they are written."""
    return {tuple(as_sparql(one) for one in quad if one is not None) for quad in quads}


@pytest.mark.parametrize("form", ["nquads", "trig"])
@given(STATEMENTS)
@settings(deadline=None, max_examples=20)
def test_every_statement_of_every_form_is_written(form: str, quads: list[Quad]):
    """Names and values as the store has them, whether they have a number or not."""
    found, count = written(quads, form)

    assert spelled(found) == spelled(quads)  # in Python, True is 1
    assert count == len(spelled(found))


@pytest.mark.parametrize("form", ["ntriples", "turtle", "nquads", "trig"])
def test_rules_come_with_what_told_them(form: str):
    """And without all other history."""
    told = replace(BLADE, utterance=7)
    said = [
        Quad(iri("utterance", number), rule_mapping.LABEL, "It is so.", HISTORY)
        for number in ("7", "8")
    ]
    quads = [*rule_mapping.rule_quads(told), *rule_mapping.rule_quads(CUTTING), *said]

    found, _ = written(quads, form, rules_only=True)

    graph = None if form in {"ntriples", "turtle"} else said[0].graph
    expected = {*quads} - {said[1]}
    assert {quad._replace(graph=graph or BELIEFS) for quad in found} == {
        quad._replace(graph=graph or BELIEFS) for quad in expected
    }


def test_numbers_are_of_one_tail_each():
    """So that what is read is what was asked for."""
    assert len(NUMBERS) == len(TAILS)
