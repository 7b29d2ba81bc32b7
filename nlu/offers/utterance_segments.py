"""Segments: spans of an utterance that may be all that it means, by what stands around them.

"Old trick of my trade: you cut with a knife" is understood after its colon. What precedes a segment
tells it, says nothing of it, or makes it a report, a pretence or a condition; the pieces of
periphery and the pause before the segment show which. A person confirms what is offered, so more
may precede it than what is understood at once.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from ..grammar.word_patterns import WordLists
from ..lexicon.tokenizer import BREAK, Tokens
from ..parsing.periphery import HEARER, MARKER, OWN, PHRASE, Pause, PeripheryReader, UtterancePiece
from .mentions import Mentions, Span

LEAST_WORDS = 3  # the least length of a segment [words]

_UNCLEAR = frozenset({Pause.INSIDE, Pause.WEAK, Pause.ASKING})
"""The pauses before a segment that may go on with its sentence."""

_PERSONS = frozenset({OWN, HEARER})


@dataclass(frozen=True)
class SegmentReader:
    """Finds the segments of utterances that may be all that is meant, by the words for offers."""

    periphery: PeripheryReader
    words: WordLists

    def found(self, mentions: Mentions) -> Iterator[Span]:
        """Yield the segments beside which nothing else is meant, the longest first."""
        tokens = self.periphery.reader.known.builder.expand_endings(mentions.tokens)
        for span in self._spans(tokens):
            before, after, pause = self.periphery.around(tokens, span)
            is_told = self._tells(before, tokens, pause)
            is_clear = pause not in _UNCLEAR or not mentions.names_something((0, span[0]))
            if is_told and is_clear and self._adds_nothing(after, mentions, span[1]):
                yield span

    def _spans(self, tokens: Tokens) -> Iterator[Span]:
        words, count, has = tokens.words, len(tokens.items), self.words.has
        opened = {n + 1 for n in tokens.edges - {0} if has("opening", *words[n : n + 1])}
        opened |= {n for n in range(1, count) if has("complement", words[n - 1])}
        found = ((start, end) for start in tokens.edges | opened for end in tokens.edges)
        kept = (s for s in found if s[1] - s[0] >= LEAST_WORDS and s != (0, count))
        yield from sorted(kept, key=lambda span: (span[0] - span[1], span))

    def _tells(self, before: Sequence[UtterancePiece], tokens: Tokens, pause: Pause) -> bool:
        pieces = [each for each in before if each.form != MARKER]
        if not pieces:
            return pause != Pause.INSIDE or not before
        last, table = pieces[-1], self.periphery.table.signs
        words = tokens.words[last.start + last.lead : last.end]
        signs = last.signs | {k for k in ("condition", "exception") if self.words.end(k, words)}
        is_own = last.form in _PERSONS or not signs.isdisjoint({"announced", "agent=speaker"})
        if pause in _UNCLEAR and self.words.end("concession", words):
            return True
        doubting = table["before_colon"] | {"degree"}
        if pause in _UNCLEAR and not all(each.signs.isdisjoint(doubting) for each in pieces):
            return False
        if "announced" in signs or self.words.has("at_end", *words[-1:]):
            signs -= table["outweighed"]
        if last.form == PHRASE and pause not in {Pause.BUT, Pause.SO} and "restricting" in signs:
            return False
        if pause != Pause.BUT and not is_own and (pause == Pause.INSIDE or "report" in signs):
            return False
        return signs.isdisjoint(table[f"before_{pause.name.lower()}"])

    def _adds_nothing(self, after: Sequence[UtterancePiece], mentions: Mentions, end: int) -> bool:
        words = mentions.tokens.words[end:]
        is_announced = all("announced" in each.signs for each in after)
        if self.words.end("joining", words) and not is_announced:
            return False
        meant = self.periphery.table.signs["after_segment"]
        return not mentions.names_something((end, len(mentions.tokens.items))) and all(
            each.form == MARKER or each.signs.isdisjoint(meant) for each in after
        )


def parts(tokens: Tokens) -> Iterator[Span]:
    """Yield the spans from one pause or break to the next that have words."""
    places = pairwise((*tokens.beginnings, len(tokens.items)))
    return ((one, two) for one, two in places if set(tokens.words[one:two]) - {BREAK})
