# SPDX-License-Identifier: Apache-2.0
"""The ways in which an utterance is tried, one after the other, until it means something.

As one whole; as a row of moves; both without what is only said by the way; and at last by the
things that it names, in any order. Each way uses all of its words, or has declared them empty.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import replace
from typing import TypeGuard

from ..lexicon.discourse_markers import move_to_front
from ..lexicon.tokenizer import BREAK, Tokens
from ..semantics.meaning import AskBack, Command, Meaning, Misunderstanding, ToolCommand
from ..semantics.predicates import Form
from .hearing import Hearing, without_reading
from .parser import UtteranceContext
from .segmentation import Moves
from .understanding import Understanding


class Attempts:
    """The ways for one utterance; no part of it is taken in twice.

    Args:
        hearing: what takes one whole in.
        insist: words that are new although they are close to known ones.
    """

    def __init__(self, hearing: Hearing, insist: Collection[str]) -> None:
        self._hearing, self._insist = hearing, insist
        self._known: dict[tuple[Tokens, UtteranceContext, bool], Understanding] = {}
        self._topics: dict[tuple[Tokens, UtteranceContext], Form | None] = {}
        self._moved: set[Tokens] = set()  # where a degree was put in front of it all

    def understood(self, tokens: Tokens, situation: UtteranceContext) -> Understanding:
        """What it means, in the first way that gives it a meaning."""
        markers = self._hearing.builder.discourse_markers
        tokens = markers.mark_boundaries(tokens)
        request = markers.request_before_tag(tokens)
        found = self._tried(request, situation) if request else None
        if found and isinstance(found.meaning, (Command, ToolCommand)):
            return replace(found, text=tokens.text)
        untagged = markers.remove_tag(tokens)
        return self._tried(tokens if untagged.asks else untagged, situation)

    def _tried(self, tokens: Tokens, situation: UtteranceContext) -> Understanding:
        found = self._taken(tokens, situation)
        if found.reading is None and BREAK in tokens.words:
            again = self._taken(tokens.without_breaks(), situation)
            found = again if again.reading is not None else found
        if not _is_open(found.meaning):
            return found
        again = self._in_turn(tokens, situation) or self._without_asides(tokens, situation)
        if not again and not (found.readings and _is_slip(found.meaning)):
            again = self._in_frames(tokens, situation)
            if again is None or again.reading is None:
                again = self._after_reason(tokens, situation) or again
        return replace(again, text=tokens.text) if _is_better(again, found) else found

    def _without_asides(self, tokens: Tokens, situation: UtteranceContext) -> Understanding | None:
        """An utterance without what is said by the way; None when that is none either."""
        tried = {tokens.words}
        for each in self._versions(tokens):
            if each.words in tried or not each.items:
                continue
            tried.add(each.words)
            for whole in filter(_says_something, (each, each.without_breaks())):
                found = self._taken(whole, situation)
                if found.reading is not None:
                    return found
            again = self._in_turn(each, situation)
            if again is not None:
                return again
        return None

    def _after_reason(self, tokens: Tokens, situation: UtteranceContext) -> Understanding | None:
        """What is asked for after a reason of the speaker's own; None when nothing is."""
        builder = self._hearing.builder
        rest = builder.discourse_markers.after_reason(builder.expand_endings(tokens))
        found = self._tried(rest, situation) if rest else None
        return found if found and isinstance(found.meaning, (Command, ToolCommand)) else None

    def _in_frames(self, tokens: Tokens, situation: UtteranceContext) -> Understanding | None:
        """An utterance by the things that it names; None when that is nothing either."""
        asks: Understanding | None = None
        for each in filter(_says_something, dict.fromkeys(self._versions(tokens))):
            found = self._taken(each, situation, in_frames=True)
            again = found
            if found.reading is None:
                again = self._in_turn(each, situation, in_frames=True) or found
            if again.reading is not None:
                return again
            if asks is None and isinstance(found.meaning, AskBack):
                asks = found
        return asks

    def _versions(self, tokens: Tokens) -> Iterator[Tokens]:
        """The utterance in other words that mean the same, those closest to it first."""
        markers = self._hearing.builder.discourse_markers
        degrees = self._hearing.builder.qualifier_phrases
        untagged = markers.remove_tag(tokens)
        for each in (untagged, self._hearing.builder.expand_endings(untagged)):
            yield each
            bare = markers.remove_markers(each, degrees)
            yield bare
            moved = None if BREAK in bare.words else move_to_front(bare, degrees)
            if moved:
                self._moved.add(moved)
                yield moved

    def _in_turn(
        self,
        tokens: Tokens,
        situation: UtteranceContext,
        *,
        in_frames: bool = False,
    ) -> Understanding | None:
        """An utterance as several moves that come to one meaning; None when they do not."""

        def take(move: Tokens, situation: UtteranceContext) -> Understanding:
            found = self._taken(move, situation)
            if in_frames and found.reading is None:
                return self._taken(move, situation, in_frames=True)
            return found

        return Moves(take, self._topic, self._hearing.is_general).in_turn(tokens, situation)

    def _taken(
        self, tokens: Tokens, situation: UtteranceContext, *, in_frames: bool = False
    ) -> Understanding:
        key = (tokens, situation, in_frames)
        if key not in self._known:
            taken = self._hearing.taken(tokens, situation, self._insist, in_frames=in_frames)
            if tokens in self._moved and _says_several(taken):
                # It was said of one of them; which one, its place does not tell any more.
                taken = without_reading(tokens, situation, Misunderstanding(tokens.text))
            self._known[key] = taken
        return self._known[key]

    def _topic(self, tokens: Tokens, situation: UtteranceContext) -> Form | None:
        key = (tokens, situation)
        if key not in self._topics:
            self._topics[key] = self._hearing.topic(tokens, situation)
        return self._topics[key]


def _says_something(tokens: Tokens) -> bool:
    return any(token.word != BREAK for token in tokens.items)


def _says_several(found: Understanding) -> bool:
    """Whether it puts several rules into one."""
    return found.reading is not None and found.reading.intention.arguments[-1].name == "and"


def _is_open(meaning: Meaning) -> bool:
    """Whether an utterance may still be understood in another way: it has not several meanings."""
    return isinstance(meaning, Misunderstanding) or (
        isinstance(meaning, AskBack) and len(meaning.choices) <= 1
    )


def _is_better(again: Understanding | None, found: Understanding) -> TypeGuard[Understanding]:
    """Whether an attempt came to more than the first one: a meaning, or a question back."""
    if again is None:
        return False
    return again.reading is not None or isinstance(found.meaning, Misunderstanding)


def _is_slip(meaning: Meaning) -> bool:
    """Whether the question back is if another word was meant."""
    return isinstance(meaning, AskBack) and bool(meaning.choices)
