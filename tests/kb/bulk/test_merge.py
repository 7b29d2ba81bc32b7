"""Claims about merging one base into another."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.kb.bulk.importer import merge
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf.rule_mapping import rule_quads
from hilt.kb.rule import Rule
from hilt.kb.stores.opening import open_store
from hilt.kb.validation import check_invariants
from hilt.ontology.errors import ValidationError

from ..conftest import BLADE, CUTTING, HANDLE, teach, ticking

AGAINST = replace(CUTTING, interval=Interval(0, 0.1))


def base_with(*rules: Rule) -> KnowledgeBase:
    """A base that was told rules."""
    base = KnowledgeBase(open_store("memory:"), clock=ticking())
    teach(base, *rules)
    return base


def test_merge_brings_rules_history_and_conflicts():
    """The utterances of the other base come after those of this one."""
    base, other = base_with(AGAINST, HANDLE), base_with(CUTTING, BLADE)
    other.retract(BLADE.id, "Forget that.", "", "sam")

    summary = merge(base, other.store, source="other")

    assert (summary.new, summary.known, summary.conflicting) == (2, 0, 1)
    assert base.rule(BLADE.id).status == "retracted"
    assert [said.sequence for said in base.history()] == [1, 2, 3, 4, 5]
    (found,) = summary.conflicts
    assert (found.new.id, found.believed.id) == (CUTTING.id, AGAINST.id)
    assert found.weight == pytest.approx(CUTTING.interval.lower * 0.9)
    assert list(check_invariants(base.store)) == []


def test_merging_twice_changes_nothing():
    """What the base retracted stays retracted, and is reported as different."""
    base, other = base_with(), base_with(CUTTING, BLADE)
    merge(base, other.store, source="other")
    base.retract(BLADE.id, "Forget that.", "", "sam")
    before = set(base.store.quads())

    summary = merge(base, other.store, source="other")

    assert (summary.new, summary.known, summary.utterances) == (0, 2, 0)
    assert [(rule.id, rule.status) for rule in summary.kept] == [(BLADE.id, "active")]
    assert set(base.store.quads()) == before


def test_base_that_breaks_a_law_is_refused_whole():
    """Nothing of it is merged."""
    base, other = base_with(HANDLE), base_with(CUTTING)
    malformed = [quad for quad in rule_quads(BLADE) if "lower" not in quad.predicate]
    other.store.apply(insert=malformed)
    before = set(base.store.quads())

    with pytest.raises(ValidationError, match="has no hilt:lower"):
        merge(base, other.store, source="other")

    assert set(base.store.quads()) == before
