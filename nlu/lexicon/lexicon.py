"""The lexicon: the categories and lambda terms of each word, found token by token.

A language has many more words than a conversation uses. So an entry is only made when its words
are first heard, and the graphs of patterns become one automaton only along such words.
"""

from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import chain
from typing import NamedTuple, TypeAlias

from ..grammar.categories import Category
from ..grammar.combinators import CombinationTable, Sign
from ..grammar.terms import Term, Value
from ..grammar.word_patterns import Steps, compile_pattern, words_of
from .misspelling import letter_clusters


class Entry(NamedTuple):
    """One reading of a word, or of several words that belong together."""

    category: Category  #: its syntactic category, and `sign` the combinator's number of it
    term: Term  #: its meaning, and `value` the evaluation of that
    value: Value
    sign: Sign
    cost: float = 0.0  #: how unlikely this reading is
    name: str = ""  #: what the word names, in its dictionary form; empty for words of grammar
    role: str = ""  #: of a word not in the lexicon, what it would be; empty for all others
    says: str = ""  #: the words, or a pattern of them


class LazyEntry(NamedTuple):
    """Words, category and name of an entry, and the function that makes it when it is heard."""

    says: str
    category: Category
    name: str
    entry: Callable[[], Entry]


Places: TypeAlias = Sequence[tuple[str, Steps] | int]
"""Places in the graphs of patterns; a number is the end of a pattern."""


@dataclass(frozen=True)
class EntryIndex:
    """The entries of some words, sorted as a chart needs them."""

    plain: Mapping[Sign, Sequence[Entry]]  #: those that are no part of a construction, by sign
    words: Sequence[Entry]  #: those that only are certain words of a construction
    #: those that seek certain words, by one of the words that they seek
    heads: Mapping[Sign, Sequence[Entry]]

    @classmethod
    def of(cls, entries: Iterable[Entry], combinator: CombinationTable) -> "EntryIndex":
        """Sort entries by what they have to do with constructions."""
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
        return cls(dict(plain), tuple(words), dict(heads))


class LexiconNode:
    """A state of the automaton: the entries of the words so far, and the words that may follow."""

    def __init__(self, places: Places, lexicon: "Lexicon") -> None:
        self._places, self._lexicon = places, lexicon
        self._next: dict[str, LexiconNode] = {}
        self._index: EntryIndex | None = None

    @cached_property
    def entries(self) -> Sequence[Entry]:
        """The entries of the words that lead here, each once."""
        found: dict[tuple[Sign, Term], Entry] = {}
        for place in self._places:
            for entry in self._lexicon.entries_at(place) if isinstance(place, int) else ():
                found.setdefault((entry.sign, entry.term), entry)
        return tuple(found.values())

    def next(self, word: str) -> "LexiconNode | None":
        """The node that a word leads to."""
        if word not in self._next and word in self._following:
            self._next[word] = self._lexicon.node(self._following[word])
        return self._next.get(word)

    def index(self, combinator: CombinationTable) -> EntryIndex:
        """The entries, sorted once."""
        self._index = self._index or EntryIndex.of(self.entries, combinator)
        return self._index

    @cached_property
    def _following(self) -> Mapping[str, Places]:
        found: dict[str, list[tuple[str, Steps] | int]] = defaultdict(list)
        for place in self._places:
            if not isinstance(place, int):
                found[place[0]] += place[1]
        return dict(found)


class Lexicon:
    """Entries found by their words; it is filled while a language is loaded.

    Its `senses` become entries when they are heard; those of `base`, which stays, are found, too.
    """

    def __init__(self, senses: Iterable[LazyEntry] = (), base: "Lexicon | None" = None) -> None:
        self._base = base
        self._senses: list[LazyEntry] = []
        self._said: dict[str, list[LazyEntry]] = {}
        self._numbers: list[list[LazyEntry]] = []
        self._places: list[tuple[str, Steps] | int] = []
        self._nodes: dict[tuple[int, ...], LexiconNode] = {}
        self.add(senses)

    def add(self, senses: Iterable[LazyEntry]) -> None:
        """Add readings of some words; a missing bracket in the words is a `PatternError`."""
        for sense in senses:
            known = self._said.get(sense.says)
            if known is None:
                self._places += compile_pattern(sense.says, len(self._numbers))
                known = self._said[sense.says] = []
                self._numbers.append(known)
            known.append(sense)
            self._senses.append(sense)

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

    def senses(self) -> Iterator[LazyEntry]:
        """All senses in the order in which they were added, those of the base last."""
        yield from self._senses
        if self._base is not None:
            yield from self._base.senses()

    def name_categories(self, words: str) -> frozenset[str]:
        """The categories of the names of which some words are a form."""
        return self._categories_of_names.get(words, frozenset())

    @cached_property
    def _categories_of_names(self) -> Mapping[str, frozenset[str]]:
        found: dict[str, set[str]] = defaultdict(set)
        for sense in self.senses():
            if sense.name:
                found[sense.says].add(str(sense.category))
        return {words: frozenset(categories) for words, categories in found.items()}

    def is_name(self, words: str, categories: Iterable[str]) -> bool:
        """Whether some words are a form of a name that has one of some categories."""
        return not self.name_categories(words).isdisjoint(categories)

    def is_in_name(self, word: str, categories: Iterable[str]) -> bool:
        """Whether a word occurs in a name that has one of some categories."""
        return not self._categories_of_words.get(word, frozenset()).isdisjoint(categories)

    def nodes(self, tokens: Sequence[str], start: int) -> Iterator[tuple[int, LexiconNode]]:
        """The nodes of all spans that begin at a token and have entries, with their ends."""
        node = self._root.next(tokens[start])
        end = start + 1
        while node is not None:
            if node.entries:
                yield end, node
            node = node.next(tokens[end]) if end < len(tokens) else None
            end += 1
        if self._base is not None:
            yield from self._base.nodes(tokens, start)

    def own_entries(self, word: str) -> Sequence[Entry]:
        """The entries of a single word in this lexicon, without those of its base."""
        node = self._root.next(word)
        return node.entries if node is not None else ()

    def node(self, places: Places) -> LexiconNode:
        """The node of some places, the same one for the same places."""
        distinct = {id(place): place for place in places}
        key = tuple(distinct)
        if key not in self._nodes:
            self._nodes[key] = LexiconNode(tuple(distinct.values()), self)
        return self._nodes[key]

    def entries_at(self, number: int) -> Iterator[Entry]:
        """The entries at the end of a pattern, by its number."""
        return (sense.entry() for sense in self._numbers[number])

    @cached_property
    def letter_clusters(self) -> frozenset[str]:
        """The sequences of consonants and of vowels in all words of entries."""
        return frozenset(chain.from_iterable(map(letter_clusters, self.words())))

    @cached_property
    def _categories_of_words(self) -> Mapping[str, set[str]]:
        found: dict[str, set[str]] = defaultdict(set)
        for name, categories in self._categories_of_names.items():
            for word in name.split(" "):
                found[word] |= categories
        return dict(found)

    @cached_property
    def _root(self) -> LexiconNode:
        return LexiconNode(self._places, self)
