"""Which new words are likely slips of known ones."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.lexicon.misspelling import intended_word, letter_clusters

KNOWN = frozenset(
    {"knife", "hammer", "handle", "mug", "pan", "cake", "lift", "tapping"}
    | {"screwdriver", "lightning", "container"}
)


def intended(word: str, language: Language) -> str | None:
    """The one of `KNOWN` that a word is a slip of, by the spelling of English."""
    return intended_word(word, KNOWN.__contains__, language.lexicon.letter_clusters)


@pytest.mark.parametrize(
    ("word", "other"),
    [
        ("knfe", "knife"),
        ("hamer", "hammer"),
        ("hnadle", "handle"),
        ("mugg", "mug"),
        ("screwdiver", "screwdriver"),
        ("contianer", "container"),
    ],
)
def test_a_slip_is_found(language: Language, word: str, other: str) -> None:
    """Letters swapped, lost or doubled; in a long word also where the result looks like a word."""
    assert intended(word, language) == other


@pytest.mark.parametrize(
    "word", ["pin", "lifting", "lifter", "taping", "lighting", "candle", "hamper", "cage"]
)
def test_another_word_is_no_slip(language: Language, word: str) -> None:
    """Most words that are one letter away from another are words of their own."""
    assert intended(word, language) is None


def test_clusters_mark_both_ends() -> None:
    """What may begin or end a word is not what may stand within it."""
    assert letter_clusters("handle") == ["^h", "a", "ndl", "e", "$"]
