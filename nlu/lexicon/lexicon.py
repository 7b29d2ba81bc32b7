# SPDX-License-Identifier: Apache-2.0
"""The lexicon: what each word may be, and what it then means.

Entries are found by their words, from any token of an utterance on. They are made by `words` from
`lexicon.yaml` of a language and from the vocabulary of the domain. A language has many more words
than a conversation uses: an entry is made when its words are heard for the first time, and the
graphs of all patterns are joined only along the words that were heard.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

from ..grammar.categories import Category
from ..grammar.combinators import Combinator, Sign
from ..grammar.patterns import Steps, steps_of, words_of
from ..grammar.terms import Term, Value


class Entry(NamedTuple):
    """One reading of a word, or of several words that belong together.

    Attributes:
        category: what it is.
        term: what it means.
        value: the same, ready to be applied.
        sign: the combinator's number of the category.
        cost: how unlikely this reading is.
        name: what the word names, in its dictionary form; empty for words of grammar.
        role: of a word not in the lexicon, what it would be; empty for all others.
        says: the words, or a pattern of them.
    """

    category: Category
    term: Term
    value: Value
    sign: Sign
    cost: float = 0.0
    name: str = ""
    role: str = ""
    says: str = ""

    def entry(self) -> Entry:
        """This entry, which is made already."""
        return self


class Sense(Protocol):
    """What becomes an entry when its words are heard."""

    @property
    def category(self) -> Category:
        """As that of the entry."""
        ...

    @property
    def name(self) -> str:
        """As that of the entry."""
        ...

    @property
    def says(self) -> str:
        """As that of the entry."""
        ...

    def entry(self) -> Entry:
        """The entry, made now."""
        ...


@dataclass(frozen=True)
class EntryIndex:
    """The entries of some words, as a chart needs them.

    Attributes:
        plain: those that are no part of a construction, by sign.
        words: those that only are certain words of a construction.
        heads: those that seek certain words, by one of the words that they seek.
    """

    plain: Mapping[Sign, Sequence[Entry]]
    words: Sequence[Entry]
    heads: Mapping[Sign, Sequence[Entry]]


def _sorted(entries: Sequence[Entry], combinator: Combinator) -> EntryIndex:
    plain: dict[Sign, list[Entry]] = defaultdict(list)
    heads: dict[Sign, list[Entry]] = defaultdict(list)
    words: list[Entry] = []
    for entry in entries:
        turn = combinator.turn(entry.sign)
        if turn.is_words:
            words.append(entry)
        elif turn.needs:
            heads[min(turn.needs)].append(entry)
        else:
            plain[entry.sign].append(entry)
    return EntryIndex(dict(plain), tuple(words), dict(heads))


class LexiconNode:
    """What was heard of the words of a lexicon so far: what it may be, and how it may go on.

    Args:
        steps: the places in the graphs of patterns.
        lexicon: the lexicon.
    """

    def __init__(self, steps: Sequence[tuple[str, Steps] | int], lexicon: Lexicon) -> None:
        self._steps, self._lexicon = steps, lexicon
        self._after: dict[str, LexiconNode] = {}
        self._sorted: EntryIndex | None = None

    @cached_property
    def entries(self) -> Sequence[Entry]:
        """What the words that lead here are, each once."""
        found: dict[tuple[Sign, Term], Entry] = {}
        for step in self._steps:
            for entry in self._lexicon.entries_at(step) if isinstance(step, int) else ():
                found.setdefault((entry.sign, entry.term), entry)
        return tuple(found.values())

    def after(self, word: str) -> LexiconNode | None:
        """The node that a word leads to."""
        found = self._after.get(word)
        if found is None and word in self._below:
            found = self._after[word] = self._lexicon.node(self._below[word])
        return found

    def sorted(self, combinator: Combinator) -> EntryIndex:
        """The entries, sorted once."""
        if self._sorted is None:
            self._sorted = _sorted(self.entries, combinator)
        return self._sorted

    @cached_property
    def _below(self) -> Mapping[str, Sequence[tuple[str, Steps] | int]]:
        found: dict[str, list[tuple[str, Steps] | int]] = defaultdict(list)
        for step in self._steps:
            if not isinstance(step, int):
                found[step[0]] += step[1]
        return dict(found)


class Lexicon:
    """Entries found by their words; a lexicon may rest on another one, which it leaves alone.

    It is filled while a language is read, and only read afterwards.

    Args:
        senses: what becomes the entries.
        base: a lexicon whose entries are found too.
    """

    def __init__(self, senses: Iterable[Sense] = (), base: Lexicon | None = None) -> None:
        self._base = base
        self._senses: list[Sense] = []
        self._said: dict[str, list[Sense]] = {}
        self._numbers: list[list[Sense]] = []
        self._steps: list[tuple[str, Steps] | int] = []
        self._nodes: dict[tuple[int, ...], LexiconNode] = {}
        self.add_all(senses)

    def add(self, sense: Sense) -> None:
        """Know one more reading of some words.

        Raises:
            PatternError: its words are no pattern.
        """
        known = self._said.get(sense.says)
        if known is None:
            self._steps += steps_of(sense.says, len(self._numbers))
            known = self._said[sense.says] = []
            self._numbers.append(known)
        known.append(sense)
        self._senses.append(sense)

    def add_all(self, senses: Iterable[Sense]) -> None:
        """Know further readings of some words; as `add`."""
        for sense in senses:
            self.add(sense)

    def __contains__(self, word: object) -> bool:
        return word in self.own_words or (self._base is not None and word in self._base)

    def words(self) -> Iterator[str]:
        """All single words that occur in entries, each once at each level."""
        yield from self.own_words
        if self._base is not None:
            yield from self._base.words()

    @cached_property
    def own_words(self) -> frozenset[str]:
        """All single words that occur in entries of this lexicon, and not of its base."""
        return frozenset(words_of(" ".join(self._said)))

    def senses(self) -> Iterator[Sense]:
        """All that becomes an entry, in the order in which it was added, and the own first."""
        yield from self._senses
        if self._base is not None:
            yield from self._base.senses()

    @cached_property
    def names(self) -> Mapping[str, frozenset[str]]:
        """All that names something, in all its forms, by category."""
        found: dict[str, set[str]] = defaultdict(set)
        for category, words in self._base.names.items() if self._base is not None else ():
            found[category] |= words
        for sense in self._senses:
            if sense.name:
                found[str(sense.category)].add(sense.says)
        return {category: frozenset(words) for category, words in found.items()}

    def nodes(self, tokens: Sequence[str], start: int) -> Iterator[tuple[int, LexiconNode]]:
        """The nodes of all spans that begin at a token and have entries, with their ends."""
        node = self._root.after(tokens[start])
        end = start + 1
        while node is not None:
            if node.entries:
                yield end, node
            node = node.after(tokens[end]) if end < len(tokens) else None
            end += 1
        if self._base is not None:
            yield from self._base.nodes(tokens, start)

    def node(self, steps: Sequence[tuple[str, Steps] | int]) -> LexiconNode:
        """The node of some places, the same one for the same places."""
        places = {id(step): step for step in steps}
        key = tuple(places)
        found = self._nodes.get(key)
        if found is None:
            found = self._nodes[key] = LexiconNode(tuple(places.values()), self)
        return found

    def entries_at(self, number: int) -> Iterator[Entry]:
        """The entries at the end of a pattern, by its number."""
        return (sense.entry() for sense in self._numbers[number])

    @cached_property
    def _root(self) -> LexiconNode:
        return LexiconNode(self._steps, self)


@dataclass(frozen=True)
class EntryTemplate:
    """One line of a template, checked, with its constants still to be filled in."""

    category: Category
    term: Term
    cost: float


@dataclass(frozen=True)
class Template:
    """All lines of a kind of word, by form ("base", "plural", "ing", ...)."""

    name: str
    constants: tuple[str, ...]
    forms: Mapping[str, tuple[EntryTemplate, ...]]
