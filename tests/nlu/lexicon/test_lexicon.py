"""Lookup of entries by their words, and their creation on first use."""

from __future__ import annotations

import pytest

from hilt.nlu.grammar.categories import AtomicCategory
from hilt.nlu.grammar.terms import Constant, evaluate
from hilt.nlu.grammar.word_patterns import PatternError
from hilt.nlu.lexicon.lexicon import Entry, LazyEntry, Lexicon

TERM = Constant("knife")


NOUN = AtomicCategory("N")


def sense(says: str, name: str = "", made: list[str] | None = None) -> LazyEntry:
    """A sense of a pattern, which records in `made` that its entry is made."""

    def entry() -> Entry:
        if made is not None:
            made.append(says)
        return Entry(NOUN, TERM, evaluate(TERM), 1, says=says)

    return LazyEntry(says, NOUN, name, entry)


def found(lexicon: Lexicon, text: str) -> list[tuple[int, str]]:
    """The ends of the spans from the first word, with their entries."""
    nodes = lexicon.nodes(text.split(), 0)
    return [(end, entry.says) for end, node in nodes for entry in node.entries]


def test_every_spelling_of_a_pattern_is_found() -> None:
    """One entry stands for all of them."""
    lexicon = Lexicon([sense("pick [it] up"), sense("pick")])

    assert found(lexicon, "pick it up") == [(1, "pick"), (3, "pick [it] up")]
    assert found(lexicon, "pick up it") == [(1, "pick"), (2, "pick [it] up")]


def test_an_entry_is_made_when_it_is_heard() -> None:
    """An entry is made on first use, and only once."""
    made: list[str] = []
    lexicon = Lexicon([sense("the knife", made=made), sense("the fork", made=made)])

    for _ in range(3):
        assert found(lexicon, "the knife") == [(2, "the knife")]

    assert made == ["the knife"]


def test_the_same_entry_is_found_once() -> None:
    """Several equal lines give one entry."""
    lexicon = Lexicon([sense("(a|b)"), sense("(b|c)")])

    assert len(found(lexicon, "b")) == 1


def test_a_lexicon_finds_what_its_base_has() -> None:
    """Its own entries come first; the base does not change."""
    base = Lexicon([sense("knife", name="knife")])
    lexicon = Lexicon([sense("knife blade", name="knife blade")], base)

    assert found(lexicon, "knife blade") == [(2, "knife blade"), (1, "knife")]
    assert lexicon.name_categories("knife") == lexicon.name_categories("knife blade") == {"N"}
    assert "blade" in lexicon
    assert "blade" not in base


def test_a_wrong_pattern_is_refused() -> None:
    """The message says which bracket is missing."""
    with pytest.raises(PatternError, match=r'expected "\)" once more in "\(a"'):
        Lexicon([sense("(a")])
