"""Tokenizer: words, breaks, pauses and spans."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.nlu.lexicon.tokenizer import tokenize

SHORT = {"don't": ("do", "not")}


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("A  Knife\tis used!", ["a", "knife", "is", "used"]),
        ("To pass a knife, grab it", ["to", "pass", "a", "knife", "grab", "it"]),
        ("Don’t “grab” it", ["do", "not", "grab", "it"]),
        ("the knife's blade", ["the", "knife", "'s", "blade"]),
        ("pick-up the mug", ["pick", "up", "the", "mug"]),
        ("One. Two? Three...", ["one", ";", "two", ";", "three"]),
        ("pass me 2 mugs", ["pass", "me", "2", "mugs"]),
        ("pass|cat", ["pass", "|cat"]),
        ("1. Grab it :)", ["grab", "it"]),
        ("1.", ["1"]),
        ("12 mugs (or a lid", ["12", "mugs", "(or", "a", "lid"]),
        ("", []),
        ("?!...", []),
    ],
)
def test_a_text_is_split_into_tokens(text: str, words: list[str]) -> None:
    """Commas, quotes and dashes are dropped; other characters are tokens."""
    assert list(tokenize(text, SHORT).words) == words


@pytest.mark.parametrize(
    ("text", "asks"), [("Why?", True), ("Why?!", True), ("Why", False), ("Why? No.", False)]
)
def test_a_question_mark_at_the_end_is_kept(text: str, asks: bool) -> None:
    """Only the last mark counts."""
    assert tokenize(text, SHORT).asks is asks


def test_no_pause_is_behind_the_last_word() -> None:
    """Marks after the last word are no place in the text."""
    tokens = tokenize('Spell "wurds" (did you mean "words"?)', SHORT)

    assert max(tokens.pauses) <= len(tokens.items)


def test_a_span_is_the_original_text() -> None:
    """The original spelling can be shown again."""
    tokens = tokenize("Pass me, please, the KNIFE", SHORT)

    assert tokens.span(2, 5) == "please, the KNIFE"


@given(st.text(max_size=200))
def test_only_punctuation_is_dropped(text: str) -> None:
    """Every letter of a text is in some token."""
    tokens = tokenize(text, {})

    kept = sum(character.isalpha() for token in tokens.words for character in token)
    assert kept >= sum(
        character.isalpha() for character in tokens.text if len(character.lower()) == 1
    )
