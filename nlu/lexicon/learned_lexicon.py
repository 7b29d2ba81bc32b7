"""Learned lexicon: a lexicon to which words are added while people speak, without any limit.

The words that were learned stand in one flat index by all their forms, however they were learned.
So a lookup takes the same time after 100,000 words. Entries are made when a word is heard.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import cached_property, lru_cache
from typing import TypeVar

from .lexicon import LazyEntry, Lexicon, LexiconNode
from .loader import LexiconBuilder
from .vocabulary import NewWord

Item = TypeVar("Item")

Name = tuple[str, str]  # the role of a name, and its dictionary form

_CACHED_FORMS = 512
"""So many forms are kept with their entries, of which the gerund of a use has a hundred."""


class LearnedLexicon(Lexicon):
    """A lexicon with the words that were learned, in all their forms; immutable.

    The `learned` words are by role and dictionary form; their entries come before those of `base`.
    """

    def __init__(self, base: Lexicon, builder: LexiconBuilder) -> None:
        super().__init__(base=base)
        self._static, self._builder = base, builder
        self.learned: Mapping[Name, NewWord] = {}
        self._forms: Mapping[str, tuple[Name, ...]] = {}
        # Of names of several words: their lengths by the first word, their roles by each word.
        self._lengths: Mapping[str, tuple[int, ...]] = {}
        self._within: Mapping[str, tuple[str, ...]] = {}
        self._lexicon_of = lru_cache(_CACHED_FORMS)(self._made)

    def with_words(self, words: Iterable[NewWord]) -> "LearnedLexicon":
        """Return this lexicon with further words, itself when it has learned all of them."""
        given = {(word.role, word.word): word for word in words}
        added = {name: word for name, word in given.items() if name not in self.learned}
        if not added:
            return self
        forms = [(form, name) for name in added for form in self._builder.forms(*name)]
        lexicon = LearnedLexicon(self._static, self._builder)
        lexicon._lexicon_of = self._lexicon_of
        lexicon.learned = {**self.learned, **added}
        lexicon._forms = _extended(self._forms, forms)
        split = [(form.split(" "), role) for form, (role, _) in forms if " " in form]
        lexicon._lengths = _extended(self._lengths, ((each[0], len(each)) for each, _ in split))
        within = ((word, role) for each, role in split for word in each)
        lexicon._within = _extended(self._within, within)
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
        names = self._forms.get(words, ())
        own = self._lexicon_of(words, names).name_categories(words) if names else frozenset()
        return own | self._static.name_categories(words)

    def is_in_name(self, word: str, categories: Iterable[str]) -> bool:
        """Whether a word occurs in a name that has one of some categories."""
        kinds = frozenset(categories)
        roles = (*(role for role, _ in self._forms.get(word, ())), *self._within.get(word, ()))
        if any(kinds & self._builder.categories(role) for role in roles):
            return True
        return self._static.is_in_name(word, kinds)

    @cached_property
    def letter_clusters(self) -> frozenset[str]:
        """Those of the language, without learned words."""
        return self._static.letter_clusters

    def nodes(self, tokens: Sequence[str], start: int) -> Iterator[tuple[int, LexiconNode]]:
        """The nodes of all spans that begin at a token and have entries, with their ends."""
        for length in (1, *self._lengths.get(tokens[start], ())):
            words = " ".join(tokens[start : start + length])
            names = self._forms.get(words, ())
            if names:
                yield from self._lexicon_of(words, names).nodes(tokens, start)
        yield from self._static.nodes(tokens, start)

    def _made(self, words: str, names: tuple[Name, ...]) -> Lexicon:
        senses = (sense for name in names for sense in self._builder.name(*name))
        return Lexicon(sense for sense in senses if sense.says == words)


def _extended(
    index: Mapping[str, tuple[Item, ...]], items: Iterable[tuple[str, Item]]
) -> Mapping[str, tuple[Item, ...]]:
    extended = dict(index)
    for key, item in items:
        known = extended.get(key, ())
        extended[key] = known if item in known else (*known, item)
    return extended
