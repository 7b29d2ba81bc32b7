"""Courtesies: which utterances are polite, and which only have polite words."""

from __future__ import annotations

import pytest

from hilt.nlu import Acknowledgement, Language
from hilt.nlu.semantics.meaning import TrustStatement


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


@pytest.mark.parametrize(
    ("text", "name", "rest"),
    [
        ("I'm Ottokar", "ottokar", ""),
        ("Good evening, my name is Ottokar, from the flat upstairs.", "ottokar", ""),
        ("Call me Ottokar. Pass me the mug.", "ottokar", "Pass me the mug."),
    ],
)
def test_introduction_names_the_speaker(
    language: Language, text: str, name: str, rest: str
) -> None:
    """What is said of the speaker by the way adds nothing, and the rest is understood."""
    found = language.introduction(text)

    assert found is not None
    assert (found.name, found.rest) == (name, rest)


@pytest.mark.parametrize(
    "text",
    ["I am tired", "I'm Ottokar and I want the mug", "Is my name Ottokar?", "I am the owner"],
)
def test_other_words_introduce_nobody(language: Language, text: str) -> None:
    """A word in lower case, a clause that goes on, a question."""
    assert language.introduction(text) is None


@pytest.mark.parametrize(
    ("text", "people", "is_trusted"),
    [
        ("I really trust Ottokar", ["Ottokar"], True),
        ("Robot, please listen to Zoë Ünal", ["Zoë Ünal"], True),
        ("We trust Anna, Ben and Kim too", ["Anna", "Ben", "Kim"], True),
        ("O'Brien may also teach you", ["O'Brien"], True),
        ("Sam can be believed", ["Sam"], True),
        ("You shouldn't believe Anna", ["Anna"], False),
        ("I no longer trust Anna and Ben", ["Anna", "Ben"], False),
        ("Anna must not be trusted", ["Anna"], False),
    ],
)
def test_people_are_trusted_or_not(
    language: Language, text: str, people: list[str], is_trusted: bool
) -> None:
    """Whoever they are; what is said of it in other words is the same."""
    meaning = language.understand(text).meaning

    assert meaning == TrustStatement(tuple(people), not is_trusted)
    assert language.understand(language.generate(meaning)).meaning == meaning


@pytest.mark.parametrize(
    "text",
    ["Can I trust Anna?", "Trust me", "You can trust the knife", "I trust Hammer", "I trust it"],
)
def test_what_is_no_name_is_not_trusted(language: Language, text: str) -> None:
    """Nor is what somebody asks."""
    assert not isinstance(language.understand(text).meaning, TrustStatement)


def test_nobody_is_trusted_who_was_hardly_heard(language: Language) -> None:
    """A recogniser may have heard another name."""
    meaning = language.understand("You can trust Anna", heard=0.4).meaning

    assert not isinstance(meaning, TrustStatement)


@pytest.mark.parametrize(
    ("text", "name"),
    [("My name is Zoë Ünal", "zoë ünal"), ("I'm Ottokar from next door", "ottokar")],
)
def test_speakers_are_introduced_by_their_whole_names(
    language: Language, text: str, name: str
) -> None:
    """What follows the name in small letters is none of it."""
    introduced = language.introduction(text)

    assert introduced is not None
    assert introduced.name == name
