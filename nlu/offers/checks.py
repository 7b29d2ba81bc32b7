# SPDX-License-Identifier: Apache-2.0
"""Checks on offers: a meaning may be offered only if it loses nothing that was said.

People say yes to what looks right. So a negation, a condition, an exception, a degree, a doer, a
source or a time that the words show and the meaning does not rules the meaning out, as does half a
sentence. Doers, sources, times and modality are features, on which the licence decides; the words
for the other checks are data (`offers.yaml`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from ..grammar.word_patterns import spellings
from ..lexicon.tokenizer import BREAK
from ..lexicon.vocabulary import NewWord
from ..parsing.clause_features import features_of_names
from ..semantics.features import CONDITION, MAIN, ClauseWord, FeatureReader, UtteranceFeatures
from ..semantics.licence_table import ACCEPT, Licence
from ..semantics.meaning import (
    ActionRule,
    Command,
    Meaning,
    Question,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
)
from .mentions import Mentions
from .utterance_segments import Span, rest_of

Phrase = tuple[str, ...]

_WORD_LISTS = (
    *("negative", "implied_negation", "weak_negation", "condition", "exception"),
    *("by", "before_part", "unfinished", "doubtful"),
)
OPERATORS = ("negative", "implied_negation", "weak_negation", "condition", "exception", "doubtful")
"""The lists of words on which a meaning may depend."""

_DOMAIN = frozenset({"object", "part", "affordance", "act"})
_UNLIKELY = 0.5  # a rule whose upper bound is below states that something is not so


@dataclass(frozen=True)
class OfferChecks:
    """What an offer must keep of an utterance.

    Attributes:
        phrases: the words of each check, by the names of `offers.yaml`.
    """

    phrases: Mapping[str, frozenset[Phrase]]
    reader: FeatureReader
    licence: Licence

    def checked(self, meaning: Meaning, mentions: Mentions) -> Meaning | None:
        """Return a meaning as sure as the utterance says it, None if it would lose something."""
        words = mentions.tokens.words
        keeps_all = (
            self._is_complete(meaning, mentions)
            and self._keeps_sign(meaning, words)
            and self._keeps_degree(meaning, mentions)
            and self._keeps_condition(meaning, mentions)
            and self._keeps_grip(meaning, mentions)
            and (not mentions.tokens.asks or isinstance(meaning, (Question, Command, ToolCommand)))
        )
        if not keeps_all:
            return None
        features = self.clause_features(mentions)
        if isinstance(meaning, (Command, ToolCommand)) and "tense" in features.main:
            return None
        named = features_of_names(self.reader, words, meaning, tuple(_new_words(mentions)))
        features = replace(features, main={**features.main, **dict(named)})
        if self.licence.outcome(meaning, features) != ACCEPT:
            return None
        return self.licence.weakened(meaning, features)

    def around(self, span: Span, mentions: Mentions, told: Mapping[int, bool]) -> Sequence[Phrase]:
        """Return the words around a span on which its meaning may depend.

        Those of a preamble that tells the span, by the places of such spans, are left out.
        """
        start, end = span
        return rest_of(mentions.tokens, (0 if told.get(start) else start, end))

    def adds_nothing(self, span: Span, mentions: Mentions, told: Mapping[int, bool]) -> bool:
        """Whether what stands around a span names nothing and has no word that changes it.

        What stands before may name something when it is set off by a strong pause, and may have
        such a word when it tells the span.
        """
        start, end = span
        named = [(m.start, m.end) for m in mentions.names if not m.is_new and m.role in _DOMAIN]
        named += [(first, last) for first, last, _ in mentions.degrees]
        if start in told:
            named = [each for each in named if each[0] >= start]
        is_told = told.get(start, True)
        kept = is_told and all(start <= first and last <= end for first, last in named)
        return kept and not any(
            self._has(kind, words)
            for words in self.around(span, mentions, told)
            for kind in OPERATORS
        )

    def is_licensed_beside(self, meaning: Meaning, around: Sequence[Phrase]) -> bool:
        """Whether a meaning stays what it is beside some words that are said by the way."""
        if not isinstance(meaning, (Statement, Command, ToolCommand, Question)):
            return False
        aside = self.reader.features((), around)
        return self.licence.outcome(meaning, aside) == ACCEPT

    def clause_features(self, mentions: Mentions) -> UtteranceFeatures:
        """The features of the clauses of an utterance that names this."""
        return self.reader.features(tuple(self._clauses(mentions)), ())

    def signs(self, mentions: Mentions) -> frozenset[str]:
        """What the words of an utterance say of doer, time, source and sign."""
        words, features = mentions.tokens.words, self.clause_features(mentions)
        found = {kind for kind in self.phrases if self._has(kind, words)}
        for clause in (MAIN, CONDITION):
            for feature, values in features.of(clause).items():
                found |= {f"{clause} {feature}={value}" for value in values}
        return frozenset(found | ({"cut"} if words[-1:] in self.phrases["unfinished"] else set()))

    def _is_complete(self, meaning: Meaning, mentions: Mentions) -> bool:
        """Whether an utterance is no half sentence and has no word twice in a row."""
        words, pauses = mentions.tokens.words, mentions.tokens.pauses
        is_cut = not isinstance(meaning, Question) and (words[-1],) in self.phrases["unfinished"]
        doubled = (n for n, (one, two) in enumerate(pairwise(words), start=1) if one == two)
        return not is_cut and all(place in pauses for place in doubled)

    def _keeps_sign(self, meaning: Meaning, words: Sequence[str]) -> bool:
        if self._has("implied_negation", words) or self._has("weak_negation", words):
            return False
        count = self._count("negative", words)
        if _is_negative(meaning):
            return count == 1 or (count == 2 and _corrects(meaning))
        return count == 0 or (count == 1 and _corrects(meaning))

    def _keeps_degree(self, meaning: Meaning, mentions: Mentions) -> bool:
        said = {interval for _, _, interval in mentions.degrees}
        if isinstance(meaning, Statement):
            return not said or (
                len(said) == 1 and all(rule.confidence in said for rule in meaning.rules)
            )
        return all(_is_negative(meaning) and upper < _UNLIKELY for _, upper in said)

    def _keeps_condition(self, meaning: Meaning, mentions: Mentions) -> bool:
        words = mentions.tokens.words
        if self._has("exception", words) or self._has("doubtful", words):
            return False
        if isinstance(meaning, (Command, ToolCommand)):
            return not self._has("condition", words)
        names = _acts_and_uses(meaning)
        spoken = [each.start for each in mentions.names if each.name in names]
        return all(
            any(place < other <= place + _REACH for other in spoken)
            for place in self._places("condition", words)
        )

    def _keeps_grip(self, meaning: Meaning, mentions: Mentions) -> bool:
        """Whether a holding rule was said with a word for holding, or for the place of a part."""
        if not isinstance(meaning, Statement):
            return True
        words = mentions.tokens.words
        held = any(each.role == "act" and each.name == "grasp" for each in mentions.names)
        parts = {rule.part for rule in meaning.rules if isinstance(rule, ActionRule)}
        before = [
            (each, words[max(0, each.start - 3) : each.start])
            for each in mentions.names
            if each.role == "part" and each.name in parts
        ]
        return all(
            (held or self._has("by", said)) and (not each.is_new or self._has("before_part", said))
            for each, said in before
        )

    def _clauses(self, mentions: Mentions) -> Iterator[ClauseWord]:
        """The words with their clauses; one that names something belongs to none."""
        named = {n for m in mentions.names if m.role != "act" for n in range(m.start, m.end)}
        clause = MAIN
        for place, word in enumerate(mentions.tokens.words):
            if place in mentions.tokens.pauses or word == BREAK:
                clause = MAIN
            if (word,) in self.phrases["condition"]:
                clause = CONDITION
            yield ClauseWord(word, "" if place in named else clause)

    def _has(self, kind: str, words: Sequence[str]) -> bool:
        return self._count(kind, words) > 0

    def _count(self, kind: str, words: Sequence[str]) -> int:
        return len(list(self._places(kind, words)))

    def _places(self, kind: str, words: Sequence[str]) -> Iterator[int]:
        for phrase in self.phrases[kind]:
            length = len(phrase)
            for place in range(len(words) - length + 1):
                if tuple(words[place : place + length]) == phrase:
                    yield place


_REACH = 9
"""How far behind a word like "when" its act or use may stand [words]."""


@lru_cache(maxsize=4)
def load_check_words(path: Path) -> Mapping[str, frozenset[Phrase]]:
    """Return the words of each check; `DataError` says where the file is not as expected."""
    parts = read_yaml(path).entries(required=("checks", "choices"), optional=())["checks"]
    lists = parts.entries(required=_WORD_LISTS, optional=())
    return {
        kind: frozenset(words for item in field.items() for words in spellings(item))
        for kind, field in lists.items()
    }


def _new_words(mentions: Mentions) -> Iterator[NewWord]:
    for each in mentions.names:
        if each.is_new and each.role != "act":
            said = " ".join(mentions.tokens.words[each.start : each.end])
            yield NewWord(each.name, each.role, said)


def _is_negative(meaning: Meaning) -> bool:
    match meaning:
        case Statement(rules):
            return any(map(_denies, rules))
        case Retraction(rule):
            return rule is not None and _denies(rule)
        case Command() | ToolCommand():
            target = meaning.target if isinstance(meaning, Command) else meaning.tool
            return meaning.negated or target.not_used_for is not None
        case Question():
            return meaning.ask == "why_not"
        case _:
            return False


def _denies(rule: Rule) -> bool:
    return rule.confidence[1] < _UNLIKELY


def _corrects(meaning: Meaning) -> bool:
    return isinstance(meaning, Statement) and all(rule.revises for rule in meaning.rules)


def _acts_and_uses(meaning: Meaning) -> frozenset[str]:
    match meaning:
        case Statement(rules):
            named = (r.context if isinstance(r, ActionRule) else r.affordance for r in rules)
            return frozenset(named)
        case Command(target=target):
            return frozenset(filter(None, (meaning.goal, target.used_for, target.not_used_for)))
        case ToolCommand():
            return frozenset({meaning.goal, meaning.tool.used_for or meaning.goal})
        case Question():
            return frozenset(filter(None, (meaning.affordance, meaning.context)))
        case _:
            return frozenset()
