"""Learned lexicon: a lexicon to which words are added while people speak, without any limit.

The words that were learned stand in one flat index by all their forms, however they were learned.
So a lookup takes the same time after 100,000 words, and a new word costs what it has of forms. The
entries of a word are made when it is heard.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property, lru_cache

from .immutable_index import ImmutableIndex
from .lexicon import LazyEntry, Lexicon, LexiconNode
from .loader import LexiconBuilder
from .vocabulary import NewWord

Name = tuple[str, str]  # the role of a name, and its dictionary form

_CACHED_FORMS = 512
"""So many forms are kept with their entries, of which the gerund of a use has a hundred."""


class LearnedLexicon(Lexicon):
    """A lexicon with the words that were learned, in all their forms; immutable.

    Args:
        base: the lexicon of the language, whose entries come after those of learned words.
        builder: makes the entries of names.

    Attributes:
        learned: the words that were learned, by role and dictionary form.
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
