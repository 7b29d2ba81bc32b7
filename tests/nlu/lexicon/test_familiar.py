# SPDX-License-Identifier: Apache-2.0
"""Which words are known, and what the others may be."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.lexicon.familiar import KnownWords
from hilt.nlu.lexicon.tokenizer import tokenize


@pytest.fixture
def known_words(language: Language) -> KnownWords:
    """The words that English has."""
    return language.hearing.known_words


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("a zorp is used for cutting", ["zorp"]),
        ("a knife is used for cutting", []),
        ("nothing is used for florping", ["florping"]),
    ],
)
def test_what_no_lexicon_has_is_unknown(
    known_words: KnownWords, text: str, words: list[str]
) -> None:
    """Words of grammar are known, also those that Hilt has no use for."""
    assert [token.word for token in known_words.unknown(tokenize(text, {}))] == words


def test_an_unknown_word_may_be_everything_a_name_can_be(known_words: KnownWords) -> None:
    """An object, a part, an act or a use; the rest of the sentence decides."""
    tokens = tokenize("to zorp it", {})

    guessed = known_words.guesses(tokens, known_words.unknown(tokens))

    roles = {entry.role for entry in guessed[1]}
    assert roles == {"object", "part", "context", "affordance"}


def test_a_word_of_a_turn_of_phrase_may_be_taught(known_words: KnownWords) -> None:
    """The word "store" adds nothing in some turns, and is an act in a lesson all the same."""
    tokens = tokenize("to store it", {})

    assert known_words.unknown(tokens) == []
    assert 1 in known_words.guesses(tokens, [])


def test_a_name_goes_over_no_pause(known_words: KnownWords) -> None:
    """A cake knife is one thing; "cake, knife" are two."""

    def names(text: str) -> set[str]:
        tokens = tokenize(text, {})
        found = known_words.guesses(tokens, known_words.unknown(tokens))
        return {entry.says for entries in found.values() for entry in entries if " " in entry.says}

    assert "zorp knife" in names("zorp knife")
    assert "zorp knife" not in names("zorp, knife")
