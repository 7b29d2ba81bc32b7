"""Categories, their types, and how two of them combine."""

from __future__ import annotations

import pytest

from hilt.nlu.grammar.categories import type_of
from hilt.nlu.grammar.combinators import BinaryRule, CombinationTable
from hilt.nlu.grammar.notation_reader import read_entry
from hilt.nlu.grammar.types import BasicType
from hilt.ontology.yaml_reader import YamlNode


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
    atoms = {"S": BasicType("t"), "NP": BasicType("e")}

    assert str(type_of(category("(S\\NP)/NP"), atoms)) == "e -> e -> t"


def test_an_undeclared_atom_has_no_type() -> None:
    """The error names it."""
    with pytest.raises(KeyError, match="VP"):
        type_of(category("VP/NP"), {"NP": BasicType("e")})
