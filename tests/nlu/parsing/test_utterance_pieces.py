"""The pieces of an utterance, and what they announce."""

from __future__ import annotations

from itertools import pairwise

import pytest

from hilt.nlu import Language
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.parsing.utterance_pieces import UtterancePiece


def pieces(language: Language, text: str) -> list[UtterancePiece]:
    """The pieces of a text."""
    parser = language.utterance_parser
    return parser.periphery.reader.pieces(tokenize(text, parser.known_words.builder.contractions))


@pytest.mark.parametrize(
    ("text", "forms"),
    [
        ("My hands are wet, so pass me the mug.", ["other", "phrase"]),
        ("Because my tea boils, hand me the mug.", ["reason", "other"]),
        ("I am tired. It rains.", ["own", "impersonal"]),
    ],
)
def test_a_piece_goes_by_how_it_begins(language: Language, text: str, forms: list[str]) -> None:
    """A clause goes by its first word, and whatever has no verb is a phrase."""
    assert [each.form for each in pieces(language, text)] == forms


@pytest.mark.parametrize(
    ("text", "is_told"),
    [
        ("Let me repeat that a spoon is used for stirring.", True),
        ("I never repeat that a spoon is used for stirring.", False),
        ("My aunt repeats that a spoon is used for stirring.", False),
        ("A thing that is used for stirring helps here.", False),
    ],
)
def test_that_begins_a_piece_behind_an_announcement_only(
    language: Language, text: str, *, is_told: bool
) -> None:
    """What speakers announce of their own accord is a piece of its own."""
    assert (len(pieces(language, text)) == 2) == is_told


def test_all_tokens_but_breaks_and_that_are_in_one_piece(language: Language) -> None:
    """The pieces of an utterance follow each other."""
    found = pieces(language, "Here goes: I know that it is odd, but a shoe is used for pounding.")

    assert all(one.end <= two.start <= one.end + 1 for one, two in pairwise(found))
