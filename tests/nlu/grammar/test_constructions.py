"""Constructions as entries of a categorial grammar."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.grammar.constructions import Construction, pieces_of
from hilt.nlu.grammar.notation import read_entry
from hilt.nlu.grammar.word_patterns import variants
from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import YamlNode


def field(text: str) -> YamlNode:
    """A text as it would stand in a file."""
    return YamlNode(text, "<text>", 1, 1)


def construction(says: str, means: str) -> Construction:
    """The one construction of a pattern without choices."""
    category, term, _ = read_entry(field(means))
    (variant,) = variants(field(says))
    return Construction(pieces_of(variant, field(says)), category, term)


def test_the_first_words_take_the_gaps() -> None:
    """What stands before them is sought to the left, the rest to the right."""
    found = construction("{a:K} is a job for {x:NP}", "R : λq.implies(x,a,q)")

    assert found.head.category.words == "is a job for"
    assert str(found.category) == r"(R\K)/NP"
    assert str(found.functor()) == "λx.λa.λq.implies(x,a,q)"


def test_later_words_are_arguments_without_meaning() -> None:
    """Their meaning is not used."""
    found = construction("take {x:NP} for {a:K}", "R : λq.implies(x,a,q)")

    assert str(found.category) == '((R/K)/"for")/NP'
    assert str(found.functor()) == "λx.λs.λa.λq.implies(x,a,q)"


def test_gaps_alone_change_the_first_one_without_a_name() -> None:
    """A construction without words of its own is a change of category."""
    found = construction("{x:NP} {GOOD} {a:FU}", "R : λq.implies(x,a,q)")

    assert not found.head.category.is_words
    assert str(found.category) == r"(R\NP)/FU"


@pytest.mark.parametrize("gap", ["{x:", "{x:}", "{:NP}x", "{}"])
def test_a_wrong_gap_is_refused(gap: str) -> None:
    """The message shows what a gap looks like."""
    with pytest.raises(DataError, match="expected a gap like"):
        pieces_of([gap], field(gap))


@pytest.mark.parametrize(
    "text",
    [
        "Cutting is a job for a knife",
        "Nothing beats a knife for cutting",
        "It's a knife you reach for when something needs cutting",
        "When it's cutting you want, a knife does the trick",
        "What knives do best is cutting",
    ],
)
def test_a_construction_means_the_same_as_plain_words(language: Language, text: str) -> None:
    """Several phrasings give one rule."""
    plain = language.understand("A knife is used for cutting").meaning

    assert language.understand(text).meaning == plain
