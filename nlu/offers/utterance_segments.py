"""Segments: spans of an utterance that may be all that it means, by what stands around them.

"Old trick of my trade: you cut with a knife" is understood after its colon. What precedes a segment
tells it, says nothing of it, or makes it a report, a pretence or a condition; the pieces of
periphery and the pause before the segment show which. A person confirms what is offered, so more
may precede it than what is understood at once.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..lexicon.tokenizer import BREAK, Tokens
from ..parsing.periphery import PeripheryReader
from ..parsing.utterance_pieces import (
    ASKING,
    BUT,
    COLON,
    HEARER,
    INSIDE,
    MARKER,
    OWN,
    PHRASE,
    SO,
    STRONG,
    TOLD,
    WEAK,
    UtterancePiece,
)
from .mentions import Mentions

LEAST_WORDS = 3
"""The least length of a segment [words]."""

Span = tuple[int, int]

_QUOTED = frozenset({"quoted"})
_PRETENDED = _QUOTED | {"unreal", "attitude=hypothetical"}
_REPORTED = _PRETENDED | {"source=hearsay", "source=other", "belief=denied"}
_DOUBTED = _REPORTED | {"doubtful", "attitude=doubt", "implied_negation"}
_LIMITED = _DOUBTED | {
    *("attitude=perhaps", "restricting", "circumstance", "called", "degree", "condition=absent"),
    *("act", "held", "condition", "exception"),
}
_BLOCKING: Mapping[int, frozenset[str]] = {
    BUT: _QUOTED,
    SO: _PRETENDED,
    STRONG: _REPORTED,
    COLON: _DOUBTED,
    TOLD: _DOUBTED,
    ASKING: _LIMITED,
    WEAK: _LIMITED,
    INSIDE: _LIMITED | {"modality=weak", "polarity=negative"},
}
"""The operators by which the piece before a segment, so set off, changes what it means."""

_CHANGING = frozenset(
    {"restricting", "negative", "weak_negation", "condition", "exception", "report"}
)
"""By these what follows it does."""

_OUTWEIGHED = frozenset(
    {"source=other", "implied_negation", "doubtful", "condition", "modality=weak"}
)
"""What speakers say themselves in spite of these."""

_UNCLEAR = frozenset({INSIDE, WEAK, ASKING})
"""The pauses before a segment that may go on with its sentence."""

_PERSONS = frozenset({OWN, HEARER})


@dataclass(frozen=True)
class SegmentReader:
    """Finds the segments of utterances that may be all that is meant.

    Attributes:
        periphery: types what stands around a segment.
        expanded: returns tokens with their short forms written out, word by word.
        phrases: the words of each check on offers.
    """

    periphery: PeripheryReader
    expanded: Callable[[Tokens], Tokens]
    phrases: Mapping[str, frozenset[tuple[str, ...]]]

    def found(self, mentions: Mentions) -> Iterator[Span]:
        """Yield the segments beside which nothing else is meant, the longest first."""
        tokens = self.expanded(mentions.tokens)
        for span in self._spans(tokens):
            before, after, pause = self.periphery.around(tokens, span)
            is_told = self._tells(before, tokens, pause)
            is_clear = pause not in _UNCLEAR or not mentions.names_something((0, span[0]))
            if is_told and is_clear and self._adds_nothing(after, mentions, span[1]):
                yield span

    def _spans(self, tokens: Tokens) -> Iterator[Span]:
        """Yield the spans from pause to pause, or from behind a joining word, the longest first."""
        words, count = tokens.words, len(tokens.items)
        ends = {count, *tokens.pauses, *_breaks(tokens)}
        opened = {n + 1 for n in ends - {count} if words[n : n + 1] in self.phrases["opening"]}
        opened |= {n for n in range(1, count) if words[n - 1 : n] in self.phrases["complement"]}
        found = ((start, end) for start in {0} | ends | opened for end in ends)
        kept = (s for s in found if s[1] - s[0] >= LEAST_WORDS and s != (0, count))
        yield from sorted(kept, key=lambda span: (span[0] - span[1], span))

    def _tells(self, before: Sequence[UtterancePiece], tokens: Tokens, pause: int) -> bool:
        """Whether what precedes a segment tells it or says nothing of it."""
        pieces = [each for each in before if each.form != MARKER]
        if not pieces:
            return pause != INSIDE or not before
        last = pieces[-1]
        words = tokens.words[last.start + last.lead : last.end]
        signs = last.signs | {k for k in ("condition", "exception") if self._begins(k, words)}
        is_own = last.form in _PERSONS or not signs.isdisjoint({"announced", "agent=speaker"})
        if pause in _UNCLEAR and self._begins("concession", words):
            return True
        if pause in _UNCLEAR and not all(e.signs.isdisjoint(_DOUBTED | {"degree"}) for e in pieces):
            return False
        if "announced" in signs or words[-1:] in self.phrases["at_end"]:
            signs -= _OUTWEIGHED
        if last.form == PHRASE and pause not in {BUT, SO} and "restricting" in signs:
            return False
        if pause != BUT and not is_own and (pause == INSIDE or "report" in signs):
            return False
        return signs.isdisjoint(_BLOCKING[pause])

    def _adds_nothing(self, after: Sequence[UtterancePiece], mentions: Mentions, end: int) -> bool:
        """Whether what follows a segment names nothing and has no word that changes it."""
        words = mentions.tokens.words[end:]
        is_announced = all("announced" in each.signs for each in after)
        if self._begins("joining", words) and not is_announced:
            return False
        return not mentions.names_something((end, len(mentions.tokens.items))) and all(
            each.form == MARKER or each.signs.isdisjoint(_DOUBTED | _CHANGING) for each in after
        )

    def _begins(self, kind: str, words: Sequence[str]) -> bool:
        return any(tuple(words[: len(each)]) == each for each in self.phrases[kind])


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
