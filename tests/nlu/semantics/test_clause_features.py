"""Features of clauses, read off their words."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.nlu import Language
from hilt.nlu.semantics.clause_features import MAX_COMPARED, check_spellings, load_features
from hilt.ontology.errors import DataError

EMPTY = (
    "categories: {condition: [], name: [], goal: []}\n"
    "nouns: {part: [], elsewhere: [], abstract: []}\n"
    "part_words: []\nholding_words: []\nowners: []\nembedding: []\n"
    "determiners: []\nacts: []\nendings: {abstract: [], nameless: []}\ncarrying: []\nbeing: []\n"
    "containing: []\ndefinite: []\ninterrogative: []\nasking: []\n"
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


ENGLISH = Path(__file__).parents[3] / "ontology" / "english"
WORD_FILES = (
    *("lexicon", "clauses", "attitudes", "constructions"),
    *("requests", "conversation", "fragments"),
)


def written(folder: Path, text: str) -> Path:
    """A word file with a text."""
    path = folder / "mine.yaml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize("name", WORD_FILES)
def test_the_files_of_english_do_not_mix(language: Language, name: str) -> None:
    """Apart from the features that a file lets vary."""
    check_spellings(ENGLISH / f"{name}.yaml", language.parser.features)


@pytest.mark.parametrize(
    ("pattern", "mixed"),
    [
        ("(you|they) hold {x:NP}", ("agent", "addressee", "they")),
        ("[oh] (i think|i am sure)", ("attitude", "think", "certain")),
        ("{x:NP} (was|will be) held", ("tense", "past", "future")),
        ("{x:NP} (might|need not) be", ("modality", "weak", "unnecessary")),
        ("(i heard|they say) [that]", ("source", "hearsay", "other")),
        ("do [not] hold {x:NP}", ("polarity", "affirmative", "negative")),
        ("(most|not all) of", ("quantifier", "most", "partial")),
    ],
)
@pytest.mark.parametrize("line", ['words: [{{says: "{}", is: x}}]', 'classes: {{X: ["oh", "{}"]}}'])
def test_a_pattern_with_two_values_is_refused(
    language: Language, tmp_path: Path, line: str, pattern: str, mixed: tuple[str, ...]
) -> None:
    """The error says where, and names the pattern, the feature and the values."""
    feature, *values = mixed
    path = written(tmp_path, "# mine\n" + line.format(pattern))

    with pytest.raises(DataError) as caught:
        check_spellings(path, language.parser.features)

    said = str(caught.value)
    assert said.startswith(f"{path}:2:")
    assert pattern in said
    assert f"two values of {feature}" in said
    assert all(value in said for value in values)


@pytest.mark.parametrize(
    "text",
    [
        'varies: [agent]\nwords: [{says: "(you|they) hold", is: x}]',
        'words: [{says: ["you hold", "they hold"], is: x}]',
        'constructions: [{says: "[you] (hold|grab) {x:NP}", is: x}]',
        'discourse_markers: {anywhere: ["(i think|i guess)"]}',
    ],
)
def test_what_varies_or_is_written_apart_is_accepted(
    language: Language, tmp_path: Path, text: str
) -> None:
    """Also a pattern with a value that some of its spellings leave out."""
    check_spellings(written(tmp_path, text), language.parser.features)


def test_unknown_features_and_endless_patterns_are_refused(
    language: Language, tmp_path: Path
) -> None:
    """A file cannot let vary what is no feature; too many spellings are not compared."""
    many = " ".join(["(a|b)"] * 15)
    for text, problem in (
        ("varies: [colour]", "colour"),
        (f'classes: {{X: "{many}"}}', "more than"),
    ):
        with pytest.raises(DataError, match=problem):
            check_spellings(written(tmp_path, text), language.parser.features)
    assert MAX_COMPARED < 2**15
