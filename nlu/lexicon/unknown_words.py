# SPDX-License-Identifier: Apache-2.0
"""Unknown words: the entries that a word which is not known may stand for.

An unknown word gets an entry for every role that a name can have, and the chart finds which one
fits the rest of the sentence (Scheutz et al. 2017): "a zib is used for cutting" can only be about
an object.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise

from .inflection import Inflection
from .learned_lexicon import LearnedLexicon
from .lexicon import Entry, Sense
from .loader import NOUN_TEMPLATES, LexiconBuilder, Verb
from .tokenizer import Token, Tokens
from .vocabulary import NewWord

MAX_NEW_WORDS = 3
MIN_LETTERS = 3
MAX_LETTERS = 30

NOUNS = frozenset({"N", "NS", "P", "MS"})
"""The categories of names of things."""

_VERB_COST = 0.5  # a name is likelier than an act: there are more things than things to do
_PERSON_COST = 1.0
_COMPOUND_COST = 0.75
_SINGULAR_COST = 0.25  # what looks like a plural is one
_NAMEABLE_COST = 1.0  # a word of a construction hardly ever names something, too

_NAMED_BY = {
    "object": NOUNS,
    "part": frozenset({"P"}),
    "affordance": frozenset({"K", "KB"}),
    "context": frozenset({"CP/NP", "CG/NP", "C/NP"}),
}


def is_word(token: Token) -> bool:
    """Whether a token can be a word at all."""
    return token.word.isalpha() and MIN_LETTERS <= len(token.word) <= MAX_LETTERS


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

    lexicon: LearnedLexicon
    builder: LexiconBuilder
    inflection: Inflection

    def unknown(self, tokens: Tokens) -> list[Token]:
        """The tokens that are not known."""
        return [token for token in tokens.items if not self.has(token.word)]

    def has(self, word: str) -> bool:
        """Whether a word is known."""
        return word in self.lexicon or word in self.builder.closed

    def names(self, word: str, role: str | None = None) -> bool:
        """Whether a word, in any form, names what a role may be taken for.

        Without a role: whether it occurs in the name of an object, a part or a material.
        """
        if role is None:
            return self.lexicon.is_in_name(word, NOUNS)
        return self.lexicon.is_name(word, _NAMED_BY[role])

    def is_only_part(self, word: NewWord) -> bool:
        """Whether a word for an object is one for a part in the vocabulary of the language."""
        if word.role != "object" or ("part", word.word) in self.lexicon.learned:
            return False
        return self.lexicon.is_name(word.said, ("P",))

    def may_be_a_thing(self, word: str) -> bool:
        """Whether a word names, or may name, an object or a part."""
        if word in self.builder.denied or not self.builder.is_of_grammar(word):
            return True
        return self.lexicon.is_name(word, ("N", "NS", "P"))

    def guesses(self, tokens: Tokens, unknown: Sequence[Token]) -> Mapping[int, Sequence[Entry]]:
        """The entries of new words, and of names of two words, by their places."""
        found = {
            place: self._guesses(
                replace(token, capital=token in unknown) if tokens.is_transcript else token,
                0.0 if token in unknown else _NAMEABLE_COST,
            )
            for place, token in enumerate(tokens.items)
            if token in unknown or self._may_be_taught(tokens, place)
        }
        for place, (first, second) in enumerate(pairwise(tokens.words)):
            is_cut = place + 1 in tokens.pauses or first in self.builder.closed
            names = [] if is_cut else self._compounds(first, second)
            if names:
                found[place] = [*found.get(place, ()), *names]
        return found

    def _guesses(self, token: Token, cost: float) -> list[Entry]:
        """The entries of one word, each marked with its role and dictionary form."""
        roles = self._open_roles(token.word)
        entries = _entries(self.builder, self.inflection, token.word, bool(token.capital), roles)
        return [entry._replace(cost=entry.cost + cost) for entry in entries]

    def _open_roles(self, word: str) -> frozenset[str]:
        """The roles in which a word is not known: what is an object is no part, too."""
        kinds = self.lexicon.name_categories(word)
        taken = {"object": {"N", "NS"}, "part": NOUNS, "affordance": {"K", "KB"}}
        taken["context"] = kinds - NOUNS
        return frozenset(role for role, categories in taken.items() if not categories & kinds)

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
        return self.lexicon.is_name(word, kinds)

    def _may_be_taught(self, tokens: Tokens, place: int) -> bool:
        """Whether a known word may name something new: a hook, the tip, for sticking, to stick.

        It may where a name is expected: after an article and the like, as a gerund, as a plural at
        the beginning or in a list, and a part after a property. "No hook" alone may be "no way".
        """
        words = tokens.words
        word, before = words[place], words[place - 1] if place else ""
        if len(word) < MIN_LETTERS or self.builder.is_of_grammar(word):
            return False
        is_denied = before in self.builder.denying and place < len(words) - 1
        if is_denied or before in self.builder.naming or self.inflection.origins(word, "ing"):
            return True
        if self.lexicon.is_name(word, ("P",)) and self.lexicon.is_name(before, ("AP",)):
            return True
        is_listed = not before or place in tokens.pauses or before in self.builder.joining
        return is_listed and bool(self.inflection.origins(word, "plural"))


@lru_cache(maxsize=8192)
def _entries(
    builder: LexiconBuilder,
    inflection: Inflection,
    word: str,
    is_capital: bool,
    roles: frozenset[str],
) -> tuple[Entry, ...]:
    """The entries that a word would have as a new one in some roles.

    Kept, since building them takes as long as all else, and most words occur again.
    """
    senses = _senses(builder, inflection, word, is_capital=is_capital, roles=roles)
    return tuple(each.entry() for each in senses if each.says == word)


def _senses(
    builder: LexiconBuilder,
    inflection: Inflection,
    word: str,
    *,
    is_capital: bool,
    roles: frozenset[str],
) -> Iterator[Sense]:
    singulars = inflection.origins(word, "plural")
    for role in sorted(roles & NOUN_TEMPLATES.keys()):
        yield from builder.noun(role, word, role=role, cost=_SINGULAR_COST if singulars else 0.0)
        for name in singulars[:1]:
            yield from builder.noun(role, name, role=role)
    if is_capital:
        yield from builder.noun("person", word, role="person", cost=_PERSON_COST)
    for bare in _bare_forms(inflection, word):
        looks_inflected = bare == word and any(
            inflection.origins(word, form) for form in ("ing", "third")
        )
        cost = _SINGULAR_COST if looks_inflected else 0.0
        act, use = Verb(bare, ("new_act",), bare), Verb(bare, ("new_affordance",), None)
        if "context" in roles:
            yield from builder.verb_forms(act, "context", _VERB_COST + cost)
        if "affordance" in roles:
            yield from builder.verb_forms(use, "affordance", cost)


def _bare_forms(inflection: Inflection, word: str) -> Iterator[str]:
    yield word
    for form in ("ing", "third", "participle"):
        yield from inflection.origins(word, form)[:1]
