"""Learned lexicon: a lexicon to which words are added while people speak, without any limit.

The words that were learned stand in one flat index by all their forms, however they were learned.
So a lookup takes the same time after 100,000 words, and a new word costs what it has of forms. The
entries of a word are made when it is heard.

All versions of an index write to one log and see it up to their own size (a fully persistent
append-only list after Driscoll et al. 1989, without the version tree). Only what is added to a
version that is not the newest is preceded by a copy.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from itertools import chain, islice
from typing import TypeVar

from .lexicon import LazyEntry, Lexicon, LexiconNode
from .loader import LexiconBuilder
from .vocabulary import NewWord

Key = TypeVar("Key")
Item = TypeVar("Item")

Name = tuple[str, str]  # the role of a name, and its dictionary form

_CACHED_FORMS = 512
"""So many forms are kept with their entries, of which the gerund of a use has a hundred."""


class ImmutableIndex(Mapping[Key, Item]):
    """A mapping from each key to its first item, which also has the later ones."""

    def __init__(self, items: Iterable[tuple[Key, Item]] = ()) -> None:
        self._log: list[Key] = []  # the key of each item, in the order in which they were added
        self._items: dict[Key, list[tuple[int, Item]]] = {}
        self._size = 0
        self._append(items)

    def with_items(self, items: Iterable[tuple[Key, Item]]) -> ImmutableIndex[Key, Item]:
        """Return this index with further items; an item that a key has already is left out."""
        if len(self._log) > self._size:  # another version has written to the log
            own = ((key, item) for key in self for item in self.all(key))
            return ImmutableIndex(chain(own, items))
        added = ImmutableIndex[Key, Item]()
        added._log, added._items, added._size = self._log, self._items, self._size
        added._append(items)
        return added

    def all(self, key: Key) -> tuple[Item, ...]:
        """All items of a key in the order in which they were added."""
        found = self._items.get(key, ())
        return tuple(item for number, item in found if number < self._size)

    def __getitem__(self, key: Key) -> Item:
        number, item = self._items[key][0]
        if number >= self._size:
            raise KeyError(key)
        return item

    def __iter__(self) -> Iterator[Key]:
        written = enumerate(islice(self._log, self._size))
        return (key for number, key in written if self._items[key][0][0] == number)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def _append(self, items: Iterable[tuple[Key, Item]]) -> None:
        for key, item in items:
            if item not in self.all(key):
                self._items.setdefault(key, []).append((self._size, item))
                self._log.append(key)
                self._size += 1


class LearnedLexicon(Lexicon):
    """A lexicon with the words that were learned, in all their forms; immutable.

    The `learned` words are by role and dictionary form; their entries come before those of `base`.
    """

    def __init__(self, base: Lexicon, builder: LexiconBuilder) -> None:
        super().__init__(base=base)
        self._static, self._builder = base, builder
        self.learned: ImmutableIndex[Name, NewWord] = ImmutableIndex()
        self._forms: ImmutableIndex[str, Name] = ImmutableIndex()
        # Of names of several words: their lengths by the first word, their roles by each word.
        self._lengths: ImmutableIndex[str, int] = ImmutableIndex()
        self._within: ImmutableIndex[str, str] = ImmutableIndex()
        self._lexicon_of = lru_cache(_CACHED_FORMS)(self._made)

    def with_words(self, words: Iterable[NewWord]) -> LearnedLexicon:
        """Return this lexicon with further words, itself when it has learned all of them."""
        added = {(word.role, word.word): word for word in words}
        forms = [
            (form, name)
            for name in added
            if name not in self.learned
            for form in self._builder.forms(*name)
        ]
        if not forms:
            return self
        lexicon = LearnedLexicon(self._static, self._builder)
        lexicon._lexicon_of = self._lexicon_of
        lexicon.learned = self.learned.with_items(added.items())
        lexicon._forms = self._forms.with_items(forms)
        split = [(form.split(" "), role) for form, (role, _) in forms if " " in form]
        lexicon._lengths = self._lengths.with_items((each[0], len(each)) for each, _ in split)
        lexicon._within = self._within.with_items(
            (word, role) for each, role in split for word in each
        )
        return lexicon

    def __contains__(self, word: object) -> bool:
        return word in self._forms or word in self._within or word in self._static

    def words(self) -> Iterator[str]:
        """All single words that occur in entries."""
        yield from (form for form in self._forms if " " not in form)
        yield from self._within
        yield from self._static.words()

    def senses(self) -> Iterator[LazyEntry]:
        """All senses, those of learned words first."""
        for role, word in self.learned:
            yield from self._builder.name(role, word)
        yield from self._static.senses()

    def name_categories(self, words: str) -> frozenset[str]:
        """The categories of the names of which some words are a form."""
        names = self._forms.all(words)
        own = self._lexicon_of(words, names).name_categories(words) if names else frozenset()
        return own | self._static.name_categories(words)

    def is_in_name(self, word: str, categories: Iterable[str]) -> bool:
        """Whether a word occurs in a name that has one of some categories."""
        kinds = frozenset(categories)
        roles = (*(role for role, _ in self._forms.all(word)), *self._within.all(word))
        if any(kinds & self._builder.categories(role) for role in roles):
            return True
        return self._static.is_in_name(word, kinds)

    @cached_property
    def letter_clusters(self) -> frozenset[str]:
        """Those of the language, without learned words."""
        return self._static.letter_clusters

    def nodes(self, tokens: Sequence[str], start: int) -> Iterator[tuple[int, LexiconNode]]:
        """The nodes of all spans that begin at a token and have entries, with their ends."""
        for length in (1, *self._lengths.all(tokens[start])):
            words = " ".join(tokens[start : start + length])
            names = self._forms.all(words)
            if names:
                yield from self._lexicon_of(words, names).nodes(tokens, start)
        yield from self._static.nodes(tokens, start)

    def _made(self, words: str, names: tuple[Name, ...]) -> Lexicon:
        senses = (sense for name in names for sense in self._builder.name(*name))
        return Lexicon(sense for sense in senses if sense.says == words)
