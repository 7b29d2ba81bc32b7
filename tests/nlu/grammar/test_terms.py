"""Lambda terms: binding, normal forms, printing; evaluation against step-by-step reduction."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.nlu.grammar.categories import FunctionType, Type, check_type
from hilt.nlu.grammar.terms import (
    Application,
    BoundVariable,
    Constant,
    Lambda,
    Term,
    compose,
    evaluate,
    quote,
    replace_constants,
    show,
)

from ..conftest import parse_term

E = "e"
TYPES = st.recursive(st.just(E), lambda inner: st.builds(FunctionType, inner, inner), max_leaves=4)
SIGNATURE = {
    "a": [E],
    "f": [FunctionType(E, E)],
    "g": [FunctionType(E, FunctionType(E, E))],
    "h": [FunctionType(FunctionType(E, E), E)],
}


@st.composite
def typed_terms(
    draw: st.DrawFn, wanted: Type = E, context: tuple[Type, ...] = (), depth: int = 4
) -> Term:
    """A closed term of a type, redexes included."""
    if isinstance(wanted, FunctionType) and draw(st.booleans()):
        return Lambda(draw(typed_terms(wanted.target, (wanted.source, *context), depth)))
    if depth and draw(st.booleans()):
        source = draw(TYPES)
        function = draw(typed_terms(FunctionType(source, wanted), context, depth - 1))
        return Application(function, draw(typed_terms(source, context, depth - 1)))
    known = [BoundVariable(i) for i, each in enumerate(context) if each == wanted]
    known += [Constant(name) for name, (each,) in SIGNATURE.items() if each == wanted]
    if known:
        return draw(st.sampled_from(known))
    if isinstance(wanted, FunctionType):
        return Lambda(draw(typed_terms(wanted.target, (wanted.source, *context), depth)))
    return Constant("a")


def shift(term: Term, by: int, below: int = 0) -> Term:
    """The textbook shift of free variables, to compare with."""
    match term:
        case BoundVariable(index):
            return BoundVariable(index + by) if index >= below else term
        case Lambda(body):
            return Lambda(shift(body, by, below + 1))
        case Application(function, argument):
            return Application(shift(function, by, below), shift(argument, by, below))
        case Constant():
            return term


def substitute(term: Term, value: Term, index: int = 0) -> Term:
    """The textbook substitution, to compare with."""
    match term:
        case BoundVariable(found):
            return value if found == index else term
        case Lambda(body):
            return Lambda(substitute(body, shift(value, 1), index + 1))
        case Application(function, argument):
            return Application(
                substitute(function, value, index), substitute(argument, value, index)
            )
        case Constant():
            return term


def reduced(term: Term) -> Term:
    """Normal order reduction, step by step."""
    match term:
        case Lambda(body):
            return Lambda(reduced(body))
        case Application(function, argument):
            head = reduced(function)
            if isinstance(head, Lambda):
                return reduced(shift(substitute(head.body, shift(argument, 1)), -1))
            return Application(head, reduced(argument))
        case BoundVariable() | Constant():
            return term


def normal_form(term: Term) -> Term:
    """The beta-normal form of a closed, well-typed term."""
    return quote(evaluate(term))


@given(typed_terms())
def test_evaluation_agrees_with_reduction(term: Term) -> None:
    """The fast normal form is that of step-by-step reduction."""
    assert normal_form(term) == reduced(term)


@given(typed_terms())
def test_normal_form_is_final(term: Term) -> None:
    """A normal form has nothing left to reduce."""
    once = normal_form(term)

    assert normal_form(once) == once


@given(typed_terms())
def test_normal_form_keeps_the_type(term: Term) -> None:
    """Reduction does not change what a term is."""
    check_type(term if not isinstance(term, Application) else normal_form(term), E, SIGNATURE)


@given(
    typed_terms(FunctionType(E, E)),
    typed_terms(FunctionType(E, E)),
    typed_terms(FunctionType(E, E)),
)
def test_composition_is_associative(one: Term, two: Term, three: Term) -> None:
    """It does not matter which two functions are composed first."""
    f, g, h = evaluate(one), evaluate(two), evaluate(three)

    assert quote(compose(compose(f, g), h)) == quote(compose(f, compose(g, h)))


@given(typed_terms())
def test_a_shown_term_reads_back(term: Term) -> None:
    """What is printed is the notation that is read."""
    assert normal_form(parse_term(str(normal_form(term)))) == normal_form(term)


def test_names_of_bound_variables_do_not_matter() -> None:
    """Terms that differ only in the names of their variables are equal."""
    assert parse_term("λx.λy.f(x,y)") == parse_term("λa.λb.f(a,b)")


def test_substitution_does_not_capture() -> None:
    """A free variable stays free under a binder of the same name."""
    term = parse_term("λy.(λx.λy.x)(y)")

    assert normal_form(term) == parse_term("λy.λz.y")


@pytest.mark.parametrize(
    ("written", "printed"),
    [
        ("λx.λx.x", "λx.λx2.x2"),
        ("(λx.f x)(a)", "(λx.f(x))(a)"),
        ("implies (pass self knife) b high", "implies(pass(self,knife),b,high)"),
    ],
)
def test_terms_print_as_in_the_paper(written: str, printed: str) -> None:
    """Arguments stand in brackets, and no two binders in scope share a name."""
    assert show(parse_term(written)) == printed


def test_constants_can_be_renamed() -> None:
    """Templates fill in the name of their word."""
    term = replace_constants(parse_term("λx.ACT(self,x)"), {"ACT": "pass"})

    assert str(term) == "λx.pass(self,x)"
