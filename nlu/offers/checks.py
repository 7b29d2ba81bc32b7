# SPDX-License-Identifier: Apache-2.0
"""Checks on offers: a meaning may be offered only if it loses nothing that was said.

People say yes to what looks right. So a negation, a condition, an exception, a degree, a doer, a
source or a time that the words show and the meaning does not rules the meaning out, as does half a
sentence. The words for the checks are data (`offers.yaml`).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import pairwise
from pathlib import Path

from ...ontology.yaml_reader import read_yaml
from ..grammar.patterns import spellings
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

Phrase = tuple[str, ...]

_WORD_LISTS = (
    *("negative", "implied_negation", "weak_negation", "condition", "exception"),
    *("before_part", "unfinished", "doubtful", "doer", "source", "tense", "weak"),
)
_UNLIKELY = 0.5  # a rule whose upper bound is below states that something is not so


@dataclass(frozen=True)
class Checks:
    """What an offer must keep of an utterance.

    Attributes:
        phrases: the words of each check, by the names of `offers.yaml`.
    """

    phrases: Mapping[str, frozenset[Phrase]]

    def allows(self, meaning: Meaning, mentions: Mentions) -> bool:
        """Whether a meaning loses nothing of an utterance that names this."""
        words = mentions.tokens.words
        return not self.is_incomplete(words) and (
            self._keeps_sign(meaning, words)
            and self._keeps_degree(meaning, mentions)
            and self._keeps_condition(meaning, mentions)
            and self._keeps_grip(meaning, mentions)
            and self._is_licensed(meaning, mentions)
            and (not mentions.tokens.asks or isinstance(meaning, (Question, Command, ToolCommand)))
        )

    def is_incomplete(self, words: Sequence[str]) -> bool:
        """Whether an utterance is half a sentence, or has a word twice in a row."""
        doubled = any(one == other for one, other in pairwise(words))
        return doubled or not words or (words[-1],) in self.phrases["unfinished"]

    def _keeps_sign(self, meaning: Meaning, words: Sequence[str]) -> bool:
        if self._has("implied_negation", words) or self._has("weak_negation", words):
            return False
        count = self._count("negative", words)
        return count == 0 if not _is_negative(meaning) else count == 1

    def _keeps_degree(self, meaning: Meaning, mentions: Mentions) -> bool:
        said = {interval for _, _, interval in mentions.degrees}
        if not said:
            return True
        if len(said) > 1 or not isinstance(meaning, Statement):
            return False
        return all(rule.confidence in said for rule in meaning.rules)

    def _keeps_condition(self, meaning: Meaning, mentions: Mentions) -> bool:
        words = mentions.tokens.words
        if self._has("exception", words) or self._has("doubtful", words):
            return False
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
        places = [each for each in mentions.names if each.role == "part" and each.name in parts]
        return all(
            self._has("before_part", words[max(0, each.start - 3) : each.start])
            or (held and not each.is_new)
            for each in places
        )

    def _is_licensed(self, meaning: Meaning, mentions: Mentions) -> bool:
        """Whether nobody else does it or says so, and it is said to be so now and always."""
        words = mentions.tokens.words
        if not isinstance(meaning, Statement):
            return True
        return not any(self._has(kind, words) for kind in ("doer", "source", "tense", "weak"))

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
    return rule.revises or rule.confidence[1] < _UNLIKELY


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
