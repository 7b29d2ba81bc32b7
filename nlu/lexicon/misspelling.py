"""Misspellings: the known word that a new one is a likely slip of.

A slip swaps two letters, loses one, adds one or changes one (Damerau 1964). All words that are one
slip away are made and looked up, so the number of known words does not matter. Most words that are
one letter away from another are words of their own: a pin and a pan, lighting and lightning. So it
takes more for a slip than that: letters in an order that no known word has, or a long word.
"""

import re
from collections.abc import Callable, Collection, Iterator
from itertools import chain, product
from string import ascii_lowercase

MIN_LETTERS = 4  # words shorter than this are too close to too many others
LONG = 8  # from this length on [letters] hardly any two words are one letter apart, endings aside

_SWAPPED_OR_DOUBLED = 6  # the same where letters are only swapped or doubled
_HARDLY_DOUBLED_AT_THE_END = "bdgmnprt"
_VOWELS = "aeiouy"
_CLUSTER = re.compile(f"[{_VOWELS}]+|[^{_VOWELS}]+")
_SUFFIXES = ("ing", "ed")

IsWord = Callable[[str], bool]


def letter_clusters(word: str) -> list[str]:
    """The sequences of consonants and of vowels in a word, with `^` before and `$` after it."""
    return _CLUSTER.findall(f"^{word}$")


def intended_word(word: str, is_known: IsWord, spelled: Collection[str]) -> str | None:
    """The known word that `word` is a likely slip of, None where there is none.

    `is_known` tells if a word could be meant; `spelled` are the letter clusters of known words.
    """
    if len(word) < MIN_LETTERS:
        return None
    is_odd = not all(each in spelled for each in letter_clusters(word))
    likely = (slips(word) if is_odd else _slips_of_words(word)) if word.isalpha() else ()
    return next(filter(is_known, likely), None)


def slips(word: str) -> Iterator[str]:
    """The words that one slip turns into `word`, the likeliest slips first."""
    return chain(_swapped(word), _doubled(word), _edited(word))


def _slips_of_words(word: str) -> Iterator[str]:
    letters = len(next((word.removesuffix(end) for end in _SUFFIXES if word.endswith(end)), word))
    if word[-1] == word[-2] and word[-1] in _HARDLY_DOUBLED_AT_THE_END:
        yield word[:-1]
    if letters >= _SWAPPED_OR_DOUBLED:
        yield from _swapped(word)
    if letters >= LONG:
        yield from (other for other in _edited(word) if not _is_derived(word, other))
    elif len(word) > MIN_LETTERS and letters == len(word):
        # "Hamer" is a slip of "hammer", but "taping" is of "tape" and "tapping" of "tap".
        yield from _doubled(word)


def _swapped(word: str) -> Iterator[str]:
    return (word[:n] + word[n + 1] + word[n] + word[n + 2 :] for n in range(len(word) - 1))


def _doubled(word: str) -> Iterator[str]:
    for place in range(1, len(word)):
        if word[place] in _VOWELS:
            continue
        if word[place] == word[place - 1]:
            yield word[:place] + word[place + 1 :]
        if place < len(word) - 1:
            yield word[:place] + word[place] + word[place:]


def _edited(word: str) -> Iterator[str]:
    inner, ends = range(1, len(word)), range(1, len(word) + 1)
    yield from (word[:n] + letter + word[n:] for n, letter in product(ends, ascii_lowercase))
    yield from (word[:n] + word[n + 1 :] for n in inner)
    places = product(inner, ascii_lowercase)
    yield from (word[:n] + letter + word[n + 1 :] for n, letter in places if letter != word[n])


def _is_derived(word: str, other: str) -> bool:
    shared = min(len(word), len(other)) - (len(word) == len(other))
    return word[:shared] == other[:shared]
