# SPDX-License-Identifier: Apache-2.0
"""Entries found by their words, and made when these are heard."""

from __future__ import annotations

from dataclasses import dataclass, field

import pytest

from hilt.nlu.grammar.categories import AtomicCategory, Category
from hilt.nlu.grammar.patterns import PatternError
from hilt.nlu.grammar.terms import Constant, evaluate
from hilt.nlu.lexicon.lexicon import Entry, Lexicon

TERM = Constant("knife")


@dataclass
class Later:
    """An entry that counts how often it is made."""

    says: str
    name: str = ""
    category: Category = field(default_factory=lambda: AtomicCategory("N"))
    made: int = 0

    def entry(self) -> Entry:
        """The entry."""
        self.made += 1
        return Entry(self.category, TERM, evaluate(TERM), 1, says=self.says)


def found(lexicon: Lexicon, text: str) -> list[tuple[int, str]]:
    """The ends of the spans from the first word on, with what stands there."""
    nodes = lexicon.nodes(text.split(), 0)
    return [(end, entry.says) for end, node in nodes for entry in node.entries]


def test_every_spelling_of_a_pattern_is_found() -> None:
    """One entry stands for all of them."""
    lexicon = Lexicon([Later("pick [it] up"), Later("pick")])

    assert found(lexicon, "pick it up") == [(1, "pick"), (3, "pick [it] up")]
    assert found(lexicon, "pick up it") == [(1, "pick"), (2, "pick [it] up")]


def test_an_entry_is_made_when_it_is_heard() -> None:
    """And only once."""
    said, unsaid = Later("the knife"), Later("the fork")
    lexicon = Lexicon([said, unsaid])

    for _ in range(3):
        assert found(lexicon, "the knife") == [(2, "the knife")]

    assert (said.made, unsaid.made) == (1, 0)


def test_the_same_entry_is_found_once() -> None:
    """However many lines say it."""
    lexicon = Lexicon([Later("(a|b)"), Later("(b|c)")])

    assert len(found(lexicon, "b")) == 1


def test_a_lexicon_finds_what_its_base_has() -> None:
    """Its own first; the base stays as it is."""
    base = Lexicon([Later("knife", name="knife")])
    lexicon = Lexicon([Later("knife blade", name="knife blade")], base)

    assert found(lexicon, "knife blade") == [(2, "knife blade"), (1, "knife")]
    assert lexicon.names == {"N": {"knife", "knife blade"}}
    assert "blade" in lexicon
    assert "blade" not in base


def test_a_wrong_pattern_is_refused() -> None:
    """The message says which bracket is missing."""
    with pytest.raises(PatternError, match=r'expected "\)" once more in "\(a"'):
        Lexicon([Later("(a")])
