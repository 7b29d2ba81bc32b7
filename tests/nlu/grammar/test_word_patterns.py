"""Patterns: optional words, choices and gaps."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.nlu.grammar.word_patterns import load_word_lists, read_patterns, spellings, variants
from hilt.nlu.language import LANGUAGES_FOLDER
from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import YamlNode

WORD_LISTS = ("choices", "controls", "courtesies", "offers", "periphery", "procedures")
LANGUAGES = sorted(path.parent for path in LANGUAGES_FOLDER.glob("*/lexicon.yaml"))


def expanded(text: str) -> list[str]:
    """The spellings of a pattern, as texts."""
    return [" ".join(words) for words in spellings(YamlNode(text, "<text>", 1, 1))]


@pytest.mark.parametrize(
    ("pattern", "found"),
    [
        ("used for", ["used for"]),
        ("(a|an|the)", ["a", "an", "the"]),
        ("[please] pass", ["please pass", "pass"]),
        ("when (you|we) [want to]", ["when you want to", "when you", "when we want to", "when we"]),
        ("(pick [it] up|lift)", ["pick it up", "pick up", "lift"]),
    ],
)
def test_a_pattern_stands_for_its_spellings(pattern: str, found: list[str]) -> None:
    """Round brackets choose, square ones may be left out."""
    assert expanded(pattern) == found


@pytest.mark.parametrize("pattern", ["(a|b", "a)", "[a", "a]", "(a]", "[a]"])
def test_a_wrong_pattern_is_refused(pattern: str) -> None:
    """A missing bracket, or a pattern that may be empty, is an error."""
    with pytest.raises(DataError, match="expected"):
        expanded(pattern)


def test_a_pattern_stands_for_a_bounded_number() -> None:
    """A short line cannot fill the memory."""
    with pytest.raises(DataError, match="more than"):
        expanded("(a|b) " * 20)


@pytest.mark.parametrize(
    ("pattern", "found"),
    [
        ("(is|are) a (job|task) for {x:NP}", [("(is|are) a (job|task) for", "{x:NP}")]),
        ("[now] {x:NP}", [("[now]", "{x:NP}"), ("{x:NP}",)]),
        ("take ({x:NP}|it) up", [("take", "{x:NP}", "up"), ("take it up",)]),
        ("use [(the|a) {x:N}]", [("use (the|a)", "{x:N}"), ("use",)]),
    ],
)
def test_only_choices_with_gaps_multiply(pattern: str, found: list[tuple[str, ...]]) -> None:
    """Words between gaps stay one pattern, however many they stand for."""
    assert variants(YamlNode(pattern, "<text>", 1, 1)) == found


@pytest.mark.parametrize("pattern", ["({x:NP}|b", "{x:NP} a)", "[{x:NP}", "({x:NP}]", "[{x:NP}]"])
def test_a_wrong_pattern_with_gaps_is_refused(pattern: str) -> None:
    """The same mistakes are errors as without gaps."""
    with pytest.raises(DataError, match="expected"):
        variants(YamlNode(pattern, "<text>", 1, 1))


@pytest.mark.parametrize("name", WORD_LISTS)
@pytest.mark.parametrize("folder", LANGUAGES, ids=lambda folder: folder.name)
def test_all_languages_have_the_word_lists_of_english(folder: Path, name: str) -> None:
    """A key too few or too many would be noticed only when it is used, or never."""
    lists, english = (
        load_word_lists(each / f"{name}.yaml").file.entries()
        for each in (folder, LANGUAGES_FOLDER / "english")
    )
    assert lists.keys() == english.keys()
    for key, field in lists.items():
        groups = field.entries() if isinstance(field.value, dict) else {key: field}
        assert all(map(read_patterns, groups.values()))


def test_a_missing_word_list_is_an_error(tmp_path: Path) -> None:
    """Its key is read when it is first used."""
    path = tmp_path / "choices.yaml"
    path.write_text("last: [last]\n", encoding="utf-8")
    lists = load_word_lists(path)
    assert lists.has("last", "last")
    with pytest.raises(DataError, match='the key "none" is missing; found last'):
        lists.has("none", "neither")
