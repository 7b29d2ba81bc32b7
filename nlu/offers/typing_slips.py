"""Typing slips: the utterances meant by one with misspelled words, "pas me teh mug".

Every unknown word that is one slip away from known ones is replaced by one of them: two letters
swapped, one lost, added or changed. What this gives is only offered, never believed or done.
"""

from collections.abc import Iterator
from itertools import product
from math import dist

from ..lexicon.misspelling import slips
from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import MAX_NEW_WORDS, KnownWords

MAX_WORDS = 4  # how many known words are tried for an unknown one
MAX_TEXTS = 12  # how many corrected utterances are tried

_KEYS = {
    letter: (row, column)
    for row, letters in enumerate(("qwertyuiop", "asdfghjkl", "zxcvbnm"))
    for column, letter in enumerate(letters)
}
_ELSEWHERE = (9, 9)  # the place of what is no letter of these
_NEXT = 1.5  # neighbours are less apart, also diagonal ones


def corrected_texts(tokens: Tokens, known: KnownWords) -> Iterator[str]:
    """Yield the utterance with the words corrected that are near known ones, likeliest first."""
    words, text = dict.fromkeys(token.word for token in known.unknown(tokens)), tokens.text
    if not words or len(words) > MAX_NEW_WORDS or not all(map(str.isalpha, words)):
        return
    options = [_known_slips(word, known) or [word] for word in words]
    numbered = product(*(list(enumerate(each)) for each in options))
    ranked = sorted(numbered, key=lambda chosen: sum(number for number, _ in chosen))
    for chosen in ranked[:MAX_TEXTS]:
        meant = dict(zip(words, (word for _, word in chosen), strict=True))
        if any(word != other for word, other in meant.items()):
            yield _replaced(tokens, text, meant)


def is_misspelled(tokens: Tokens, known: KnownWords) -> bool:
    """Whether an utterance has several unknown words, which are all near known ones."""
    words = {token.word for token in known.unknown(tokens)}
    return len(words) > 1 and all(_known_slips(word, known) for word in words)


def _known_slips(word: str, known: KnownWords) -> list[str]:
    found = dict.fromkeys(other for other in slips(word) if len(other) > 1 and known.has(other))
    return sorted(found, key=lambda other: _is_far(word, other))[:MAX_WORDS]


def _is_far(word: str, other: str) -> bool:
    if len(word) != len(other) or sorted(word) == sorted(other):
        return False
    changed = (pair for pair in zip(word, other, strict=True) if pair[0] != pair[1])
    return any(dist(_KEYS.get(one, _ELSEWHERE), _KEYS[two]) > _NEXT for one, two in changed)


def _replaced(tokens: Tokens, text: str, meant: dict[str, str]) -> str:
    for token in reversed(tokens.items):
        if token.word in meant:
            text = text[: token.start] + meant[token.word] + text[token.end :]
    return text
