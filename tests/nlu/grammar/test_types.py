"""Types, and the check of terms against them."""

from __future__ import annotations

import pytest

from hilt.nlu.grammar.notation_reader import parse_term, read_type
from hilt.nlu.grammar.types import Type, TypeMismatchError, check_type
from hilt.ontology.yaml_reader import YamlNode


def type_of(text: str) -> Type:
    """A type from its notation."""
    return read_type(YamlNode(text, "<text>", 1, 1))


SIGNATURE = {
    "implies": [type_of("e -> e -> d -> t"), type_of("t -> t -> d -> t")],
    "pass": [type_of("e -> e -> t")],
    "knife": [type_of("e")],
    "high": [type_of("d")],
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
    check_type(parse_term(term), type_of(wanted), SIGNATURE)


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
        check_type(parse_term(term), type_of(wanted), SIGNATURE)


@pytest.mark.parametrize("text", ["e", "e -> t", "(e -> t) -> t", "e -> (e -> t) -> d -> t"])
def test_types_print_as_they_are_written(text: str) -> None:
    """Arrows group to the right."""
    assert str(type_of(text)) == text
