"""Features of clauses, read off their words."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.nlu import Language
from hilt.nlu.semantics.clause_features import load_features
from hilt.ontology.errors import DataError

EMPTY = (
    "categories: {condition: [], name: [], goal: []}\n"
    "nouns: {part: [], elsewhere: [], abstract: []}\n"
    "part_words: []\nholding_words: []\nowners: []\nembedding: []\n"
    "determiners: []\nacts: []\nendings: {abstract: [], nameless: []}\ncarrying: []\n"
)


@pytest.mark.parametrize(
    ("text", "features"),
    [
        ("a knife is used for cutting", {}),
        ("you might pass a knife by the blade", {"agent": ["addressee"], "modality": ["weak"]}),
        ("a shoe is being used for pounding", {"tense": ["progressive"]}),
        (
            "when you hand me a knife, I grab it by the handle",
            {"agent": ["speaker"], "act": ["fetch"], "condition": {"agent": ["addressee"]}},
        ),
        ("apparently a shoe is used for pounding", {"aside": {"source": ["hearsay"]}}),
        ("when you pick up a mug, hold your breath", {"part": ["own"]}),
        ("to pick up a pan, grab a towel", {"part": ["new"]}),
        ("pick up the pace", {"thing": ["abstract"]}),
    ],
)
def test_features_are_read_off_the_words(
    language: Language, text: str, features: dict[str, object]
) -> None:
    """Whatever entry of the lexicon took a word, its feature is there."""
    reading = language.understand(text).reading

    assert reading is not None
    assert features.items() <= reading.features.as_json().items()


def test_two_values_of_one_feature_are_refused(tmp_path: Path) -> None:
    """A phrase has one value of a feature."""
    path = tmp_path / "features.yaml"
    path.write_text(f"{EMPTY}features: {{agent: {{one: [you], two: [you]}}}}", encoding="utf-8")

    with pytest.raises(DataError, match="two values of agent"):
        load_features(path)
