# SPDX-License-Identifier: Apache-2.0
"""Segments: spans of an utterance that may be all that it means.

"Old trick of my trade: you cut with a knife" is understood after its colon. What stands around a
segment is only said by the way if it names nothing and has no word on which the meaning may depend;
a preamble behind a strong pause may, unless the segment is then somebody else's word or a pretence.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import combinations, pairwise

from ..lexicon.tokenizer import BREAK, Tokens

LEAST_WORDS = 3
"""The least length of a segment [words]."""

Span = tuple[int, int]


def segments(tokens: Tokens, starts: Iterable[int]) -> Iterator[Span]:
    """Yield the spans from pause to pause, or from one of some starts, the longest first."""
    whole = (0, len(tokens.items))
    spans = combinations(sorted({*whole, *starts, *tokens.pauses, *_breaks(tokens)}), 2)
    long_enough = (s for s in spans if s[1] - s[0] >= LEAST_WORDS and s != whole)
    yield from sorted(long_enough, key=lambda span: span[0] - span[1])


def rest_of(tokens: Tokens, span: Span) -> Sequence[tuple[str, ...]]:
    """Return the words before and after a span."""
    return tuple(filter(None, (tokens.words[: span[0]], tokens.words[span[1] :])))


def parts(tokens: Tokens) -> Iterator[Span]:
    """Yield the spans from one pause or break to the next that have words."""
    breaks = (place + 1 for place, word in enumerate(tokens.words) if word == BREAK)
    places = sorted({0, *tokens.pauses, *breaks, len(tokens.items)})
    return ((one, two) for one, two in pairwise(places) if set(tokens.words[one:two]) != {BREAK})


def _breaks(tokens: Tokens) -> Iterator[int]:
    """The places before and after each break."""
    for place, word in enumerate(tokens.words):
        if word == BREAK:
            yield from (place, place + 1)
