# SPDX-License-Identifier: Apache-2.0
"""The lexicon: what each word may be, and what it then means.

Entries are found by their words, from any token of an utterance on. They are made by `words` from
`lexicon.yaml` of a language and from the vocabulary of the domain.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from .categories import Category
from .combinators import Sign
from .terms import Term, Value


class Entry(NamedTuple):
    """One reading of a word, or of several words that belong together.

    Attributes:
        words: the tokens it spans.
        category: what it is.
        term: what it means.
        value: the same, ready to be applied.
        sign: the combinator's number of the category.
        cost: how unlikely this reading is.
        name: what the word names, in its dictionary form; empty for words of grammar.
        role: of a word not in the lexicon, what it would be; empty for all others.
    """

    words: tuple[str, ...]
    category: Category
    term: Term
    value: Value
    sign: Sign
    cost: float = 0.0
    name: str = ""
    role: str = ""


@dataclass
class _Node:
    # A plain mutable tree: it is filled while a lexicon is built, and only read afterwards.
    below: dict[str, _Node] = field(default_factory=dict["str", "_Node"])
    entries: list[Entry] = field(default_factory=list[Entry])


class Lexicon:
    """Entries found by their words; a lexicon may rest on another one, which it leaves alone.

    Args:
        entries: the entries.
        base: a lexicon whose entries are found too.
    """

    def __init__(self, entries: Sequence[Entry], base: Lexicon | None = None) -> None:
        self._root = _Node()
        self._base = base
        self._words = frozenset(word for entry in entries for word in entry.words)
        for entry in entries:
            self._add(entry)

    def __contains__(self, word: object) -> bool:
        return word in self._words or (self._base is not None and word in self._base)

    def words(self) -> Iterator[str]:
        """All single words that occur in entries, each once at each level."""
        yield from self._words
        if self._base is not None:
            yield from self._base.words()

    def entries(self) -> Iterator[Entry]:
        """All entries."""
        yield from self._own()
        if self._base is not None:
            yield from self._base.entries()

    def _own(self) -> Iterator[Entry]:
        pending = [self._root]
        while pending:
            node = pending.pop()
            yield from node.entries
            pending += node.below.values()

    @cached_property
    def names(self) -> Mapping[str, frozenset[str]]:
        """All that names something, in all its forms, by category."""
        found: dict[str, set[str]] = defaultdict(set)
        for category, words in self._base.names.items() if self._base is not None else ():
            found[category] |= words
        for entry in self._own():
            if entry.name:
                found[str(entry.category)].add(" ".join(entry.words))
        return {category: frozenset(words) for category, words in found.items()}

    def lookup(self, tokens: Sequence[str], start: int) -> Iterator[tuple[int, Sequence[Entry]]]:
        """The entries of all spans that begin at a token, with the end of the span."""
        node, end = self._root, start
        while end < len(tokens):
            below = node.below.get(tokens[end])
            if below is None:
                break
            node, end = below, end + 1
            if node.entries:
                yield end, node.entries
        if self._base is not None:
            yield from self._base.lookup(tokens, start)

    def _add(self, entry: Entry) -> None:
        node = self._root
        for word in entry.words:
            below = node.below.get(word)
            if below is None:
                below = node.below[word] = _Node()
            node = below
        # A word has few entries; to compare them is cheaper than to hash every term.
        for known in node.entries:
            if known.sign == entry.sign and known.term == entry.term:
                return
        node.entries.append(entry)


@dataclass(frozen=True)
class Frame:
    """One line of a template, checked, with its constants still to be filled in."""

    category: Category
    term: Term
    cost: float


@dataclass(frozen=True)
class Template:
    """All lines of a kind of word, by form ("base", "plural", "ing", ...)."""

    name: str
    constants: tuple[str, ...]
    forms: Mapping[str, tuple[Frame, ...]]
