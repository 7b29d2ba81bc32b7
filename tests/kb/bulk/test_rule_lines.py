# SPDX-License-Identifier: Apache-2.0
"""Claims about rules stamped out as lines: they are what is written statement by statement."""

from __future__ import annotations

import io
from dataclasses import replace
from datetime import datetime, timezone

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb.bulk.rule_lines import Printer, RuleSerializer
from hilt.kb.rdf.rule_mapping import BELIEFS, rule_quads
from hilt.kb.rule import Rule
from hilt.kb.stores.rdf_text import read_rdf
from hilt.ontology.errors import IntervalError, ValidationError

from ..conftest import BLADE
from ..strategies import rules

TIMES = st.none() | st.just(datetime(2026, 11, 21, 9, tzinfo=timezone.utc))
STATUSES = st.sampled_from(["active", "retracted", "superseded", "induced"])


@given(st.lists(st.tuples(rules, STATUSES, TIMES), max_size=4))
@settings(deadline=None)
def test_lines_are_the_statements_of_the_rules(some: list[tuple[Rule, str, datetime | None]]):
    """The fast way to write rules agrees with the plain one, however much they share."""
    told = [replace(rule, status=status, time=time) for rule, status, time in some]
    stamps, printer = RuleSerializer(), Printer()
    text = "".join(printer.lines(stamps.of(rule)) for rule in told).encode()

    read = set(read_rdf(io.BytesIO(text), format="nquads", source="x", default=BELIEFS))

    assert read == {quad for rule in told for quad in rule_quads(rule)}


@given(rules, st.none() | st.integers(1, 99), TIMES)
@settings(deadline=None)
def test_star_is_its_rule(rule: Rule, utterance: int | None, time: datetime | None):
    """Nothing of it is lost, and its name is that of its content."""
    told = replace(rule, utterance=utterance, time=time)

    star = RuleSerializer().of(told)

    assert star.rule == told
    assert (star.id, star.asserts) == (told.id, told.asserts)


@pytest.mark.parametrize("bounds", [("0.500000", "0.400000"), ("nan", "1.0"), ("0.1", "1.1")])
def test_bounds_that_are_no_interval_are_refused(bounds: tuple[str, str]):
    """No wrong interval comes into a base, by this way either."""
    stamps = RuleSerializer()

    with pytest.raises(IntervalError):
        stamps.star(stamps.frame(BLADE), stamps.seen(BLADE.features), *bounds)


def test_rule_that_speaks_of_nothing_is_refused():
    """Neither of what is seen nor of a context."""
    stamps = RuleSerializer()
    frame = stamps.frame(replace(BLADE, contexts=frozenset()))

    with pytest.raises(ValidationError, match="at least one feature or context"):
        stamps.star(frame, stamps.seen(frozenset()), "0.900000", "1.000000")
