# SPDX-License-Identifier: Apache-2.0
"""The search for covers: all ways in which a frame takes in every word of an utterance.

From the left to the right a cover grows by a filler, a degree, or a thing for one of its slots, as
far as the kinds of words may follow each other; of covers that go on alike the cheapest are kept.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
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

_RULE, _STATEMENT, _QUESTION, _DEGREE = (
    AtomicCategory("R"),
    AtomicCategory("S"),
    AtomicCategory("Q"),
    AtomicCategory("DG"),
)
_STATED = (_RULE, _STATEMENT)
_OBJECT, _BARE = AtomicCategory("NP"), (AtomicCategory("N"), AtomicCategory("P"))
_NOTHING, _NEVER = Constant("something"), Constant("none")
_PART_COST = 0.05  # of two covers the one with fewer and longer parts is better
_BEAM = 4
_START, _END, _PAUSE, _CLAUSE = "start", "end", "pause", "clause"


class _Cover(NamedTuple):
    """How far a frame has come.

    Attributes:
        cost: the sum of the costs of its parts.
        parts: all that it has taken, from left to right.
        slots: what fills each slot, None for what is still needed.
        degree: the degree that was said, if any.
        cues: the groups of the cues that were heard.
        seen: the kinds of what it has taken, as far as others need them.
        last: the kind of what was taken last.
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
        """What decides how it may go on."""
        filled = tuple(part is not None for part in self.slots)
        return filled, self.degree is not None, self.cues, self.seen, self.last

    def and_part(self, part: Derivation) -> _Cover:
        """The same with one more part."""
        return self._replace(cost=self.cost + part.cost + _PART_COST, parts=(*self.parts, part))


def parse_frames(frames: Frames, tokens: Tokens, chart: Chart) -> Iterator[Derivation]:
    """What an utterance comes to, for each frame and each way to cover it.

    Args:
        frames: the frames of the language.
        tokens: the utterance.
        chart: all that its spans can be.
    """
    if frames.is_barred(tokens):
        return
    heard = _heard(frames, tokens, chart)
    for frame in filter(heard.may_be, frames.frames):
        for cover in _Search(frames, frame, heard).covers():
            yield _whole(frame, cover, frames.degree)


@dataclass(frozen=True)
class _Heard:
    """What there is in an utterance for any frame.

    Attributes:
        tokens: the utterance.
        words: its words.
        fillers: of each group the fillers from each place on, with their kinds.
        denials: the denials from each place on, with their kinds.
        things: what is each category from a place on.
        categories: all that something is.
    """

    tokens: Tokens
    words: Phrase
    fillers: Mapping[str, Sequence[Sequence[tuple[str, Derivation]]]]
    denials: Sequence[Sequence[tuple[str, Derivation]]]
    things: Mapping[tuple[Category, int], Sequence[Derivation]]
    categories: frozenset[Category]

    def may_be(self, frame: Frame) -> bool:
        """Whether there is something for each slot, and each cue, of a frame."""
        fills = (any(kind.category in self.categories for kind in slot) for slot in frame.slots)
        return all(fills) and all(any(self.fillers[name]) for name in frame.cues)


def _heard(frames: Frames, tokens: Tokens, chart: Chart) -> _Heard:
    words, places = tokens.words, range(len(tokens.items))
    things: dict[tuple[Category, int], list[Derivation]] = {}
    for part in chart.fragments(frames.categories | {_DEGREE}):
        if not (_is_bare_guess(part) or _is_cut(part, tokens) or _is_anything(part)):
            things.setdefault((part.category, part.start), []).append(part)
    return _Heard(
        tokens,
        words,
        {
            name: [_said(group, AtomicCategory(name), _NOTHING, words, place) for place in places]
            for name, group in frames.fillers.items()
        },
        [_said(frames.denials, _DEGREE, _NEVER, words, place) for place in places],
        things,
        frozenset(category for category, _ in things),
    )


def _said(
    group: Fillers, category: Category, term: Constant, words: Phrase, place: int
) -> list[tuple[str, Derivation]]:
    """The phrases of a group from a place on, with the kind of word that each is."""
    return [
        (kind, _words(words[place:end], place, category, term))
        for kind, end in group.at(words, place)
    ]


