"""What an utterance refers to that it does not name: objects, uses and acts of the turns before."""

from __future__ import annotations

import pytest

from hilt.nlu import Language, Session
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.offers.mentions import Mentions


def mentions(language: Language, *before: str, text: str) -> Mentions:
    """What a text names and refers to after other utterances."""
    session = Session(language).after(before)
    tokens = tokenize(text, language.builder.contractions)
    return language.offers.mentions(tokens, session.discourse)


def referred(found: Mentions) -> set[tuple[str, str]]:
    """The roles and names to which an utterance refers."""
    return {(each.role, each.name) for each in found.references}


@pytest.mark.parametrize(
    ("before", "text", "expected"),
    [
        ("A knife is used for cutting bread.", "Scissors, rarely.", ("affordance", "cutting")),
        ("A knife is used for cutting bread.", "Scissors, rarely.", ("material", "bread")),
        ("To pass a knife, grab it by the blade.", "The handle, really.", ("act", "pass")),
        ("Pick up the mug.", "Well, the rim.", ("act", "pickUp")),
        ("Is a shoe used for pounding?", "It can be.", ("affordance", "pounding")),
        ("Now who would ever do cutting, eh.", "The knife would.", ("affordance", "cutting")),
    ],
)
def test_an_utterance_refers_to_what_the_last_turn_named(
    language: Language, before: str, text: str, expected: tuple[str, str]
) -> None:
    """A use, its material and an act stay meant, also where the turn was not understood."""
    assert expected in referred(mentions(language, before, text=text))


def test_what_is_named_is_not_taken_from_before(language: Language) -> None:
    """A use that is named is meant, and no other; the same goes for acts."""
    found = mentions(language, "A knife is used for cutting.", text="The mug, for pounding?")
    assert not [role for role, _ in referred(found) if role == "affordance"]


def test_a_turn_that_is_understood_ends_what_a_failed_one_named(language: Language) -> None:
    """The use that a failed turn named is no longer meant after another rule."""
    before = ("Now who would ever do cutting, eh.", "A spoon is used for stirring.")
    assert ("affordance", "cutting") not in referred(mentions(language, *before, text="A fork."))


def test_both_of_two_objects_may_be_meant(language: Language) -> None:
    """The one before the last is what "the other one" may stand for."""
    before = ("What is a knife used for?", "What is a mug used for?")
    found = referred(mentions(language, *before, text="And the other one, by the handle?"))
    assert {("object", "mug"), ("object", "knife")} <= found
