"""Categories, their types, and how two of them combine."""

from __future__ import annotations

import pytest

from hilt.nlu.grammar.categories import Type, TypeMismatchError, check_type, type_of
from hilt.nlu.grammar.combinators import BinaryRule, CombinationTable
from hilt.nlu.grammar.notation import read_entry, read_type
from hilt.ontology.yaml_reader import YamlNode

from ..conftest import parse_term


def category(text: str):
    """A category from its notation."""
    return read_entry(YamlNode(f"{text} : x", "<text>", 1, 1))[0]


def combined(left: str, right: str) -> list[tuple[str, BinaryRule]]:
    """All that two categories give."""
    table = CombinationTable(())
    found = table.combine(table.sign(category(left)), table.sign(category(right)))
    return [(str(table.category(sign)), rule) for sign, rule in found]


@pytest.mark.parametrize(
    ("left", "right", "result", "rule"),
    [
        ("NP/N", "N", "NP", BinaryRule.FORWARD),
        ("NP", "S\\NP", "S", BinaryRule.BACKWARD),
        ("S/^C", "C/^NP", "S/^NP", BinaryRule.FORWARD_COMPOSITION),
        ("C\\^NP", "S\\^C", "S\\^NP", BinaryRule.BACKWARD_COMPOSITION),
    ],
)
def test_neighbours_combine(left: str, right: str, result: str, rule: BinaryRule) -> None:
    """Application always, composition where both slashes allow it."""
    assert combined(left, right) == [(result, rule)]


@pytest.mark.parametrize(
    ("left", "right"),
    [
        ("N", "NP/N"),
        ("S\\NP", "NP"),
        ("S/C", "C/NP"),
        ("S/^C", "C/NP"),
        ("S/^C", "C\\^NP"),
        ("S\\^C", "C/^NP"),
    ],
)
def test_nothing_else_combines(left: str, right: str) -> None:
    """Nothing crosses, nothing is raised, and a plain slash does not compose."""
    assert combined(left, right) == []


def test_a_composed_functor_does_not_apply_again() -> None:
    """Eisner's normal form: one derivation of many with the same meaning."""
    table = CombinationTable(())
    one, two = table.sign(category("A/^B")), table.sign(category("B/^C"))
    ((composed, _),) = table.combine(one, two)

    assert table.combine(composed, table.sign(category("C"))) == ()
    assert table.combine(one, table.sign(category("B"))) != ()


def test_the_type_of_a_functor_is_a_function() -> None:
    """`S/NP` means a function from what NPs mean to what Ss mean."""
    atoms = {"S": "t", "NP": "e"}

    assert str(type_of(category("(S\\NP)/NP"), atoms)) == "e -> e -> t"


def test_an_undeclared_atom_has_no_type() -> None:
    """The error names it."""
    with pytest.raises(KeyError, match="VP"):
        type_of(category("VP/NP"), {"NP": "e"})


def parsed_type(text: str) -> Type:
    """A type from its notation."""
    return read_type(YamlNode(text, "<text>", 1, 1))


SIGNATURE = {
    "implies": [parsed_type("e -> e -> d -> t"), parsed_type("t -> t -> d -> t")],
    "pass": [parsed_type("e -> e -> t")],
    "knife": [parsed_type("e")],
    "high": [parsed_type("d")],
}


@pytest.mark.parametrize(
    ("term", "wanted"),
    [
        ("λx.x", "e -> e"),
        ("λx.pass(knife,x)", "e -> t"),
        ("λx.λy.implies(x,y,high)", "e -> e -> t"),
        ("λx.λy.implies(x,y,high)", "t -> t -> t"),
        ("λf.f(knife)", "(e -> t) -> t"),
    ],
)
def test_a_term_of_the_right_type_passes(term: str, wanted: str) -> None:
    """Constants may have several types; the one that fits is meant."""
    check_type(parse_term(term), parsed_type(wanted), SIGNATURE)


@pytest.mark.parametrize(
    ("term", "wanted", "message"),
    [
        ("λx.x", "e", "expected e, found the function"),
        ("λx.pass(knife,x)", "e -> e", '"pass" gives t'),
        ("knife(knife)", "t", '"knife" takes fewer arguments'),
        ("λx.fork", "e -> e", '"fork" is neither bound nor declared'),
        ("implies(knife,pass(knife,knife),high)", "t", "expected e"),
    ],
)
def test_a_term_of_the_wrong_type_is_refused(term: str, wanted: str, message: str) -> None:
    """The message says what was expected and what was found."""
    with pytest.raises(TypeMismatchError, match=message.replace("(", r"\(")):
        check_type(parse_term(term), parsed_type(wanted), SIGNATURE)


@pytest.mark.parametrize("text", ["e", "e -> t", "(e -> t) -> t", "e -> (e -> t) -> d -> t"])
def test_types_print_as_they_are_written(text: str) -> None:
    """Arrows group to the right."""
    assert str(parsed_type(text)) == text
