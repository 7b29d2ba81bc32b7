# SPDX-License-Identifier: Apache-2.0
"""Courtesies: which utterances are polite, and which only have polite words."""

from __future__ import annotations

import pytest

from hilt.nlu import Acknowledgement, Language


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("Many thanks for your patience with my brother", "thanks"),
        ("I am so very sorry", "apology"),
        ("Good evening to the whole household", "greeting"),
        ("You are such a clever little thing", "praise"),
    ],
)
def test_a_part_that_begins_with_a_polite_phrase_is_polite(
    language: Language, text: str, kind: str
) -> None:
    """An interjection may precede it, and a complement may follow."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Acknowledgement)
    assert meaning.ack == kind


@pytest.mark.parametrize(
    "text",
    [
        "The train broke down again this evening",
        "Sing good night to the moon",
        "Write thanks on the card",
        "The neighbours are grateful people",
        "Good morning is what the sign says",
        "He wished good night to the cat",
    ],
)
def test_polite_words_in_other_clauses_are_none(language: Language, text: str) -> None:
    """What is said, written or told of somebody greets and thanks nobody."""
    assert not isinstance(language.understand(text).meaning, Acknowledgement)
