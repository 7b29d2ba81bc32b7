"""Claims about rules as lines of N-Quads: they are what the naive mapping writes."""

from __future__ import annotations

import io
from dataclasses import replace
from datetime import datetime, timezone
from decimal import Decimal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk.nquads_reader import LineReader, RuleBlock, read_groups, read_quads
from hilt.kb.bulk.rule_nquads import FastRuleReader, NQuadsWriter
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.rule_mapping import BELIEFS, rule_quads
from hilt.kb.rdf.terms import Literal, Quad, Term
from hilt.kb.rule import Rule
from hilt.kb.stores.rdf_text import write_rdf
from hilt.ontology.errors import ValidationError
from hilt.ontology.vocabulary import Iri, iri, term

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
Pair = tuple[Iri, Term]
KNIFE = iri("object", "knife")


def pairs(rule: Rule) -> list[Pair]:
    """Predicates and objects of a rule."""
    return [(quad.predicate, quad.object) for quad in rule_mapping.property_quads(rule)]


def blocks(rule_id: str, some: list[Pair]) -> list[RuleBlock]:
    """The lines about a rule as a file has them."""
    node = rule_mapping.rule_iri(rule_id)
    text = write_rdf((Quad(node, *pair, BELIEFS) for pair in some), format="nquads")
    reader = LineReader(format="nquads", source="x", default=BELIEFS)
    found = [*reader.feed(text), *reader.finish()]
    return [block for block in found if isinstance(block, RuleBlock)]


def written(some: list[Rule]) -> set[object]:
    """The statements that are written of rules."""
    writer = NQuadsWriter()
    for rule in some:
        writer.write_rule(rule)
    stream = io.BytesIO(b"".join(writer.taken(0)))
    return set(read_quads(read_groups(stream, format="nquads", source="x", default=BELIEFS)))


def mapped(some: list[Rule]) -> set[object]:
    """The statements of the naive mapping, but for the utterances."""
    return {quad for rule in some for quad in rule_quads(replace(rule, utterance=None))}


@given(st.lists(RULES, max_size=4))
@settings(deadline=None)
def test_lines_are_the_statements_of_the_rules(some: list[Rule]):
    """The fast way to write rules agrees with the naive one, however much they share."""
    assert written(some) == mapped(some)


@given(st.lists(RULES, max_size=6))
@settings(deadline=None)
def test_rules_of_an_export_are_copied(some: list[Rule]):
    """The fast way to read rules agrees with the naive one."""
    reader = FastRuleReader()

    found = [reader.read(*blocks(rule.id, pairs(rule))) for rule in some]

    assert found == some
    assert written([one for one in found if one]) == mapped(some)


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


@pytest.mark.parametrize("lost", [key for key, _ in pairs(BLADE) if key != rule_mapping.CONTEXT])
def test_incomplete_rule_is_not_copied(lost: Iri):
    """It is read in full, which says what is missing."""
    some = [pair for pair in pairs(BLADE) if pair[0] != lost]

    assert FastRuleReader().read(*blocks(BLADE.id, some)) is None


@pytest.mark.parametrize(
    "more",
    [
        (rule_mapping.FEATURE, iri("object", "mug")),
        (rule_mapping.FEATURE, KNIFE),
        (rule_mapping.LOWER, Decimal("0.5")),
        (rule_mapping.STATUS, term("retracted")),
        (rule_mapping.ARGUMENT, iri("place", "table")),
        (rule_mapping.GENERATED_AT, Literal("yesterday", "urn:t")),
        (rule_mapping.DERIVED_FROM, iri("utterance", "first")),
        (rule_mapping.LABEL, "a blade"),
        (term("unknown"), 1),
    ],
)
def test_rule_that_says_more_is_not_copied(more: Pair):
    """Its name is not that of its content, or Hilt does not write this."""
    assert FastRuleReader().read(*blocks(BLADE.id, [*pairs(BLADE), more])) is None


@pytest.mark.parametrize(
    ("key", "value"),
    [
        (rule_mapping.TYPE, term("FunctionalRule")),
        (rule_mapping.LOWER, Decimal("1.5")),
        (rule_mapping.LOWER, Decimal("0.9500001")),
        (rule_mapping.LOWER, 0.95),
        (rule_mapping.LOWER, True),
        (rule_mapping.UPPER, Decimal("0.1")),
        (rule_mapping.STATUS, term("forgotten")),
        (rule_mapping.ATTRIBUTED_TO, Iri("http://x/eve")),
        (rule_mapping.ATTRIBUTED_TO, iri("speaker", "eve")),
        (rule_mapping.FUNCTOR, term("usedFor")),
        (rule_mapping.PART, iri("part", "handle")),
        (rule_mapping.FEATURE, Iri("https://w3id.org/hilt/object/%6Bnife")),
    ],
)
def test_rule_in_another_form_is_not_copied(key: Iri, value: object):
    """It has another value, another type, or another spelling."""
    changed = [(one, value if one == key else old) for one, old in pairs(BLADE)]

    assert FastRuleReader().read(*blocks(BLADE.id, changed)) is None  # pyright: ignore[reportArgumentType]
