# SPDX-License-Identifier: Apache-2.0
"""Claims about rules that are copied: they come out as those that are read and written in full."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from datetime import datetime, timezone
from decimal import Decimal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk.copying import FastRuleReader, Pair
from hilt.kb.bulk.rule_lines import Printer, RuleSerializer, SerializedRule
from hilt.kb.bulk.statements import line_reader
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.rule_mapping import BELIEFS
from hilt.kb.rdf.terms import Literal, Quad
from hilt.kb.rule import Rule
from hilt.kb.stores.rdf_text import write_rdf
from hilt.ontology.vocabulary import Iri, iri, term

from ..conftest import BLADE
from ..strategies import rules

TIME = datetime(2026, 11, 21, 9, tzinfo=timezone.utc)
STATUSES = st.sampled_from(["active", "retracted", "superseded", "induced"])
TOLD = st.builds(
    lambda rule, status, utterance, time: replace(
        rule, status=status, utterance=utterance, time=time
    ),
    *(rules, STATUSES, st.none() | st.integers(1, 99), st.none() | st.just(TIME)),
)
NODE = rule_mapping.rule_iri(BLADE.id)


def pairs(rule: Rule) -> list[Pair]:
    """What stands at the node of a rule."""
    return [(quad.predicate, quad.object) for quad in rule_mapping.property_quads(rule)]


def star(
    node: Iri, some: Iterable[Pair], copier: FastRuleReader | None = None
) -> SerializedRule | None:
    """What is made of a rule that stands in a file."""
    text = write_rdf((Quad(node, *pair, BELIEFS) for pair in some), format="nquads")
    reader = line_reader("nquads", source="x", default=BELIEFS)
    blocks = [*reader.feed(text), *reader.finish()]
    return (copier or FastRuleReader()).star(*blocks)  # pyright: ignore[reportArgumentType]


def in_full(some: list[Rule]) -> set[str]:
    """The lines of rules as they are written one by one."""
    stamps, printer = RuleSerializer(), Printer()
    return {line for rule in some for line in printer.lines(stamps.of(rule)).splitlines()}


@given(st.lists(TOLD, max_size=6))
@settings(deadline=None)
def test_copies_are_the_lines_that_are_written_in_full(some: list[Rule]):
    """Statement for statement, with everything that they mention."""
    copier, printer = FastRuleReader(), Printer()

    found = [star(rule_mapping.rule_iri(rule.id), pairs(rule), copier) for rule in some]

    assert [one and one.rule for one in found] == some
    assert [one and one.id for one in found] == [rule.id for rule in some]
    assert [one and one.utterance for one in found] == [rule.utterance for rule in some]
    copied = {line for one in found if one for line in printer.lines(one).splitlines()}
    assert copied == in_full(some)


@pytest.mark.parametrize("lost", [key for key, _ in pairs(BLADE) if key != rule_mapping.CONTEXT])
def test_what_is_not_whole_is_not_copied(lost: Iri):
    """It is read in full, which says what is missing."""
    assert star(NODE, [pair for pair in pairs(BLADE) if pair[0] != lost]) is None


@pytest.mark.parametrize(
    "more",
    [
        (rule_mapping.FEATURE, iri("object", "mug")),
        (rule_mapping.FEATURE, iri("object", "knife")),
        (rule_mapping.LOWER, Decimal("0.5")),
        (rule_mapping.STATUS, term("retracted")),
        (rule_mapping.ARGUMENT, iri("place", "table")),
        (rule_mapping.GENERATED_AT, "yesterday"),
        (rule_mapping.GENERATED_AT, Literal("yesterday", "urn:t")),
        (rule_mapping.DERIVED_FROM, iri("utterance", "first")),
        (rule_mapping.LABEL, "a blade"),
        (term("unknown"), 1),
    ],
)
def test_what_says_more_is_not_copied(more: Pair):
    """Neither under a name that is not that of its content, nor with what Hilt does not write."""
    assert star(NODE, [*pairs(BLADE), more]) is None


@pytest.mark.parametrize(
    ("key", "value"),
    [
        (rule_mapping.TYPE, term("FunctionalRule")),
        (rule_mapping.LOWER, Decimal("1.5")),
        (rule_mapping.LOWER, Decimal("0.9500001")),
        (rule_mapping.LOWER, 0.95),
        (rule_mapping.LOWER, True),
        (rule_mapping.UPPER, Decimal("0.1")),
        (rule_mapping.UPPER, Decimal("NaN")),
        (rule_mapping.STATUS, term("forgotten")),
        (rule_mapping.ATTRIBUTED_TO, Iri("http://x/eve")),
        (rule_mapping.FUNCTOR, term("usedFor")),
        (rule_mapping.PART, iri("part", "handle")),
        (rule_mapping.FEATURE, Iri("https://w3id.org/hilt/object/%6Bnife")),
    ],
)
def test_what_stands_there_otherwise_is_not_copied(key: Iri, value: object):
    """Other values, other types, and other spellings of the same."""
    changed = [(one, value if one == key else old) for one, old in pairs(BLADE)]

    assert star(NODE, changed) is None  # pyright: ignore[reportArgumentType]


def test_name_of_another_rule_is_not_copied():
    """Rules have their names from their content."""
    other = replace(BLADE, speaker="eve")

    assert star(rule_mapping.rule_iri(other.id), pairs(BLADE)) is None
