# SPDX-License-Identifier: Apache-2.0
"""Unknown words: the entries that a word may stand for, and the known word that it may misspell.

An unknown word gets an entry for every role that a name can have, and the chart finds which one
fits the rest of the sentence (Scheutz et al. 2017): "a zib is used for cutting" can only be about
an object. About a word one edit away from a known one, by the optimal string alignment distance in
which a transposition is one edit, Hilt asks instead.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import pairwise

from .inflection import Inflection
from .lexicon import Entry, Lexicon, Sense
from .loader import LexiconBuilder, Verb
from .tokenizer import Token, Tokens
from .vocabulary import NewWord

MAX_NEW_WORDS = 3
MIN_LETTERS = 3
MAX_LETTERS = 30
TWO_SLIPS = 9
"""From this length on [letters] a word may be two slips away from a known one."""

NOUNS = frozenset({"N", "NS", "P", "MS"})
"""The categories of names of things."""

_VERB_COST = 0.5  # a name is likelier than an act: there are more things than things to do
_PERSON_COST = 1.0
_COMPOUND_COST = 0.75
_SINGULAR_COST = 0.25  # what looks like a plural is one
_NAMEABLE_COST = 1.0  # a word of a construction hardly ever names something, too

_LIKE = {
    "object": NOUNS,
    "part": frozenset({"P"}),
    "affordance": frozenset({"K", "KB"}),
    "context": frozenset({"CP/NP", "CG/NP", "C/NP"}),
}


def is_word(token: Token) -> bool:
    """Whether a token can be a word at all."""
    return token.word.isalpha() and MIN_LETTERS <= len(token.word) <= MAX_LETTERS


@lru_cache(maxsize=1024)
def closest_word(word: str, known: frozenset[str]) -> str | None:
    """The known word that `word` is most likely a slip of, None when there is none."""
    if len(word) <= MIN_LETTERS:
        return None
    from rapidfuzz import process  # here: most utterances have no unknown word
    from rapidfuzz.distance import OSA

    found = process.extractOne(
        word,
        sorted(other for other in known if len(other) > MIN_LETTERS),
        scorer=OSA.distance,
        score_cutoff=2 if len(word) >= TWO_SLIPS else 1,
    )
    return found[0] if found else None


@lru_cache(maxsize=1024)
def misspelled_word(word: str, known: frozenset[str]) -> str | None:
    """The word of grammar that `word` is one letter away from, by one too many, too few or swapped.

    A word with one letter changed, or another first one, is too often another word: "fork" is no
    slip of "work".
    """
    letters = sorted(word)
    near = (each for each in known if len(each) != len(word) or sorted(each) == letters)
    return closest_word(word, frozenset(each for each in near if each[0] == word[0]))


def is_one_slip(word: str, other: str) -> bool:
    """Whether at most one letter is added, lost, changed or swapped."""
    from rapidfuzz.distance import OSA

    return OSA.distance(word, other, score_cutoff=1) <= 1


def names_for_role(role: str, lexicon: Lexicon) -> frozenset[str]:
    """The words, in all forms, that name what a role may be taken for."""
    return lexicon.named(_LIKE[role])


def new_words(entries: Iterable[Entry]) -> tuple[NewWord, ...]:
    """The new words that a reading rests on, each once."""
    words = (
        NewWord(entry.name, entry.role, entry.says)
        for entry in entries
        if entry.role and entry.role != "person"
    )
    return tuple(dict.fromkeys(words))


@dataclass(frozen=True, repr=False)
class KnownWords:
    """The words that are known, and the entries that all others may stand for."""

    lexicon: Lexicon
    builder: LexiconBuilder
    inflection: Inflection

    @cached_property
    def words(self) -> frozenset[str]:
        """Every single word that the lexicon has."""
        return frozenset(self.lexicon.words())

    @cached_property
    def named(self) -> frozenset[str]:
        """Every single word in the name of an object, a part or a material."""
        return frozenset(word for name in self.lexicon.named(NOUNS) for word in name.split(" "))

    def unknown(self, tokens: Tokens) -> list[Token]:
        """The tokens that are not known."""
        return [token for token in tokens.items if not self._has(token.word)]

    def may_be_a_thing(self, word: str) -> bool:
        """Whether a word names, or may name, an object or a part."""
        names = self._things | self.builder.nameable | self.builder.denied
        return word in names or not self._has(word)

    def guesses(self, tokens: Tokens, unknown: Sequence[Token]) -> Mapping[int, Sequence[Entry]]:
        """The entries of new words, and of names of two words, by their places."""
        found = {
            place: self._guesses(token, 0.0 if token in unknown else _NAMEABLE_COST)
            for place, token in enumerate(tokens.items)
            if token in unknown or token.word in self._unnamed | self._named_within
        }
        for place, (first, second) in enumerate(pairwise(tokens.words)):
            is_cut = place + 1 in tokens.pauses or first in self.builder.closed
            names = [] if is_cut else self._compounds(first, second)
            if names:
                found[place] = [*found.get(place, ()), *names]
        return found

    def _guesses(self, token: Token, cost: float) -> list[Entry]:
        """The entries of one word, each marked with its role and dictionary form."""
        entries = (each.entry() for each in self._senses(token) if each.says == token.word)
        return [entry._replace(cost=entry.cost + cost) for entry in entries]

    def _senses(self, token: Token) -> Iterator[Sense]:
        word, builder = token.word, self.builder
        singulars = self.inflection.origins(word, "plural")
        for role in ("object", "part"):
            yield from builder.noun(
                role, word, role=role, cost=_SINGULAR_COST if singulars else 0.0
            )
            for name in singulars[:1]:
                yield from builder.noun(role, name, role=role)
        if token.capital:
            yield from builder.noun("person", word, role="person", cost=_PERSON_COST)
        for bare in self._bare_forms(word):
            looks_inflected = bare == word and any(
                self.inflection.origins(word, form) for form in ("ing", "third")
            )
            cost = _SINGULAR_COST if looks_inflected else 0.0
            act, use = Verb(bare, ("new_act",), bare), Verb(bare, ("new_affordance",), None)
            yield from builder.verb_forms(act, "context", _VERB_COST + cost)
            yield from builder.verb_forms(use, "affordance", cost)

    def _bare_forms(self, word: str) -> Iterator[str]:
        yield word
        for form in ("ing", "third", "participle"):
            yield from self.inflection.origins(word, form)[:1]

    def _compounds(self, first: str, second: str) -> list[Entry]:
        """The entries of two neighbours as one name: "bread knife", "frying pans".

        The second word, which carries the plural, must be an object or unknown, and the first an
        object, a material or unknown; a pair of known words is a kind of the second.
        """
        if (
            first == second
            or second in self.builder.closed
            or not self._may_name(first, {"N", "MS", "K"})
            or not self._may_name(second, {"N", "NS"})
        ):
            return []
        singular = next(iter(self.inflection.origins(second, "plural")), second)
        found = self.builder.noun(
            "object", f"{first} {singular}", role="object", cost=_COMPOUND_COST
        )
        return [each.entry() for each in found if each.says == f"{first} {second}"]

    def _may_name(self, word: str, kinds: Iterable[str]) -> bool:
        if word not in self.lexicon:
            return word.isalpha() and MIN_LETTERS <= len(word) <= MAX_LETTERS
        return any(word in self.lexicon.names.get(kind, ()) for kind in kinds)

    def _has(self, word: str) -> bool:
        return word in self.lexicon or word in self.builder.closed

    @cached_property
    def _unnamed(self) -> frozenset[str]:
        return self.builder.nameable - self.named

    @cached_property
    def _named_within(self) -> frozenset[str]:
        """Words that occur in longer names only: "soldering" in "soldering iron"."""
        names = {name for names in self.lexicon.names.values() for name in names}
        return self.named - names

    @cached_property
    def _things(self) -> frozenset[str]:
        return self.lexicon.named(("N", "NS", "P"))
