"""Shapes of meanings."""

from __future__ import annotations

import json

import pytest

from hilt.nlu import Language
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.offers.meaning_shapes import composed_shapes, meaning_from_json, shape_of
from hilt.nlu.offers.mentions import find_mentions
from hilt.nlu.semantics.discourse import Discourse

SENTENCES = [
    "A knife is often used for cutting",
    "To pass a knife grab it by the blade",
    "Pass me the red mug by the handle",
    "Do not pick up the spoon",
    "Pound the nail with the hammer",
    "What is a knife used for?",
    "Forget that",
]


@pytest.mark.parametrize("text", SENTENCES)
def test_a_meaning_is_its_json_read_back(language: Language, text: str) -> None:
    """Nothing of a meaning is lost in its JSON object."""
    meaning = language.understand(text).meaning

    assert meaning_from_json(json.loads(json.dumps(meaning.as_json()))) == meaning


def test_a_shape_has_slots_for_what_is_named(language: Language) -> None:
    """The object, the use and the degree become slots."""
    offers, text = language.offers, "A knife is often used for cutting"
    tokens = tokenize(text, language.builder.contractions)
    mentions = find_mentions(tokens, offers.known, offers.degrees, Discourse())

    shape = shape_of(language.understand(text).meaning.as_json(), mentions, {})

    assert shape.slots == ("?object", "?affordance", "?degree")


def test_composed_shapes_are_of_the_schema() -> None:
    """Filled with a name for each slot, every one is a meaning, and is its JSON read back."""
    names = {slot: [0.25, 1.0] for slot in ("?degree", "?degree2")}
    for shape in composed_shapes():
        filled = shape.filled({slot: names.get(slot, slot[1:]) for slot in shape.slots})

        assert json.loads(json.dumps(meaning_from_json(filled).as_json())) == filled
