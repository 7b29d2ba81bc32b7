# SPDX-License-Identifier: Apache-2.0
"""The frame parser: beam search for the ways in which a frame covers every token of an utterance.

A cover grows from left to right by a filler, a degree, or a value of one of its slots, as far as
the kinds of words may follow each other; of covers in the same state the cheapest are kept.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from typing import NamedTuple

from ..grammar.categories import AtomicCategory, Category
from ..grammar.combinators import Combination
from ..grammar.grammar import Unary
from ..grammar.terms import Constant, evaluate
from ..lexicon.lexicon import Entry
from ..lexicon.tokenizer import BREAK, Tokens
from ..semantics.coreference import SOMETHING
from ..semantics.predicates import form_of
from .chart import Chart, Derivation
from .frames import Fillers, Frame, Frames, Kind, Phrase

_RULE, _STATEMENT, _QUESTION, _DEGREE = map(AtomicCategory, ("R", "S", "Q", "DG"))
_STATED = (_RULE, _STATEMENT)
_OBJECT, _BARE = AtomicCategory("NP"), (AtomicCategory("N"), AtomicCategory("P"))
_NOTHING, _NEVER = Constant("something"), Constant("none")
_PART_COST = 0.05  # of two covers the one with fewer and longer parts is better
_BEAM = 4
_START, _END, _PAUSE, _CLAUSE = "start", "end", "pause", "clause"


class _Cover(NamedTuple):
    """A frame that covers the first tokens of an utterance.

    Attributes:
        slots: the value of each slot, None for an empty one.
        cues: the groups of the cues found.
        seen: the kinds of the parts, as far as other kinds need them.
        last: the kind of the last part.
    """

    cost: float
    parts: tuple[Derivation, ...]
    slots: tuple[Derivation | None, ...]
    degree: Derivation | None = None
    cues: frozenset[str] = frozenset()
    seen: frozenset[str] = frozenset()
    last: str = _START

    @property
    def key(self) -> tuple[object, ...]:
        """The state of the search: what decides how the cover may grow."""
        filled = tuple(part is not None for part in self.slots)
        return filled, self.degree is not None, self.cues, self.seen, self.last

    def with_part(self, part: Derivation) -> _Cover:
        """Return the cover with one more part."""
        return self._replace(cost=self.cost + part.cost + _PART_COST, parts=(*self.parts, part))


def parse_frames(frames: Frames, tokens: Tokens, chart: Chart) -> Iterator[Derivation]:
    """Return a derivation for each frame and each way in which it covers the utterance.

    The categories of spans come from the chart of the utterance.
    """
    if frames.is_barred(tokens):
        return
    found = _find_constituents(frames, tokens, chart)
    for frame in filter(found.may_fill, frames.frames):
        for cover in _FrameSearch(frames, frame, found).covers():
            yield _derivation(frame, cover, frames.degree)


@dataclass(frozen=True)
class _Constituents:
    """The constituents of an utterance that a frame may take.

    Attributes:
        fillers: of each group the fillers from each position on, with their kinds.
        denials: the phrases for "never" from each position on, with their kinds.
        values: the slot values by category and start.
        categories: the categories of all slot values.
    """

    tokens: Tokens
    words: Phrase
    fillers: Mapping[str, Sequence[Sequence[tuple[str, Derivation]]]]
    denials: Sequence[Sequence[tuple[str, Derivation]]]
    values: Mapping[tuple[Category, int], Sequence[Derivation]]
    categories: frozenset[Category]

    def may_fill(self, frame: Frame) -> bool:
        """Whether there is a value for each slot, and a phrase for each cue, of a frame."""
        fills = (any(kind.category in self.categories for kind in slot) for slot in frame.slots)
        return all(fills) and all(any(self.fillers[name]) for name in frame.cues)


def _find_constituents(frames: Frames, tokens: Tokens, chart: Chart) -> _Constituents:
    words = tokens.words
    values: dict[tuple[Category, int], list[Derivation]] = {}
    for part in chart.fragments(frames.categories | {_DEGREE}):
        if not (
            _is_guess_without_article(part)
            or _is_cut_by_pause(part, tokens)
            or _is_unnamed_object(part)
        ):
            values.setdefault((part.category, part.start), []).append(part)
    return _Constituents(
        tokens,
        words,
        {
            name: _matches(group, AtomicCategory(name), _NOTHING, words)
            for name, group in frames.fillers.items()
        },
        _matches(frames.denials, _DEGREE, _NEVER, words),
        values,
        frozenset(category for category, _ in values),
    )


def _matches(
    group: Fillers, category: Category, term: Constant, words: Phrase
) -> list[list[tuple[str, Derivation]]]:
    def match(place: int) -> list[tuple[str, Derivation]]:
        found = group.match(words, place)
        return [(kind, _words(words[place:end], place, category, term)) for kind, end in found]

    return list(map(match, range(len(words))))


@dataclass(frozen=True)
class _FrameSearch:
    frames: Frames
    frame: Frame
    found: _Constituents

    def covers(self) -> list[_Cover]:
        """Return the cheapest covers of the whole utterance with all slots and cues filled."""
        length = len(self.found.words)
        reached: list[dict[object, list[_Cover]]] = [{} for _ in range(length + 1)]
        start = _Cover(self.frame.cost, (), (None,) * len(self.frame.slots))
        reached[0][start.key] = [start]
        for place in range(length):
            for cover in chain.from_iterable(reached[place].values()):
                for longer in self._extended(cover, place):
                    _keep(reached[longer.parts[-1].end], longer)
        return list(filter(self._is_complete, chain.from_iterable(reached[length].values())))

    def _is_complete(self, cover: _Cover) -> bool:
        has_all = None not in cover.slots and len(cover.cues) == len(self.frame.cues)
        is_clause = self.frame.result not in _STATED or self._has_needs(cover, _CLAUSE)
        if not (has_all and is_clause and self._may_end(cover)):
            return False
        # A question has its mark, or begins as one.
        is_question = self.frame.result == _QUESTION and not self.found.tokens.asks
        return not is_question or str(cover.parts[0].category) in self.frames.openers

    def _extended(self, cover: _Cover, place: int) -> Iterator[_Cover]:
        if self.found.words[place] == BREAK and self._may_end(cover) and self.frame.joins:
            part = _words((BREAK,), place, AtomicCategory(BREAK), _NOTHING)
            seen = cover.seen | {_PAUSE}
            yield cover.with_part(part)._replace(last=_START, seen=seen)
        for kind, part in self._candidates(cover, place):
            is_pause = place in self.found.tokens.pauses and self._may_end(cover)
            fits = self.frames.may_follow(kind, cover.last)
            fits = fits or (is_pause and self.frames.may_follow(kind, _START))
            if fits and self._has_needs(cover, kind):
                kinds = {kind, _PAUSE} if is_pause else {kind}
                seen = cover.seen | (self.frames.needed & kinds)
                yield self._with(cover, part)._replace(last=kind, seen=seen)

    def _candidates(self, cover: _Cover, place: int) -> Iterator[tuple[str, Derivation]]:
        for name in self.frame.fillers:
            for kind, filler in self.found.fillers[name][place]:
                if not self._makes_question(cover, filler):
                    yield kind, filler
        if self.frame.result == _RULE:
            yield from self._degrees(cover, place)
        for slot, filled in zip(self.frame.slots, cover.slots, strict=True):
            for kind in slot if filled is None else ():
                for part in self.found.values.get((kind.category, place), ()):
                    if not _is_retyped(part, slot):
                        yield kind.name, part

    def _degrees(self, cover: _Cover, place: int) -> Iterator[tuple[str, Derivation]]:
        if cover.degree is None:
            yield from self.found.denials[place]
        for part in self.found.values.get((_DEGREE, place), ()):
            # A degree may be said twice: "always, without exception".
            if cover.degree is None or form_of(part.value) == form_of(cover.degree.value):
                yield str(_DEGREE), part

    def _with(self, cover: _Cover, part: Derivation) -> _Cover:
        longer = cover.with_part(part)
        if str(part.category) in self.frame.fillers:
            cue = self.frame.cues & {str(part.category)}
            return longer._replace(cues=cover.cues | cue)
        if part.category == _DEGREE:
            return longer._replace(degree=part)
        index = next(
            index
            for index, slot in enumerate(self.frame.slots)
            if cover.slots[index] is None and any(part.category == kind.category for kind in slot)
        )
        return longer._replace(slots=(*cover.slots[:index], part, *cover.slots[index + 1 :]))

    def _makes_question(self, cover: _Cover, filler: Derivation) -> bool:
        """Whether a filler turns a rule into a question, or a question into another one."""
        if self.frame.result not in _STATED:
            return False
        phrase = self.found.words[filler.start : filler.end]
        if self.found.tokens.asks:
            # A question within a question is none about a rule.
            within = any((word,) in self.frames.asking for word in phrase)
            return within or BREAK in self.found.words
        asks = phrase[:1] in self.frames.asking or phrase in self.frames.inverted
        return asks and all(self._is_plain_degree(part) for part in cover.parts)

    def _is_plain_degree(self, part: Derivation) -> bool:
        """Whether a part is a degree after which inversion asks, unlike after "rarely"."""
        phrase = self.found.words[part.start : part.end]
        return part.category == _DEGREE and phrase not in self.frames.inverting

    def _has_needs(self, cover: _Cover, kind: str) -> bool:
        needed = self.frames.needs.get(kind)
        return needed is None or bool(needed & cover.seen)

    def _may_end(self, cover: _Cover) -> bool:
        return self.frames.may_follow(_END, cover.last)


def _is_unnamed_object(part: Derivation) -> bool:
    """Whether a part is "something" or the like, with or without properties."""
    if part.category != _OBJECT:
        return False
    form = form_of(part.value)
    while form.name == "having":
        form = form.arguments[0]
    return form.name in SOMETHING


def _is_cut_by_pause(part: Derivation, tokens: Tokens) -> bool:
    """Whether there is a pause within a part; only a list of objects may have one."""
    within = any(part.start < pause < part.end for pause in tokens.pauses)
    return within and part.category != _OBJECT


def _is_retyped(part: Derivation, slot: Sequence[Kind]) -> bool:
    """Whether a unary rule made the part from a category that the slot takes as well."""
    rule = part.rule
    return isinstance(rule, Unary) and any(rule.source == kind.category for kind in slot)


def _is_guess_without_article(part: Derivation) -> bool:
    """Whether a part is an unknown word without an article, which may be any word."""
    while part.parts and len(part.parts) == 1:
        part = part.parts[0]
    return isinstance(part.rule, Entry) and bool(part.rule.role) and part.category in _BARE


def _keep(reached: dict[object, list[_Cover]], cover: _Cover) -> None:
    same = reached.setdefault(cover.key, [])
    same.append(cover)
    same.sort(key=lambda each: each.cost)
    del same[_BEAM:]


def _words(words: Phrase, start: int, category: Category, term: Constant) -> Derivation:
    value = evaluate(term)
    entry = Entry(category, term, value, -1, says=" ".join(words))
    return Derivation(category, value, 0.0, start, start + len(words), entry)


def _derivation(frame: Frame, cover: _Cover, degree: str) -> Derivation:
    value = frame.value
    for part in cover.slots:
        value = value(part.value) if part is not None else value
    category = frame.result
    if category == _RULE:
        said = cover.degree
        value = value(said.value if said is not None else evaluate(Constant(degree)))
        category = _STATEMENT
    end = cover.parts[-1].end
    return Derivation(category, value, cover.cost, 0, end, Combination.GATHERED, cover.parts)
