# SPDX-License-Identifier: Apache-2.0
"""Introductions: clauses before the last one of an utterance that say nothing of it.

"I never said it before, but I say it now: a knife is used for cutting" is its last clause, which
the grammar understands. What comes before may have a doer, a time, a negation and a degree of its
own. It may be no condition, report or denial, on which the last clause would depend.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

from ..lexicon.tokenizer import BREAK
from ..semantics.clause_features import ASIDE, UtteranceFeatures
from ..semantics.licence_table import ACCEPT
from ..semantics.meaning import Meaning, Statement
from .checks import OfferChecks, Phrase
from .mentions import LEAST_ASIDE, Mentions

_DEPENDED_ON = ("implied_negation", "condition", "exception", "doubtful")

_OWN = frozenset({"agent", "tense", "modality"})
"""The features that a clause has for itself."""

_UNSURE = frozenset({"think", "hedged"})


@dataclass(frozen=True)
class IntroductionChecks:
    """Tells introductions from what a last clause depends on."""

    checks: OfferChecks

    def introduces(self, start: int, mentions: Mentions) -> bool:
        """Whether the words before the clause that begins at a place may say nothing of it."""
        words = mentions.tokens.words[:start]
        begins = mentions.tokens.words[start : start + 1]
        is_set_off = start > 0 and self._is_set_off(start, mentions)
        if len(words) < LEAST_ASIDE or not self._has_doer(words, is_set_off=is_set_off):
            return False
        if begins in self.checks.phrases["joining"]:
            return False
        if any(place < start for k in _DEPENDED_ON for place in self.checks.spoken(k, mentions)):
            return False
        if not all(
            self._has_doer(piece, is_set_off=is_set_off)
            for piece in self._with_degree(start, mentions)
        ):
            return False
        names = any(each.end <= start for each in mentions.known)
        return (not names or is_set_off) and all(
            self._stands_alone(words[slice(*piece)], is_set_off=is_set_off)
            for piece in self.checks.denying_pieces(mentions)
            if piece[1] <= start
        )

    def allows(self, meaning: Meaning, start: int, mentions: Mentions) -> bool:
        """Whether the features of an introduction let the clause after it have a meaning."""
        if mentions.tokens.asks and isinstance(meaning, Statement):
            return False
        reader, words = self.checks.reader, mentions.tokens.words[:start]
        last = reader.features((), [self._last_clause(words)]).of(ASIDE)
        found = {
            **reader.features((), [words]).of(ASIDE),
            "source": last.get("source", frozenset()),
        }
        if not _UNSURE.isdisjoint(found.get("attitude", ())):
            return False
        bearing = {name: values for name, values in found.items() if values and name not in _OWN}
        features = replace(UtteranceFeatures(), aside=bearing)
        return self.checks.licence.outcome(meaning, features) == ACCEPT

    def _with_degree(self, start: int, mentions: Mentions) -> Iterator[Phrase]:
        """Yield the words of the pieces before a clause that have a degree."""
        places = {first for first, _, _ in mentions.degrees if first < start}
        for piece in mentions.pieces:
            if not places.isdisjoint(range(*piece)):
                yield mentions.tokens.words[slice(*piece)]

    def _last_clause(self, words: Phrase) -> Phrase:
        """The words after the last one that joins clauses, if they have a doer; else all."""
        phrases = self.checks.phrases
        joins = [
            n for n, word in enumerate(words) if (word,) in phrases["joining"] | phrases["turning"]
        ]
        last = words[joins[-1] :] if joins else words
        return last if self._has_doer(last) else words

    def _is_set_off(self, start: int, mentions: Mentions) -> bool:
        """Whether a clause is set off from what is named before: "..., so", "...:"."""
        tokens = mentions.tokens
        between = tokens.text[tokens.items[start - 1].end : tokens.items[start].start]
        is_break = BREAK in tokens.words[start - 1 : start + 1]
        return (
            is_break or ":" in between or (tokens.words[start],) in self.checks.phrases["turning"]
        )

    def _stands_alone(self, words: Phrase, *, is_set_off: bool) -> bool:
        """Whether a clause that denies something denies nothing of what is said after it."""
        has_doer = self._has_doer(words, is_set_off=is_set_off)
        return has_doer and self.checks.reader.embedding.isdisjoint(words)

    def _has_doer(self, words: Phrase, *, is_set_off: bool = False) -> bool:
        """Whether a clause has a doer; what is set off from it may be of somebody else."""
        phrases = self.checks.phrases
        kinds = phrases["doer"] | phrases["other_doer"] if is_set_off else phrases["doer"]
        return any(words[n : n + len(each)] == each for each in kinds for n in range(len(words)))
