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
from .combinators import Sign, Turn
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


@dataclass(frozen=True)
class Sorted:
    """The entries of some words, as a chart needs them.

    Attributes:
        plain: those that are no part of a construction, by sign.
        words: those that only are certain words of a construction.
        heads: those that seek certain words, by one of the words that they seek.
    """

    plain: Mapping[Sign, Sequence[Entry]]
    words: Sequence[Entry]
    heads: Mapping[Sign, Sequence[Entry]]


@dataclass
class Node:
    """A place in the tree of a lexicon: the entries of the words that lead to it.

    It is filled while a lexicon is built, and only read afterwards.
    """

    below: dict[str, Node] = field(default_factory=dict["str", "Node"])
    entries: list[Entry] = field(default_factory=list[Entry])
    _sorted: Sorted | None = None

    def sorted(self, turns: Mapping[Sign, Turn]) -> Sorted:
        """The entries, sorted once.

        Args:
            turns: what signs have to do with the words of constructions.
        """
        if self._sorted is None:
            self._sorted = _sorted(self.entries, turns)
        return self._sorted


def _sorted(entries: Sequence[Entry], turns: Mapping[Sign, Turn]) -> Sorted:
    plain: dict[Sign, list[Entry]] = defaultdict(list)
    heads: dict[Sign, list[Entry]] = defaultdict(list)
    words: list[Entry] = []
    for entry in entries:
        turn = turns.get(entry.sign)
        if turn is None:
            plain[entry.sign].append(entry)
        elif turn.is_words:
            words.append(entry)
        else:
            heads[min(turn.needs)].append(entry)
    return Sorted(dict(plain), tuple(words), dict(heads))


class Lexicon:
    """Entries found by their words; a lexicon may rest on another one, which it leaves alone.

    Args:
        entries: the entries.
        base: a lexicon whose entries are found too.
    """

    def __init__(self, entries: Sequence[Entry], base: Lexicon | None = None) -> None:
        self._root = Node()
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
        return ((end, node.entries) for end, node in self.nodes(tokens, start))

    def nodes(self, tokens: Sequence[str], start: int) -> Iterator[tuple[int, Node]]:
        """The nodes of all spans that begin at a token and have entries, with their ends."""
        node, end = self._root, start
        while end < len(tokens):
            below = node.below.get(tokens[end])
            if below is None:
                break
            node, end = below, end + 1
            if node.entries:
                yield end, node
        if self._base is not None:
            yield from self._base.nodes(tokens, start)

    def _add(self, entry: Entry) -> None:
        node = self._root
        for word in entry.words:
            below = node.below.get(word)
            if below is None:
                below = node.below[word] = Node()
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
