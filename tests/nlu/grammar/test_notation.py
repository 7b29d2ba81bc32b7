"""The notation of the language data, and the messages about mistakes in it."""

from __future__ import annotations

import pytest

from hilt.nlu.grammar.categories import Category
from hilt.nlu.grammar.notation import MAX_CHARACTERS, read_entry, read_rule, read_type, read_unary
from hilt.nlu.grammar.terms import Application, BoundVariable, Constant, Lambda, evaluate, quote
from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import YamlNode

from ..conftest import parse_term


def line(text: str) -> YamlNode:
    """A text as it would stand in quotes in line 3 of a file, from column 5 on."""
    return YamlNode(text, "words.yaml", 3, 5)


def category(text: str) -> Category:
    """The category that a text stands for."""
    return read_entry(line(f"{text} : x"))[0]


@pytest.mark.parametrize("text", ["NP", "NP/N", "(S\\NP)/NP", "S/(S\\NP)", "(S/^C)\\^NP"])
def test_categories_read_and_print(text: str) -> None:
    """Printing a category gives what was read, with the brackets that matter."""
    assert category(str(category(text))) == category(text)


def test_slashes_group_to_the_left() -> None:
    """`S/NP/NP` seeks its last argument first."""
    assert category("S/NP/PP") == category("(S/NP)/PP")


def test_an_entry_has_a_category_a_term_and_a_cost() -> None:
    """The cost is nothing unless one is given."""
    _, term, cost = read_entry(line("NP/N : λx.x"))
    _, _, dear = read_entry(line("NP/N : \\x.x @1.5"))

    assert (str(term), cost, dear) == ("λx.x", 0.0, 1.5)


def test_a_unary_rule_has_two_categories_and_a_term() -> None:
    """`R => S : term` goes from R to S."""
    source, target, term = read_unary(line("R => S : λr.r(high)"))

    assert (str(source), str(target), str(term)) == ("R", "S", "λr.r(high)")


def test_a_pragmatic_rule_has_two_sides() -> None:
    """Both are terms in which the variables are constants of one capital letter."""
    act, intention = read_rule(line("INSTRUCT(A,B,X) => want(A,X)"))

    assert (str(act), str(intention)) == ("INSTRUCT(A,B,X)", "want(A,X)")


@pytest.mark.parametrize(
    ("text", "column", "expected"),
    [
        ("NP/ : x", 10, "a name"),
        ("NP/N x", 11, '":"'),
        ("NP : λx", 13, '"."'),
        ("NP : f(x", 14, '")"'),
        ("NP : f(x))", 15, "the end"),
        ("NP : %", 11, '"λ"'),
    ],
)
def test_a_mistake_is_reported_with_its_position(text: str, column: int, expected: str) -> None:
    """The error has file, line, column and what was expected."""
    with pytest.raises(DataError) as caught:
        read_entry(line(text))

    assert (caught.value.source, caught.value.line) == ("words.yaml", 3)
    assert caught.value.column == column
    assert expected in caught.value.problem


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("NP % x", 'expected "/" or ":" or "\\", found "% x" in '),
        ("NP : f(x", 'expected "(" or ")" or "," or a name, found the end in '),
        ("NP : x @y", 'expected a number, found "y" in '),
    ],
)
def test_a_message_lists_everything_that_may_follow(text: str, expected: str) -> None:
    """What was expected is what may follow after the right part of the line."""
    with pytest.raises(DataError) as caught:
        read_entry(line(text))

    assert caught.value.problem == f"{expected}{text!r}."


def test_an_inner_variable_hides_an_outer_one() -> None:
    """A name means the nearest function that has it."""
    assert parse_term("λx.λx.f(x)") == Lambda(Lambda(Application(Constant("f"), BoundVariable(0))))
    assert parse_term("λx.(λx.x)(x)") == Lambda(
        Application(Lambda(BoundVariable(0)), BoundVariable(0))
    )


def test_no_line_nests_too_deeply() -> None:
    """What nests as deeply as its length allows can be used, and a longer line is refused."""
    depth = (MAX_CHARACTERS - 1) // 3
    functions, calls = "λx." * depth + "x", "f(" * depth + "x" + ")" * depth

    assert quote(evaluate(parse_term(functions))) == parse_term(functions)
    assert str(quote(evaluate(parse_term(calls)))) == calls
    with pytest.raises(DataError, match=f"at most {MAX_CHARACTERS} characters, found"):
        read_entry(line(f"NP : f({calls})"))


def test_only_known_basic_types_are_read() -> None:
    """A type is made of e, t and d."""
    with pytest.raises(DataError, match='expected "\\(" or e, t or d, found "q"'):
        read_type(line("e -> q"))


def test_the_excerpt_shows_where_a_mistake_is() -> None:
    """The caret stands below the first character that cannot go on."""
    shown = '    is: "NP : f(x"'

    with pytest.raises(DataError) as caught:
        read_entry(YamlNode("NP : f(x", "words.yaml", 3, 9, text_line=shown))

    assert caught.value.excerpt().splitlines() == [shown, " " * 17 + "^"]
