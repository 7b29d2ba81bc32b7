# SPDX-License-Identifier: Apache-2.0
"""Sentences as a bad recogniser hands them on: words misheard, dropped, or swapped."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from random import Random

Words = list[str]


def garbled(text: str, how: str, rate: float, rng: Random, vocabulary: Sequence[str]) -> str:
    """A sentence with errors.

    Args:
        text: as it was said.
        how: "misheard", "dropped" or "swapped".
        rate: the share of words that it happens to, in [0, 1].
        rng: where chance comes from.
        vocabulary: the words that others are taken for.
    """
    return " ".join(_GARBLINGS[how](text.split(), rate, rng, vocabulary))


def _misheard(words: Words, rate: float, rng: Random, vocabulary: Sequence[str]) -> Words:
    """Words of the same domain in place of some, as a recogniser that knows it would hear."""
    return [rng.choice(vocabulary) if rng.random() < rate else word for word in words]


def _dropped(words: Words, rate: float, rng: Random, _: Sequence[str]) -> Words:
    return [word for word in words if rng.random() >= rate]


def _swapped(words: Words, rate: float, rng: Random, _: Sequence[str]) -> Words:
    """Some words exchanged with the one after."""
    swapped = list(words)
    for i in range(len(swapped) - 1):
        if rng.random() < rate:
            swapped[i], swapped[i + 1] = swapped[i + 1], swapped[i]
    return swapped


_GARBLINGS: Mapping[str, Callable[[Words, float, Random, Sequence[str]], Words]] = {
    "misheard": _misheard,
    "dropped": _dropped,
    "swapped": _swapped,
}
