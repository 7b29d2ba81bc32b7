"""Predicate forms, patterns and what they stand for, and pragmatic rules."""

from __future__ import annotations

from functools import reduce
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.nlu.grammar.terms import Application, Constant, Term, evaluate
from hilt.nlu.semantics.predicates import PredicateForm, fill, form_of, load_pragmatics, match
from hilt.ontology.errors import DataError

from ..conftest import parse_term

NAMES = st.sampled_from(["knife", "pass", "self", "partOf", "blade"])
FORMS = st.recursive(
    st.builds(PredicateForm, NAMES),
    lambda inner: st.builds(
        PredicateForm, NAMES, st.lists(inner, min_size=1, max_size=3).map(tuple)
    ),
    max_leaves=8,
)


def form(text: str) -> PredicateForm:
    """A form from its notation."""
    return form_of(evaluate(parse_term(text)))


@given(FORMS)
def test_a_form_reads_back_from_its_text(written: PredicateForm) -> None:
    """What is printed is the notation that is read."""
    assert form(str(written)) == written


@given(FORMS)
def test_forms_and_terms_are_the_same_without_functions(written: PredicateForm) -> None:
    """A form goes through a term and its value unchanged."""
    assert form_of(evaluate(_term(written))) == written


@given(FORMS)
def test_a_variable_matches_every_form(anything: PredicateForm) -> None:
    """Filling a pattern with what it matched gives the form again."""
    pattern = form("want(A,X)")
    whole = PredicateForm("want", (PredicateForm("sam"), anything))

    found = match(pattern, whole)

    assert found is not None
    assert fill(pattern, found) == whole


def test_one_variable_stands_for_one_form() -> None:
    """The same letter twice needs the same form twice."""
    assert match(form("f(A,A)"), form("f(a,b)")) is None
    assert match(form("f(A,A)"), form("f(a,a)")) == {"A": form("a")}


@pytest.mark.parametrize("other", ["g(a)", "f(a,b)", "f(b)"])
def test_other_names_and_numbers_do_not_match(other: str) -> None:
    """A pattern fits its own name, its own number of arguments, its own constants."""
    assert match(form("f(a)"), form(other)) is None


def test_a_function_is_no_form() -> None:
    """What still needs an argument is not a meaning."""
    with pytest.raises(ValueError, match="function"):
        form_of(evaluate(parse_term("λx.x")))


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


def _term(written: PredicateForm) -> Term:
    """The term that applies a constant to the terms of its arguments."""
    return reduce(Application, map(_term, written.arguments), Constant(written.name))
