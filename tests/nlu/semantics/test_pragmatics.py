"""Pragmatic rules: speech acts and intentions."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.nlu.grammar.notation_reader import parse_term
from hilt.nlu.grammar.terms import evaluate
from hilt.nlu.semantics.pragmatics import load_pragmatics
from hilt.nlu.semantics.predicates import PredicateForm, form_of
from hilt.ontology.errors import DataError


def form(text: str) -> PredicateForm:
    """A form from its notation."""
    return form_of(evaluate(parse_term(text)))


@pytest.mark.parametrize(
    ("act", "intention"),
    [
        ("STATEMENT(sam,self,implies(a,b,c))", "wantBelieve(sam,self,implies(a,b,c))"),
        ("INSTRUCT(sam,self,pass(self,knife))", "want(sam,pass(self,knife))"),
        ("QUESTION(sam,self,why)", "wantKnow(sam,self,why)"),
        ("QUESTION(sam,self,can(self,pass(self,knife)))", "want(sam,pass(self,knife))"),
        ("STATEMENT(sam,self,need(sam,knife))", "want(sam,pass(self,knife))"),
        ("STATEMENT(sam,self,need(evan,knife))", "want(sam,pass(self,knife,evan))"),
    ],
)
def test_the_most_detailed_rule_decides(act: str, intention: str) -> None:
    """A request in the form of a question is a request."""
    assert [str(each.form) for each in load_pragmatics().meant(form(act))] == [intention]


def test_all_matching_rules_give_intentions() -> None:
    """The others stay as less likely intentions."""
    found = load_pragmatics().intentions(form("QUESTION(sam,self,can(self,x))"))

    assert [str(each.form) for each in found] == ["want(sam,x)", "wantKnow(sam,self,can(self,x))"]
    assert found[0].interval == (0.9, 1.0)
    assert found[1].certainty < 0.1


def test_uncertain_recognition_lowers_certainty() -> None:
    """The score of a speech recogniser bounds the interval of an intention."""
    act = form("INSTRUCT(sam,self,pass(self,knife))")

    heard = load_pragmatics().intentions(act, heard=(0.8, 1.0))

    assert heard[0].interval == pytest.approx((0.76, 1.0))
    assert load_pragmatics().meant(act, heard=(0.5, 1.0)) == []


def test_rules_for_two_intentions_leave_both(tmp_path: Path) -> None:
    """Where the data cannot tell what is meant, Hilt has to ask."""
    path = tmp_path / "pragmatics.yaml"
    path.write_text(
        "threshold: 0.1\nrules:\n  - {rule: 'INSTRUCT(A,B,X) => want(A,X)', interval: [0.9, 1]}\n"
        "  - {rule: 'INSTRUCT(A,B,X) => wantKnow(A,B,X)', interval: [0.8, 1]}\n",
        encoding="utf-8",
    )

    assert len(load_pragmatics(path).meant(form("INSTRUCT(sam,self,x)"))) == 2


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("{rule: 'STATEMENT(A,B,X) => want(A,Y)', interval: [0, 1]}", "Y stands only on the right"),
        ("{rule: 'STATEMENT(A,B,X) => want(A,X)', interval: [1, 0]}", "expected lower <= upper"),
        ("{rule: 'STATEMENT(A,B,X)', interval: [0, 1]}", "expected"),
        ("{rule: 'STATEMENT(A,B,X) => λx.x', interval: [0, 1]}", "without functions"),
        ("{rule: 'STATEMENT(A,B,X) => want(A,X)'}", 'the key "interval" is missing'),
    ],
)
def test_an_invalid_rule_is_reported(tmp_path: Path, rule: str, message: str) -> None:
    """The error has the line and what was expected."""
    path = tmp_path / "pragmatics.yaml"
    path.write_text(f"threshold: 0.1\nrules:\n  - {rule}\n", encoding="utf-8")

    with pytest.raises(DataError, match=message) as caught:
        load_pragmatics(path)

    assert caught.value.line == 3
