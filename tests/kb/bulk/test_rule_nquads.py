"""Claims about rules as lines of N-Quads: they are what the naive mapping writes."""

from __future__ import annotations

import io
from collections.abc import Iterator
from dataclasses import replace
from datetime import datetime, timezone

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk.rule_nquads import NQuadsWriter
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.rule_mapping import BELIEFS, rule_quads
from hilt.kb.rdf.terms import StatementGroup, Statements, ungrouped
from hilt.kb.rule import Rule
from hilt.kb.stores.rdf_text import read_groups, write_rdf
from hilt.ontology.errors import ValidationError

from ..conftest import BLADE
from ..strategies import rules

TIMES = st.none() | st.just(datetime(2026, 11, 21, 9, tzinfo=timezone.utc))
STATUSES = st.sampled_from(["active", "retracted", "superseded", "induced"])
RULES = st.builds(
    lambda rule, status, utterance, time: replace(
        rule, status=status, utterance=utterance, time=time
    ),
    *(rules, STATUSES, st.none() | st.integers(1, 99), TIMES),
)


def groups(some: list[Rule]) -> Iterator[Statements]:
    """The lines about rules as a file has them."""
    quads = (quad for rule in some for quad in rule_mapping.property_quads(rule))
    stream = io.BytesIO(write_rdf(quads, format="nquads"))
    return read_groups(stream, format="nquads", source="x", default=BELIEFS)


def written(some: list[Rule]) -> set[object]:
    """The statements that are written of rules."""
    writer = NQuadsWriter()
    for rule in some:
        writer.write_rule(rule)
    stream = io.BytesIO(b"".join(writer.taken(0)))
    return set(ungrouped(read_groups(stream, format="nquads", source="x", default=BELIEFS)))


def mapped(some: list[Rule]) -> set[object]:
    """The statements of the naive mapping, but for the utterances."""
    return {quad for rule in some for quad in rule_quads(replace(rule, utterance=None))}


@given(st.lists(RULES, max_size=4))
@settings(deadline=None)
def test_lines_are_the_statements_of_the_rules(some: list[Rule]):
    """The fast way to write rules agrees with the naive one, however much they share."""
    assert written(some) == mapped(some)


@given(st.lists(RULES, max_size=6, unique_by=lambda rule: rule.id))
@settings(deadline=None)
def test_rules_of_lines_are_those_that_were_written(some: list[Rule]):
    """However much they share."""
    found = [
        rule_mapping.read_rule(group.pairs)
        for group in groups(some)
        if isinstance(group, StatementGroup)
    ]

    assert found == some
    assert written(found) == mapped(some)


@given(RULES, RULES)
def test_restated_rule_is_that_of_its_parts(one: Rule, other: Rule):
    """With the features, interval and source of another rule."""
    parts = {"features": other.features, "interval": other.interval}
    if not other.features and not one.contexts:
        return

    found = one.restated(*parts.values(), other.utterance, other.time)

    assert found == replace(one, **parts, utterance=other.utterance, time=other.time)
    assert found.id == replace(one, **parts).id


def test_rule_without_premises_is_refused():
    """It has neither features nor contexts."""
    with pytest.raises(ValidationError, match="at least one feature or context"):
        replace(BLADE, contexts=frozenset()).restated(frozenset(), BLADE.interval)
