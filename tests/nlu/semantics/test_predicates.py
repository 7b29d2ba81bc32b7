"""Predicate forms, patterns and what they stand for."""

from __future__ import annotations

from functools import reduce

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.nlu.grammar.notation_reader import parse_term
from hilt.nlu.grammar.terms import Application, Constant, Term, evaluate
from hilt.nlu.semantics.predicates import PredicateForm, fill, form_of, match

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


def _term(written: PredicateForm) -> Term:
    """The term that applies a constant to the terms of its arguments."""
    return reduce(Application, map(_term, written.arguments), Constant(written.name))
