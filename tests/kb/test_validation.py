"""Claims about validation: what is valid passes, and everything that is not is found."""

from __future__ import annotations

from decimal import Decimal

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.kb import invariants, validation
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf import rule_mapping
from hilt.kb.rdf.terms import Quad
from hilt.kb.rule import Rule
from hilt.kb.stores.opening import open_store
from hilt.kb.validation import (
    ValidationFinding,
    check_invariants,
    check_shapes,
    findings,
    locate_findings,
    raise_findings,
)
from hilt.ontology.errors import ValidationError
from hilt.ontology.vocabulary import Iri, external, iri, term

from .conftest import BLADE, teach
from .strategies import rules

NODE = rule_mapping.rule_iri(BLADE.id)


@settings(max_examples=15, deadline=None)
@given(st.lists(rules, max_size=4))
def test_whatever_is_told_is_valid(taught: list[Rule]):
    """Both checks pass what the base itself has written."""
    base = KnowledgeBase(open_store("memory:"))
    teach(base, *taught)

    assert list(check_invariants(base.store)) == []
    assert list(check_shapes(base.store)) == []


FAULTS = {  # what is done to a rule -> what both checks say
    "no lower bound": ({rule_mapping.LOWER: None}, "hilt:lower"),
    "lower above upper": ({rule_mapping.UPPER: Decimal("0.1")}, "upper"),
    "bound above one": ({rule_mapping.UPPER: Decimal("1.3")}, "1.3"),
    "bound below zero": ({rule_mapping.LOWER: Decimal("-0.1")}, "-0.1"),
    "no functor": ({rule_mapping.FUNCTOR: None}, "hilt:functor"),
    "no status": ({rule_mapping.STATUS: None}, "hilt:status"),
    "other status": ({rule_mapping.STATUS: term("maybe")}, "maybe"),
    "no speaker": ({rule_mapping.ATTRIBUTED_TO: None}, "wasAttributedTo"),
    "foreign feature": ({rule_mapping.FEATURE: Iri("http://example.org/x")}, "example.org/x"),
    "nothing spoken of": ({rule_mapping.FEATURE: None, rule_mapping.CONTEXT: None}, "at least one"),
}


@pytest.mark.parametrize("check", [check_invariants, check_shapes])
@pytest.mark.parametrize("fault", FAULTS)
def test_fault_in_a_rule_is_found_by_both_checks(kb: KnowledgeBase, fault: str, check: object):
    """The finding names the rule, and what is wrong with it."""
    changes, said = FAULTS[fault]
    teach(kb, BLADE)
    for key, value in changes.items():
        old = list(kb.store.quads(NODE, key))
        kb.store.apply(
            delete=old,
            insert=[] if value is None else [Quad(NODE, key, value, rule_mapping.BELIEFS)],
        )

    found = [finding for finding in check(kb.store) if finding.node == BLADE.id.replace("/", ":")]

    assert any(said in finding.problem for finding in found), found


@pytest.mark.parametrize(
    "stray",
    [
        Quad(Iri("http://x/a"), Iri("http://x/b"), "c", rule_mapping.BELIEFS),
        Quad(
            iri("object", "mug"), term("usedFor"), iri("affordance", "eating"), rule_mapping.BELIEFS
        ),
        Quad(
            iri("node", "pass.graspObject"),
            rule_mapping.RULE,
            iri("rule", "0" * 16),
            rule_mapping.BELIEFS,
        ),
        Quad(NODE, term("colour"), "red", rule_mapping.BELIEFS),
        Quad(NODE, rule_mapping.TYPE, term("FunctionalRule"), rule_mapping.BELIEFS),
    ],
)
def test_stray_statement_is_found(kb: KnowledgeBase, stray: Quad):
    """An edge that no rule asserts, or a foreign statement, belongs to nothing known."""
    teach(kb, BLADE)
    kb.store.apply(insert=[stray])

    (finding,) = check_invariants(kb.store)

    assert "belongs to nothing known" in str(finding)


def test_rule_under_a_wrong_name_is_found(kb: KnowledgeBase):
    """A rule's name is made from its content."""
    teach(kb, BLADE)
    wrong = iri("rule", "0" * 16)
    star = list(kb.store.quads(NODE))
    kb.store.apply(delete=star, insert=[quad._replace(subject=wrong) for quad in star])

    assert any(BLADE.id.replace("/", ":") in str(finding) for finding in check_invariants(kb.store))


def test_utterance_under_a_wrong_number_is_found(kb: KnowledgeBase):
    """The node and the sequence number agree."""
    teach(kb, BLADE)
    (old,) = kb.store.quads(iri("utterance", "1"), term("sequence"))
    kb.store.apply(delete=[old], insert=[old._replace(object=7)])

    assert any("sequence number is 7" in str(finding) for finding in check_invariants(kb.store))


def test_findings_are_raised_together():
    """One error carries all of them, each once, sorted."""
    found = [
        ValidationFinding("rule:b", "Second."),
        ValidationFinding("rule:a", "First."),
        ValidationFinding("rule:a", "First."),
    ]

    with pytest.raises(ValidationError, match=r"rule:a: First\. \(and 1 more\)") as caught:
        raise_findings(found)

    assert caught.value.findings == ("rule:a: First.", "rule:b: Second.")


def test_nothing_found_is_nothing_raised():
    """A valid graph passes in silence."""
    raise_findings([])


def test_foreign_kinds_of_literals_are_shown(kb: KnowledgeBase):
    """A finding about a literal shows its text."""
    kb.store.apply(
        insert=[Quad(iri("object", "x"), external("rdfs:comment"), "hm", rule_mapping.BELIEFS)]
    )

    assert [str(one) for one in check_invariants(kb.store)] == [
        'object:x: rdfs:comment "hm" belongs to nothing known.'
    ]


def test_shapes_are_checked_in_portions(kb: KnowledgeBase, monkeypatch: pytest.MonkeyPatch):
    """What is wrong is found in whichever portion it is."""
    monkeypatch.setattr(validation, "PORTION", 3)
    teach(kb, BLADE)
    kb.store.apply(delete=list(kb.store.quads(NODE, rule_mapping.STATUS)))

    found = list(check_shapes(kb.store))

    assert [(one.node, one.key) for one in found] == [(BLADE.id.replace("/", ":"), "hilt:status")]


def test_progress_counts_statements(kb: KnowledgeBase, monkeypatch: pytest.MonkeyPatch):
    """How many are done never falls, and ends at all of them."""
    monkeypatch.setattr(invariants, "_STEP", 1)
    teach(kb, BLADE)
    told: list[tuple[int, int]] = []

    assert findings(kb.store, progress=lambda *done: told.append(done)) == []

    assert told == sorted(told)
    assert told[-1] == (len(list(kb.store.quads())),) * 2


def test_findings_are_located_in_their_text():
    """By the prefixed name or the whole address; what is not described has no line."""
    text = (
        "\n\nrule:1 a hilt:Rule ;\n    hilt:lower 2 .\n<https://w3id.org/hilt/rule/2> a hilt:Rule ."
    )
    found = [ValidationFinding(f"rule:{name}", "Wrong.") for name in (1, 2, 3)]

    assert [one.line for one in locate_findings(found, text)] == [3, 5, 0]
    assert locate_findings(found, text)[0].as_json() == {
        "node": "rule:1", "property": None, "line": 3, "problem": "Wrong.",
    }  # fmt: skip
