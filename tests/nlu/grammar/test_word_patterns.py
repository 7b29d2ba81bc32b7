"""Patterns: optional words, choices and gaps."""

from __future__ import annotations

import pytest

from hilt.nlu.grammar.word_patterns import spellings, variants
from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import YamlNode


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
