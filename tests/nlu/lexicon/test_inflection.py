"""English word forms, forwards and backwards."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.ontology.errors import UnknownNameError


@pytest.mark.parametrize(
    ("word", "form", "expected"),
    [
        ("knife", "plural", "knives"),
        ("wine glass", "plural", "wine glasses"),
        ("berry", "plural", "berries"),
        ("mug", "plural", "mugs"),
        ("pass", "third", "passes"),
        ("cut", "ing", "cutting"),
        ("poke", "ing", "poking"),
        ("roll", "ing", "rolling"),
        ("pick up", "ing", "picking up"),
        ("pick up", "participle", "picked up"),
        ("hold", "participle", "held"),
        ("stir", "ing", "stirring"),
        ("scoop", "ing", "scooping"),
        ("open", "ing", "opening"),
        ("knife", "base", "knife"),
    ],
)
def test_words_are_inflected(language: Language, word: str, form: str, expected: str) -> None:
    """The first word of a verb changes, the last one of a noun."""
    assert language.inflection.form(word, form) == expected


@pytest.mark.parametrize(
    ("said", "form", "expected"),
    [
        ("knives", "plural", "knife"),
        ("dishes", "plural", "dish"),
        ("vases", "plural", "vase"),
        ("scissors", "plural", "scissors"),
        ("cutting", "ing", "cut"),
        ("poking", "ing", "poke"),
        ("rolling", "ing", "roll"),
        ("scooping", "ing", "scoop"),
        ("slicing", "ing", "slice"),
    ],
)
def test_the_dictionary_form_is_found(
    language: Language, said: str, form: str, expected: str
) -> None:
    """The likeliest word comes first."""
    assert language.inflection.origins(said, form)[0] == expected


@pytest.mark.parametrize("word", ["compass", "glass"])
def test_a_singular_in_ss_is_no_plural(language: Language, word: str) -> None:
    """A word that only looks like a plural has no singular."""
    assert language.inflection.origins(word, "plural") == []


@pytest.mark.parametrize(
    ("word", "expected"), [("egg", "an egg"), ("mug", "a mug"), ("used mug", "a used mug")]
)
def test_the_article_depends_on_the_sound(language: Language, word: str, expected: str) -> None:
    """The article is "an" before vowels, unless they sound like a consonant."""
    assert language.inflection.with_article(word) == expected


def test_an_unknown_form_is_an_error(language: Language) -> None:
    """The error lists the forms there are."""
    with pytest.raises(UnknownNameError, match="plural"):
        language.inflection.form("knife", "dual")