@dataclass(frozen=True)
class _Search:
    frames: Frames
    frame: Frame
    heard: _Heard

    def covers(self) -> list[_Cover]:
        """The cheapest covers of the utterance that fill all slots and have all cues."""
        length = len(self.heard.words)
        reached: list[dict[object, list[_Cover]]] = [{} for _ in range(length + 1)]
        start = _Cover(self.frame.cost, (), (None,) * len(self.frame.slots))
        reached[0][start.key] = [start]
        for place in range(length):
            for cover in [each for same in reached[place].values() for each in same]:
                for longer in self._longer(cover, place):
                    _keep(reached[longer.parts[-1].end], longer)
        return [each for same in reached[length].values() for each in same if self._is_full(each)]

    def _is_full(self, cover: _Cover) -> bool:
        has_all = None not in cover.slots and len(cover.cues) == len(self.frame.cues)
        is_clause = self.frame.result not in _STATED or self._has_needs(cover, _CLAUSE)
        return has_all and is_clause and self._may_end(cover) and self._is_asked(cover)

    def _is_asked(self, cover: _Cover) -> bool:
        """Whether a question is one: by its mark, or because it begins as one."""
        if self.frame.result != _QUESTION or self.heard.tokens.asks:
            return True
        return str(cover.parts[0].category) in self.frames.openers

    def _longer(self, cover: _Cover, place: int) -> Iterator[_Cover]:
        """The cover with each part that may come next."""
        if self.heard.words[place] == BREAK and self._may_end(cover) and self.frame.joins:
            part = _words((BREAK,), place, AtomicCategory(BREAK), _NOTHING)
            seen = cover.seen | {_PAUSE}
            yield cover.and_part(part)._replace(last=_START, seen=seen)
        for kind, part in self._next(cover, place):
            is_pause = place in self.heard.tokens.pauses and self._may_end(cover)
            fits = self.frames.may_follow(kind, cover.last)
            fits = fits or (is_pause and self.frames.may_follow(kind, _START))
            if fits and self._has_needs(cover, kind):
                heard = {kind, _PAUSE} if is_pause else {kind}
                seen = cover.seen | (self.frames.needed & heard)
                yield self._with(cover, part)._replace(last=kind, seen=seen)

    def _next(self, cover: _Cover, place: int) -> Iterator[tuple[str, Derivation]]:
        """What may come next by itself, and its kind."""
        for name in self.frame.fillers:
            for kind, filler in self.heard.fillers[name][place]:
                if not self._asks(cover, filler):
                    yield kind, filler
        if self.frame.result == _RULE:
            yield from self._degrees(cover, place)
        for slot, filled in zip(self.frame.slots, cover.slots, strict=True):
            for kind in slot if filled is None else ():
                for part in self.heard.things.get((kind.category, place), ()):
                    if not _is_changed(part, slot):
                        yield kind.name, part

    def _degrees(self, cover: _Cover, place: int) -> Iterator[tuple[str, Derivation]]:
        if cover.degree is None:
            yield from self.heard.denials[place]
        for part in self.heard.things.get((_DEGREE, place), ()):
            # A degree may be said twice: "always, without exception".
            if cover.degree is None or _is_same(part, cover.degree):
                yield str(_DEGREE), part

    def _with(self, cover: _Cover, part: Derivation) -> _Cover:
        longer = cover.and_part(part)
        if str(part.category) in self.frame.fillers:
            heard = self.frame.cues & {str(part.category)}
            return longer._replace(cues=cover.cues | heard)
        if part.category == _DEGREE:
            return longer._replace(degree=part)
        index = next(
            index
            for index, slot in enumerate(self.frame.slots)
            if cover.slots[index] is None and any(part.category == kind.category for kind in slot)
        )
        return longer._replace(slots=(*cover.slots[:index], part, *cover.slots[index + 1 :]))

    def _asks(self, cover: _Cover, filler: Derivation) -> bool:
        """Whether a filler makes a question of a rule, or of a question another one."""
        if self.frame.result not in _STATED:
            return False
        phrase = self.heard.words[filler.start : filler.end]
        if self.heard.tokens.asks:
            # A question within a question is none about a rule.
            within = any((word,) in self.frames.asking for word in phrase)
            return within or BREAK in self.heard.words
        asks = phrase[:1] in self.frames.asking or phrase in self.frames.inverted
        return asks and all(self._is_plain_degree(part) for part in cover.parts)

    def _is_plain_degree(self, part: Derivation) -> bool:
        """Whether it is a degree after which a question is still one, unlike "rarely"."""
        phrase = self.heard.words[part.start : part.end]
        return part.category == _DEGREE and phrase not in self.frames.inverting

    def _has_needs(self, cover: _Cover, kind: str) -> bool:
        needed = self.frames.needs.get(kind)
        return needed is None or bool(needed & cover.seen)

    def _may_end(self, cover: _Cover) -> bool:
        return self.frames.may_follow(_END, cover.last)


def _is_anything(part: Derivation) -> bool:
    """Whether it is a thing without a name, which may be what something else stands for."""
    if part.category != _OBJECT:
        return False
    form = form_of(part.value)
    while form.name == "having":
        form = form.arguments[0]
    return form.name in SOMETHING


def _is_cut(part: Derivation, tokens: Tokens) -> bool:
    """Whether a pause cuts a thing in two; only a list of objects may have some."""
    within = any(part.start < pause < part.end for pause in tokens.pauses)
    return within and part.category != _OBJECT


def _is_changed(part: Derivation, slot: Sequence[Kind]) -> bool:
    """Whether a thing was something else first that goes into the slot as well."""
    rule = part.rule
    return isinstance(rule, Unary) and any(rule.source == kind.category for kind in slot)


def _is_same(one: Derivation, other: Derivation) -> bool:
    return form_of(one.value) == form_of(other.value)


def _is_bare_guess(part: Derivation) -> bool:
    """Whether it is an unknown word without the article that a name has: that may be any word."""
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


def _whole(frame: Frame, cover: _Cover, degree: str) -> Derivation:
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
