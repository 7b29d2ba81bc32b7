"""Turns of phrase whose meaning somebody confirmed: what they mean of other names."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.semantics.meaning import Meaning

SAID = "the thing to take around for rolling is a bottle"
MEANT = "a bottle is used for rolling"


def with_phrase(language: Language, text: str, sentence: str) -> Language:
    """The language after somebody confirmed that a text means what a sentence says."""
    phrase = language.phrase_of(text, meaning_of(language, sentence))
    assert phrase is not None
    return language.with_phrases([phrase])


def meaning_of(language: Language, text: str) -> Meaning:
    """The meaning of a text said out of the blue."""
    return language.understand(text).meaning


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (SAID, MEANT),
        ("the thing to take around for cutting is a knife", "a knife is used for cutting"),
        ("the thing to take around for poking is a skewer", "a skewer is used for poking"),
        ("The thing to take around for Cutting, is a Shoe!", "a shoe is used for cutting"),
    ],
)
def test_a_confirmed_phrase_means_the_same_of_other_names(
    language: Language, text: str, sentence: str
) -> None:
    """Also of new names, and with other capitals and pauses."""
    learned = with_phrase(language, SAID, MEANT)

    assert meaning_of(learned, text) == meaning_of(language, sentence)


@pytest.mark.parametrize(
    "text",
    [
        "the thing to never take around for rolling is a bottle",
        "the thing to take around for rolling is not a bottle",
        "the thing they take around for rolling is a bottle",
        "the thing to take around for rolling is a bottle and a spoon",
    ],
)
def test_a_phrase_with_another_word_is_another_phrase(language: Language, text: str) -> None:
    """It is compared word by word: nothing is left out."""
    learned = with_phrase(language, SAID, MEANT)

    assert meaning_of(learned, text) == meaning_of(language, text)


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("bottles, rolling", MEANT),  # too few words of its own
        ("teh thing too tak arond for rolling is a bottle", MEANT),  # words that are not known
        ("the thing to take around for rolling is a bottle or a spoon", MEANT),  # a name too many
        ("the thing to take around for rolling is that thing", MEANT),  # a name too few
    ],
)
def test_a_phrase_that_would_mislead_is_not_learned(
    language: Language, text: str, sentence: str
) -> None:
    """The checks before a phrase is kept."""
    assert language.phrase_of(text, meaning_of(language, sentence)) is None


def test_what_the_grammar_understands_stays_as_it_is(language: Language) -> None:
    """A phrase is asked only about what is not understood."""
    learned = with_phrase(language, SAID, MEANT)

    for text in (MEANT, "pass me the knife", "to pass a knife grab it by the blade"):
        assert meaning_of(learned, text) == meaning_of(language, text)
