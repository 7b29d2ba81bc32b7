# SPDX-License-Identifier: Apache-2.0
"""Speech acts and what is wanted by them."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.nlu.notation import parse_term
from hilt.nlu.pragmatics import intentions, load_pragmatics
from hilt.nlu.predicates import Form, form_of_term
from hilt.ontology.errors import DataError


def form(text: str) -> Form:
    """A form from its notation."""
    return form_of_term(parse_term(text))


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
    assert str(intentions(form(act), load_pragmatics())[0].form) == intention


def test_all_rules_that_fit_are_there() -> None:
    """The others stay as less likely intentions."""
    found = intentions(form("QUESTION(sam,self,can(self,x))"), load_pragmatics())

    assert [str(each.form) for each in found] == ["want(sam,x)", "wantKnow(sam,self,can(self,x))"]


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        ("{rule: 'STATEMENT(A,B,X) => want(A,Y)', interval: [0, 1]}", "Y stands only on the right"),
        ("{rule: 'STATEMENT(A,B,X) => want(A,X)', interval: [1, 0]}", "expected lower <= upper"),
        ("{rule: 'STATEMENT(A,B,X)', interval: [0, 1]}", "expected"),
        ("{rule: 'STATEMENT(A,B,X) => want(A,X)'}", 'the key "interval" is missing'),
    ],
)
def test_a_wrong_rule_is_told(tmp_path: Path, rule: str, message: str) -> None:
    """File, line, column, and what was expected."""
    path = tmp_path / "pragmatics.yaml"
    path.write_text(f"rules:\n  - {rule}\n", encoding="utf-8")

    with pytest.raises(DataError, match=message) as caught:
        load_pragmatics(path)

    assert caught.value.line == 2
