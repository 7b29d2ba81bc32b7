# SPDX-License-Identifier: Apache-2.0
"""What is said by the way: words that add nothing, tags, and words of confidence out of place.

"Knives are, you know, really for cutting, aren't they?" is "knives are for cutting?". Only phrases
that the language data lists as asides are ever set aside, and only when the utterance is no whole
with them; so a word that nobody has declared to be empty is never lost.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator
from dataclasses import dataclass, replace

from ..ontology.source import Field
from .tokens import BREAK, Token, Tokens

Phrase = tuple[str, ...]


@dataclass(frozen=True)
class Asides:
    """The phrases that may be set aside.

    Attributes:
        anywhere: they add nothing wherever they stand.
        apart: they add nothing when a pause, or the end, is on both sides of them.
        asking: at the end, with a question mark, they make a question of what goes before.
        telling: at the end, with a question mark, they ask for nothing.
    """

    anywhere: frozenset[Phrase] = frozenset()
    apart: frozenset[Phrase] = frozenset()
    asking: frozenset[Phrase] = frozenset()
    telling: frozenset[Phrase] = frozenset()

    def with_phrases(self, kind: str, phrases: Iterable[Phrase], field: Field) -> Asides:
        """These asides, and further ones of a kind.

        Raises:
            DataError: there is no such kind.
        """
        known: dict[str, frozenset[Phrase]] = {
            "anywhere": self.anywhere,
            "apart": self.apart,
            "asking": self.asking,
            "telling": self.telling,
        }
        if kind not in known:
            raise field.fail(f'expected one of {", ".join(known)}, found "{kind}".')
        known[kind] |= set(phrases)
        return Asides(**known)

    def untagged(self, tokens: Tokens) -> Tokens:
        """The utterance without the tag at its end: "..., isn't it?", "..., okay?"."""
        if not tokens.asks:
            return tokens
        for place in sorted({*tokens.pauses, *_after_breaks(tokens)} - {0}):
            tag = tokens.words[place:]
            if tag in self.asking or tag in self.telling:
                rest = tokens.part(0, place)
                return replace(rest, asks=tag in self.asking, pauses=_below(tokens, place))
        return tokens

    def removed(self, tokens: Tokens) -> Tokens:
        """The utterance without all that adds nothing."""
        words = tokens.words
        edges = {0, len(words), *tokens.pauses, *_after_breaks(tokens)}
        edges |= {place for place, word in enumerate(words) if word == BREAK}
        kept: list[tuple[int, Token]] = []
        place = 0
        while place < len(words):
            end = self._end(words, place, edges)
            if end == place:
                kept.append((place, tokens.items[place]))
                end += 1
            place = end
        return _only(tokens, kept)

    def _end(self, words: Phrase, start: int, edges: Collection[int]) -> int:
        """One past the longest aside from a place on; the place itself where there is none."""
        for end in range(min(len(words), start + _LONGEST), start, -1):
            phrase = words[start:end]
            if phrase in self.anywhere:
                return end
            if start in edges and end in edges and phrase in self.apart:
                return end
        return start


_LONGEST = 8
"""No aside is longer [words]."""


def fronted(tokens: Tokens, phrases: Collection[Phrase]) -> Tokens | None:
    """The utterance with its one phrase of a kind at its beginning; None when it is there already.

    English lets an adverb stand almost anywhere: "a shoe you can sometimes pound with".
    """
    words = tokens.words
    found = [
        (start, start + length)
        for length in sorted({len(phrase) for phrase in phrases}, reverse=True)
        for start in range(len(words) - length + 1)
        if words[start : start + length] in phrases
    ]
    if not found or found[0][0] == 0:
        return None
    start, end = found[0]
    if any(later[0] >= end or later[1] <= start for later in found[1:]):
        return None
    items = tokens.items
    return Tokens(tokens.text, (*items[start:end], *items[:start], *items[end:]), tokens.asks)


def _only(tokens: Tokens, kept: list[tuple[int, Token]]) -> Tokens:
    pauses = {
        next((new for new, (old, _) in enumerate(kept) if old >= pause), len(kept))
        for pause in tokens.pauses
    }
    items = tuple(token for _, token in kept)
    return Tokens(tokens.text, items, tokens.asks, tuple(sorted(pauses - {len(kept)})))


def _below(tokens: Tokens, end: int) -> tuple[int, ...]:
    return tuple(pause for pause in tokens.pauses if pause < end)


def _after_breaks(tokens: Tokens) -> Iterator[int]:
    return (place + 1 for place, token in enumerate(tokens.items) if token.word == BREAK)
