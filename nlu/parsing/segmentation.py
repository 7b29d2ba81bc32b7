# SPDX-License-Identifier: Apache-2.0
"""Utterances of several moves, such as "Hello. That hammer, could I have it, please?".

Where an utterance is no whole, it may be a row of wholes, cut at its commas and full stops. Each
must be understood, so that still nothing is left out; and together they must come to one meaning.
What may go before or after another move is little: a reply, the thing that "it" then stands for,
a question whether it is seen, or the same once more.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations

from ..lexicon.tokenizer import BREAK, Tokens
from ..semantics.meaning import (
    Acknowledgement,
    ActionRule,
    Command,
    Meaning,
    Question,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
)
from ..semantics.predicates import Form
from .parser import UtteranceContext
from .understanding import Understanding

MAX_MOVES = 4

_DECISIVE = frozenset({"yes", "no"})  # what a reply says, whatever politeness is around it
_CLOSING = frozenset({"thanks", "okay"})


@dataclass(frozen=True)
class Moves:
    """How moves are understood, one after the other.

    Attributes:
        take: what one of them means in a situation.
        topic: the thing that it only names, None when it does not.
        is_general: whether what it names is any object of a kind.
    """

    take: Callable[[Tokens, UtteranceContext], Understanding]
    topic: Callable[[Tokens, UtteranceContext], Form | None]
    is_general: Callable[[Tokens], bool]

    def in_turn(self, tokens: Tokens, situation: UtteranceContext) -> Understanding | None:
        """An utterance as moves that come to one meaning; None when they do not."""
        for moves in cuts(tokens):
            taken = self._taken(self._in_order(moves, situation), situation)
            main = main_move([move.meaning for move in taken]) if taken else None
            if main is not None and not (_holds(main[1]) and any(map(self.is_general, moves))):
                place, meaning = main
                words = tuple(word for move in taken for word in move.new_words)
                return replace(taken[place], text=tokens.text, meaning=meaning, new_words=words)
        return None

    def _taken(self, moves: Sequence[Tokens], situation: UtteranceContext) -> list[Understanding]:
        """Each move understood after those before it; none when one of them is not."""
        taken: list[Understanding] = []
        topic: Form | None = None
        for move in moves:
            found = self.take(move, situation)
            if found.reading is None:
                if topic is not None:
                    return []
                topic = self.topic(move, situation)
                if topic is None:
                    return []
                situation = _speaking_of(topic, situation)
                continue
            if topic is not None and not self._needs(move, situation):
                return []
            topic = None
            taken.append(found)
            situation = replace(situation, discourse=found.discourse)
        return taken if topic is None else []

    def _in_order(self, moves: Sequence[Tokens], situation: UtteranceContext) -> Sequence[Tokens]:
        """A thing named at the end goes first: "You pass it by the blade, the knife."."""
        if self.topic(moves[-1], situation) is None:
            return moves
        return moves[-1], *moves[:-1]

    def _needs(self, move: Tokens, situation: UtteranceContext) -> bool:
        """Whether a move cannot be understood without what was spoken of."""
        return self.take(move, _speaking_of(None, situation)).reading is None


def _holds(meaning: Meaning) -> bool:
    """Whether it is an act with a part; of any object of a kind, that may be a rule as well."""
    return isinstance(meaning, Command) and meaning.part is not None


def _speaking_of(thing: Form | None, situation: UtteranceContext) -> UtteranceContext:
    return replace(situation, discourse=replace(situation.discourse, object=thing))


def cuts(tokens: Tokens) -> Iterator[tuple[Tokens, ...]]:
    """All ways to cut an utterance into moves, those with fewer moves first."""
    places = sorted({*tokens.pauses, *_after_breaks(tokens)} - {0, len(tokens.items)})
    if len(places) >= MAX_MOVES:
        return
    for count in range(1, len(places) + 1):
        for chosen in combinations(places, count):
            starts, ends = (0, *chosen), (*chosen, len(tokens.items))
            moves = tuple(tokens.part(*ends_of) for ends_of in zip(starts, ends, strict=True))
            if all(move.items for move in moves):
                yield moves


def main_move(meanings: Sequence[Meaning]) -> tuple[int, Meaning] | None:
    """Which move an utterance is about, and what it then means; None when it is about several."""
    replies = [each for each in meanings if isinstance(each, Acknowledgement)]
    if len(replies) == len(meanings):
        return _one_reply(meanings, replies)
    places = [i for i, each in enumerate(meanings) if not isinstance(each, Acknowledgement)]
    after = meanings[places[-1] + 1 :]
    if any(isinstance(each, Acknowledgement) and each.ack not in _CLOSING for each in after):
        return None
    meaning = _together([meanings[place] for place in places])
    return (places[-1], meaning) if meaning is not None else None


def _one_reply(
    meanings: Sequence[Meaning], replies: Sequence[Acknowledgement]
) -> tuple[int, Meaning] | None:
    decisive = {reply for reply in replies if reply.ack in _DECISIVE}
    if len(decisive) > 1:
        return None
    thanked = next((reply for reply in replies if reply.ack == "thanks"), replies[-1])
    chosen = next(iter(decisive), thanked)
    return meanings.index(chosen), chosen


def _together(meanings: Sequence[Meaning]) -> Meaning | None:
    """The one meaning of several moves, None when they have none."""
    first, last = meanings[0], meanings[-1]
    if all(each == last for each in meanings):
        return last
    statements = [each for each in meanings if isinstance(each, Statement)]
    if len(statements) == len(meanings):
        return _taught([rule for each in statements for rule in each.rules])
    if len(meanings) != 2:
        return None
    if first == Retraction() and isinstance(last, Statement):
        return Statement(tuple(replace(rule, revises=True) for rule in last.rules))
    if _sees_target(first, last):
        return last
    return None


def _taught(rules: Sequence[Rule]) -> Statement | None:
    """All that was said, unless one thing was said in two ways."""
    said = tuple(dict.fromkeys(_repaired(rules)))
    if len({replace(rule, confidence=(0, 1)) for rule in said}) < len(said):
        return None
    return Statement(said)


def _repaired(rules: Sequence[Rule]) -> list[Rule]:
    """The rules without those that the same breath corrects: "..., but only sometimes"."""
    kept: list[Rule] = []
    for rule in rules:
        repairs = rule.revises and kept and _subject(kept[-1]) == _subject(rule)
        kept.append(replace(rule, revises=kept.pop().revises) if repairs else rule)
    return kept


def _subject(rule: Rule) -> Rule:
    """What a rule is about, whatever it says of it."""
    rule = replace(rule, confidence=(0, 1), revises=False)
    return replace(rule, part="") if isinstance(rule, ActionRule) else rule


def _sees_target(first: Meaning, last: Meaning) -> bool:
    """Whether the first move asks for the very thing that the second one is to act on."""
    if not isinstance(first, Question) or first.ask != "see":
        return False
    if isinstance(last, ToolCommand):
        return first.object == last.patient
    if not isinstance(last, Command):
        return False
    seen = (first.object, first.affordance)
    return seen in {(last.target.object, None), (None, last.target.used_for)}


def _after_breaks(tokens: Tokens) -> Iterator[int]:
    return (place + 1 for place, token in enumerate(tokens.items) if token.word == BREAK)
