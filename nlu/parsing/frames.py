# SPDX-License-Identifier: Apache-2.0
"""Frames: what an utterance comes to by the things that it names, in whatever order it names them.

"Poking, that is something a screwdriver does sometimes" names an object, a use and a degree. The
chart knows what each span is; a frame says that an object and a use make a rule. Every other word
must be listed as one that adds nothing to that frame, so that still nothing is left out: what is
not listed, such as "only", "than" or "said", is in the way. After frame semantics (Fillmore 1982)
and categories that take a set of arguments (Hoffman 1995).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

from ..grammar.categories import Category
from ..grammar.patterns import Steps, matches
from ..grammar.terms import Value
from ..lexicon.tokenizer import Tokens

Phrase = tuple[str, ...]


class Kind(NamedTuple):
    """One thing that a slot may be: how it goes with its neighbours, and its category."""

    name: str
    category: Category


class Said(NamedTuple):
    """A filler that was found: the kind of word that it is, and one past its last token."""

    kind: str
    end: int


@dataclass(frozen=True)
class Fillers:
    """Phrases, each with the kind of word that it is.

    Attributes:
        kinds: the kinds of words.
        steps: the graph of the phrases by their first word, `*` for any; the number at an end is
            the place of the kind.
        words: all words of all phrases.
    """

    kinds: tuple[str, ...]
    steps: Mapping[str, Steps]
    words: frozenset[str]

    def at(self, words: Sequence[str], place: int) -> frozenset[Said]:
        """All of the phrases that begin at a place."""
        steps = (*self.steps.get(words[place], ()), *self.steps.get("*", ()))
        found = matches(steps, words, place)
        return frozenset(Said(self.kinds[kind], end) for kind, end in found)


@dataclass(frozen=True)
class Frame:
    """Things that together have a meaning, in any order.

    Attributes:
        slots: what each of the things may be.
        fillers: the groups of phrases that may stand between them.
        cues: those groups of which there must be a phrase.
        result: the category of the whole; a rule takes a degree, too.
        value: the function from the meanings of the slots, in their order, to that of the whole.
        cost: how unlikely it is.
        joins: whether it may go over several sentences.
    """

    slots: tuple[tuple[Kind, ...], ...]
    fillers: tuple[str, ...]
    cues: frozenset[str]
    result: Category
    value: Value
    cost: float
    joins: bool


@dataclass(frozen=True)
class Frames:
    """The frames of a language.

    Attributes:
        frames: the frames.
        fillers: the groups of phrases that add nothing.
        denials: phrases that say that it is never so, by their kind.
        barred: phrases that no frame can do with.
        inverted: words that ask when they come first.
        inverting: degrees after which the subject comes later, although nothing is asked.
        asking: words that ask for something wherever they stand, in what is a question.
        openers: the groups of phrases that begin a question without its mark.
        follows: what kinds may come after each kind, and at the start and the end of a clause.
        needs: the kinds of which one must go before a kind; a rule needs those of `clause`.
        degree: the degree of a rule when none was said.
    """

    frames: tuple[Frame, ...]
    fillers: Mapping[str, Fillers]
    denials: Fillers
    barred: Fillers
    inverted: frozenset[Phrase]
    inverting: frozenset[Phrase]
    asking: frozenset[Phrase]
    openers: frozenset[str]
    follows: Mapping[str, frozenset[str]]
    needs: Mapping[str, frozenset[str]]
    degree: str

    @cached_property
    def needed(self) -> frozenset[str]:
        """All kinds that something needs."""
        return frozenset[str]().union(*self.needs.values())

    @cached_property
    def categories(self) -> frozenset[Category]:
        """All that may fill a slot."""
        slots = (slot for frame in self.frames for slot in frame.slots)
        return frozenset(kind.category for slot in slots for kind in slot)

    @cached_property
    def words(self) -> frozenset[str]:
        """All words of all fillers and denials."""
        groups = (self.denials, *self.fillers.values())
        return frozenset[str]().union(*(group.words for group in groups))

    def may_follow(self, kind: str, last: str) -> bool:
        """Whether one kind may come right after another one."""
        return kind in self.follows.get(last, frozenset())

    def is_barred(self, tokens: Tokens) -> bool:
        """Whether an utterance has a phrase that no frame can do with."""
        return any(self.barred.at(tokens.words, place) for place in range(len(tokens.items)))
