# SPDX-License-Identifier: Apache-2.0
"""Words that the lexicon does not have: what they may be, or which known word they miss.

The rest of a sentence tells the role of an unknown word: "a zib is used for cutting" can only be
about an object. So an unknown word is given every role a name can have, and the chart finds which
one fits (Scheutz et al. 2017). A word one slip away from a known one is not new: Hilt asks.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from functools import lru_cache

from .inflection import Inflection
from .lexicon import Entry, Lexicon
from .loader import LexiconBuilder, Verb
from .senses import TemplateSense
from .tokenizer import Token
from .vocabulary import NewWord

MAX_NEW_WORDS = 3
MIN_LETTERS = 3
MAX_LETTERS = 30
TWO_SLIPS = 9
"""From this length on [letters] a word may be two slips away from a known one."""

_VERB_COST = 0.5  # a name is likelier than an act: there are more things than things to do
_PERSON_COST = 1.0
_COMPOUND_COST = 0.75
_SINGULAR_COST = 0.25  # what looks like a plural is one


def is_word(token: Token) -> bool:
    """Whether a token could be a word at all."""
    return token.word.isalpha() and MIN_LETTERS <= len(token.word) <= MAX_LETTERS


@lru_cache(maxsize=1024)
def closest_word(word: str, known: frozenset[str]) -> str | None:
    """The known word that `word` is most likely a slip of, None when there is none."""
    if len(word) <= MIN_LETTERS:
        return None
    allowed = 2 if len(word) >= TWO_SLIPS else 1
    best: str | None = None
    for other in sorted(known):
        if len(other) <= MIN_LETTERS or abs(len(other) - len(word)) > allowed:
            continue
        found = edit_distance(word, other, allowed)
        if found <= allowed:
            best, allowed = other, found - 1
    return best


@lru_cache(maxsize=1024)
def misspelled_word(word: str, known: frozenset[str]) -> str | None:
    """The word of grammar that `word` is one letter away from, by one too many, too few or swapped.

    A word with one letter changed, or another first one, is too often another word: "fork" is no
    slip of "work".
    """
    letters = sorted(word)
    near = (each for each in known if len(each) != len(word) or sorted(each) == letters)
    return closest_word(word, frozenset(each for each in near if each[0] == word[0]))


def names_for_role(role: str, lexicon: Lexicon) -> frozenset[str]:
    """The words, in all forms, that name what a role may be taken for."""
    return frozenset[str]().union(*(lexicon.names.get(kind, ()) for kind in _LIKE[role]))


NOUNS = frozenset({"N", "NS", "P", "MS"})

_LIKE = {
    "object": NOUNS,
    "part": frozenset({"P"}),
    "affordance": frozenset({"K", "KB"}),
    "context": frozenset({"CP/NP", "CG/NP", "C/NP"}),
}


def edit_distance(one: str, other: str, limit: int) -> int:
    """How many letters are added, lost, changed or swapped; more than `limit` is `limit + 1`."""
    before: list[int] = []
    row = list(range(len(other) + 1))
    for i, letter in enumerate(one, start=1):
        above, before, row = before, row, [i]
        for j, wanted in enumerate(other, start=1):
            cost = min(before[j] + 1, row[j - 1] + 1, before[j - 1] + (letter != wanted))
            swapped = i > 1 and j > 1 and letter == other[j - 2] and one[i - 2] == wanted
            row.append(min(cost, above[j - 2] + 1) if swapped else cost)
        if min(row) > limit:
            return limit + 1
    return min(row[-1], limit + 1)


def guesses(
    token: Token, builder: LexiconBuilder, inflection: Inflection, *, cost: float = 0.0
) -> list[Entry]:
    """All that an unknown word may be, each entry marked with its role and dictionary form.

    Args:
        token: the word.
        book: how entries are made.
        inflection: forms of words.
        cost: how unlikely it is that it names anything at all.
    """
    word = token.word
    found: list[TemplateSense] = []
    singulars = inflection.origins(word, "plural")
    for role in ("object", "part"):
        found += builder.noun(role, word, role=role, cost=_SINGULAR_COST if singulars else 0.0)
        for name in singulars[:1]:
            found += builder.noun(role, name, role=role)
    if token.capital:
        found += builder.noun("person", word, role="person", cost=_PERSON_COST)
    for bare in _bare_forms(word, inflection):
        verb = Verb(bare, ("new_act",), bare)
        looks_inflected = bare == word and inflection.origins(word, "ing")
        unlikely = _VERB_COST + (_SINGULAR_COST if looks_inflected else 0.0)
        found += builder.verb_forms(verb, role="context", cost=unlikely)
        verb = Verb(bare, ("new_affordance",), None)
        found += builder.verb_forms(verb, role="affordance")
    entries = (each.entry() for each in found if each.says == word)
    return [entry._replace(cost=entry.cost + cost) for entry in entries]


def compounds(
    first: str, second: str, builder: LexiconBuilder, inflection: Inflection, lexicon: Lexicon
) -> list[Entry]:
    """What two neighbours may be as one name: "bread knife", "frying pans".

    The second word, which carries the plural, must be an object or unknown, and the first an
    object, a stuff or unknown; of words that are both known the pair is a kind of the second.
    """
    if (
        first == second
        or not _may_name(first, lexicon)
        or not _may_name(second, lexicon, last=True)
    ):
        return []
    singular = next(iter(inflection.origins(second, "plural")), second)
    name = f"{first} {singular}"
    found = builder.noun("object", name, role="object", cost=_COMPOUND_COST)
    return [each.entry() for each in found if each.says == f"{first} {second}"]


def _may_name(word: str, lexicon: Lexicon, *, last: bool = False) -> bool:
    if word not in lexicon:
        return word.isalpha() and MIN_LETTERS <= len(word) <= MAX_LETTERS
    kinds = ("N", "NS") if last else ("N", "MS", "K")
    return any(word in lexicon.names.get(kind, ()) for kind in kinds)


def new_words(entries: Iterable[Entry]) -> tuple[NewWord, ...]:
    """The new words that a reading rests on, each once."""
    words = (
        NewWord(entry.name, entry.role, entry.says)
        for entry in entries
        if entry.role and entry.role != "person"
    )
    return tuple(dict.fromkeys(words))


def _bare_forms(word: str, inflection: Inflection) -> Iterator[str]:
    yield word
    for form in ("ing", "third", "participle"):
        origins = inflection.origins(word, form)
        if origins:
            yield origins[0]
