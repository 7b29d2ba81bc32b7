"""Answers to numbered choices."""

from __future__ import annotations

import pytest

from hilt.nlu import Language


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("1", 1),
        ("one", 1),
        ("the first", 1),
        ("the first one, please", 1),
        ("number two", 2),
        ("I meant the second one", 2),
        ("the last one", 3),
        ("neither", 0),
        ("none of them", 0),
        ("never mind", 0),
        ("pass me the mug", None),
        ("yes", None),
        ("4", None),
        ("the first or the second", None),
    ],
)
def test_an_answer_takes_a_choice(language: Language, text: str, number: int | None) -> None:
    """A number, an ordinal or a refusal; anything else is a new utterance."""
    assert language.chosen(text, 3) == number
