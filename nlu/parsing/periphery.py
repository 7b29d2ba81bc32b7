"""Periphery: what surrounds the core of an utterance, by its form, its pause and its operators.

"My hands are wet. Pass me the mug" has a core, a request, and before it a clause behind a strong
pause. `TABLE` says beside which kinds of core a piece of periphery may stand without a question.
What no row allows is asked about, or refused.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from ..lexicon.tokenizer import Tokens
from ..lexicon.unknown_words import KnownWords
from ..semantics.meaning import ActionRule, Command, Meaning, Question, Statement, ToolCommand
from .utterance_pieces import (
    AFTER,
    ASIDE,
    ASKING,
    BUT,
    COLON,
    HEARER,
    IMPERSONAL,
    INSIDE,
    LEAST_WORDS,
    MARKER,
    OTHER,
    OWN,
    PHRASE,
    PURPOSE,
    REASON,
    SO,
    STRONG,
    TOLD,
    WEAK,
    WITHIN,
    PieceReader,
    UtterancePiece,
)

REQUEST, QUESTION, HOLDING, USE = "request", "question", "holding", "use"
"""The kinds of cores: a command and a question to the robot, and the rules of two kinds."""

MAX_CORES = 8
"""How many cores of one utterance are parsed."""

_ANYWHERE = frozenset({WEAK, ASKING, COLON, BUT, SO, STRONG, AFTER, TOLD})
_THINGS = ("N", "MS")

# With these a piece makes the core a pretence, or its speaker is not sure of it.
_UNREAL = frozenset(
    {
        *("unreal", "quoted", "called", "doubtful", "source=hearsay"),
        *("attitude=hypothetical", "attitude=doubt", "belief=denied"),
    }
)
_CONDITIONAL = frozenset({"condition", "exception", "condition=absent"})
_PLAYED = frozenset({"unreal", "quoted", "attitude=hypothetical"})
# The same, and with what makes the core somebody else's word.
_PRETENDED = _UNREAL | {"report", "source=other"}
# The same, and what asks for something else or only under a condition.
_REPORTED = _PRETENDED | _CONDITIONAL | {"knowledge", "act", "held", "unwanted"}
_NAMING = _REPORTED | {"named"}
# On these a rule may depend as well; less so in a reason for it.
_LIMITING = _REPORTED | {
    *("negative", "implied_negation", "weak_negation", "degree", "exception=exception"),
    *("tense=past", "tense=now", "modality=weak", "attitude=think", "attitude=hedged"),
    *("agent=other", "agent=they", "agent=people", "agent=somebody"),
    *("quantifier=most", "quantifier=partial"),
}
_LIMITING_REASON = (_LIMITING | {"custom", "circumstance"}) - {
    *("negative", "implied_negation", "modality=weak", "exception=exception", "exception"),
    *("agent=they", "agent=people", "agent=somebody", "quantifier=partial", "weak_negation"),
    *("tense=past", "degree", "quantifier=most"),
}
_LIMITING_ASIDE = (_LIMITING | {"named"}) - {"agent=other", "agent=they", "agent=people"}


@dataclass(frozen=True)
class PeripheryRow:
    """A row: beside which cores a piece of some form, so set off, changes nothing, and unless."""

    of: frozenset[str]
    forms: frozenset[str]
    pauses: frozenset[int]
    unless: frozenset[str] = frozenset()

    def allows(self, kind: str, piece: UtterancePiece, pause: int) -> bool:
        """Whether a core of a kind may stand beside a piece that is set off by a pause."""
        return (
            kind in self.of
            and piece.form in self.forms
            and pause in self.pauses
            and self.unless.isdisjoint(piece.signs)
        )


_REQUESTS, _RULES = frozenset({REQUEST, QUESTION}), frozenset({HOLDING, USE})
_KINDS = _REQUESTS | _RULES
_CAUSES = frozenset({REASON, PURPOSE})
_PERSONS = frozenset({OWN, HEARER})
_CLAUSES = _CAUSES | {OWN, IMPERSONAL, OTHER}

TABLE: Sequence[PeripheryRow] = (
    PeripheryRow(_KINDS, frozenset({MARKER}), _ANYWHERE),
    # What is announced is meant, whatever was said before it, but for a condition or a pretence.
    PeripheryRow(
        _KINDS, _CLAUSES | {HEARER, ASIDE}, frozenset({TOLD}), _PLAYED | _CONDITIONAL | {"short"}
    ),
    PeripheryRow(_KINDS, frozenset({PHRASE}), frozenset({TOLD}), _LIMITING),
    # What is asked for at the end is wanted, whatever made the speaker ask.
    PeripheryRow(_REQUESTS, _CLAUSES, frozenset({STRONG}), _REPORTED),
    PeripheryRow(_REQUESTS, _CLAUSES, frozenset({COLON}), _REPORTED | {"pointing"}),
    PeripheryRow(_REQUESTS, frozenset({OWN, IMPERSONAL, OTHER}), frozenset({ASKING}), _NAMING),
    PeripheryRow(
        _REQUESTS,
        _CLAUSES | {HEARER},
        frozenset({SO, BUT}),
        _PLAYED | _CONDITIONAL | {"called", "act", "unwanted"},
    ),
    PeripheryRow(_REQUESTS, frozenset({REASON}), _ANYWHERE, _REPORTED),
    PeripheryRow(_REQUESTS, frozenset({PURPOSE}), _ANYWHERE, _REPORTED | {"agent=other"}),
    PeripheryRow(
        frozenset({REQUEST}),
        frozenset({OWN, OTHER}),
        frozenset({AFTER}),
        (_LIMITING | {"named"}) - {"agent=other"},
    ),
    # A phrase says how to do something, unless it precedes a question or gives a reason.
    PeripheryRow(
        frozenset({QUESTION}), frozenset({PHRASE}), frozenset({ASKING}), _NAMING | {"circumstance"}
    ),
    PeripheryRow(_REQUESTS, frozenset({PHRASE}), frozenset({SO}), _NAMING | {"restricting"}),
    PeripheryRow(
        frozenset({HOLDING}), frozenset({PHRASE}), frozenset({SO}), _LIMITING | {"restricting"}
    ),
    # A reason or a purpose does not limit a rule, before or after it.
    PeripheryRow(_RULES, _CAUSES, _ANYWHERE, _LIMITING_REASON),
    PeripheryRow(frozenset({HOLDING}), _CLAUSES, frozenset({SO}), _LIMITING_REASON),
    # Nor does what speakers say of themselves; a colon needs an announcement.
    PeripheryRow(_RULES, frozenset({OWN}), frozenset({STRONG}), _LIMITING),
    # What a rule is contrasted with does not hold it back.
    PeripheryRow(_RULES, _PERSONS | {IMPERSONAL, OTHER}, frozenset({BUT}), _UNREAL | _CONDITIONAL),
    PeripheryRow(
        _RULES,
        _PERSONS | {IMPERSONAL, OTHER},
        frozenset({STRONG}),
        _NAMING | {"negative", "implied_negation", "pointing", "tense=past"},
    ),
    # What is said of the thing by the way says nothing of its use.
    PeripheryRow(_KINDS, frozenset({ASIDE, OWN}), frozenset({WITHIN}), _LIMITING_ASIDE),
    PeripheryRow(_KINDS, _CAUSES, frozenset({WITHIN}), _LIMITING_REASON),
)


@dataclass(frozen=True)
class Core:
    """What an utterance may mean, without what surrounds it.

    Attributes:
        tokens: the core, with its periphery as removed phrases.
        kinds: the kinds of meaning that it may have there.
        preamble: the sentences before it.
        is_referring: whether the periphery may name what a pronoun of the core stands for.
        referent: the only known thing that it names and the core does not.
        has_person: whether the core has a pronoun for somebody.
    """

    tokens: Tokens
    kinds: frozenset[str]
    preamble: tuple[Tokens, ...]
    is_referring: bool
    referent: str | None
    has_person: bool


@dataclass(frozen=True, repr=False)
class PeripheryReader:
    """Finds the cores of utterances, which have their short forms written out."""

    reader: PieceReader
    known: KnownWords

    def cores(self, tokens: Tokens, expanded: Tokens) -> Iterator[Core]:
        """Yield the cores to try, the longest first; in `expanded` no word is a short form."""
        pieces = self.reader.pieces(expanded)
        starts = {piece.core_start for piece in pieces} | {0}
        spans = ((start, piece.end) for start in starts for piece in pieces)
        long_enough = [s for s in spans if s[1] - s[0] >= LEAST_WORDS]
        for start, end in sorted(long_enough, key=lambda span: (span[0] - span[1], span)):
            core = self._core(tokens, (start, end), pieces)
            if core is not None:
                yield core

    def around(
        self, expanded: Tokens, span: tuple[int, int]
    ) -> tuple[list[UtterancePiece], list[UtterancePiece], int]:
        """Return the pieces before and after a span, and its pause, `INSIDE` within a clause."""
        start, end = span
        sides = (expanded.part(0, start), expanded.part(end, len(expanded.items)))
        before, after = map(self.reader.pieces, sides)
        pauses = [each.pause for each in self.reader.pieces(expanded) if each.start == start]
        beginning = [each.joined for each in before[-1:] if each.form == MARKER]
        joined = self.reader.joined(expanded.words[start:])
        return before, after, max((*pauses, *beginning, *joined), default=INSIDE)

    def _core(
        self, tokens: Tokens, span: tuple[int, int], pieces: Sequence[UtterancePiece]
    ) -> Core | None:
        start, end = span
        within = [each for each in pieces if start < each.start and each.end < end]
        placed = [*self._before(tokens, span, pieces)]
        after = [each for each in pieces if each.start >= end]
        placed += [(e, TOLD if _announces(e) and "pointing" in e.signs else AFTER) for e in after]
        placed += [(each, WITHIN) for each in within if _permitted(each, WITHIN)]
        kinds = _KINDS.intersection(*(_permitted(*each) for each in placed))
        if not placed or not kinds:
            return None
        said = [(each, pause) for each, pause in placed if each.form != MARKER]
        phrases = [tokens.words[each.start : each.end] for each, _ in said]
        limiting = (
            phrase
            for (each, pause), phrase in zip(said, phrases, strict=True)
            if each.form not in _CAUSES and pause not in {BUT, SO, TOLD}
        )
        left_out = {
            place
            for each, pause in placed
            if pause == WITHIN
            for place in range(each.start, each.end)
        }
        kept = [place for place in range(start, end) if place not in left_out]
        removed = (*tokens.removed, *limiting)
        return Core(
            replace(tokens.part(0, end).only(kept), removed=removed),
            kinds,
            tuple(_sentences(tokens, start, pieces)),
            any(self.known.may_be_a_thing(word) for phrase in phrases for word in phrase),
            self._referent([each for each, _ in said], tokens, span),
            any(self.reader.words.has("person", word) for word in tokens.words[start:end]),
        )

    def _before(
        self, tokens: Tokens, span: tuple[int, int], pieces: Sequence[UtterancePiece]
    ) -> Iterator[tuple[UtterancePiece, int]]:
        """The pieces before a core, each with how it is set off."""
        start, end = span
        before = [each for each in pieces if each.end <= start]
        joined = max((each.joined for each in pieces if each.core_start == start), default=WEAK)
        if tokens.asks and end == len(tokens.items):
            joined = max(joined, ASKING)
        said = [each for each in before if each.form != MARKER]
        is_told = bool(said) and _announces(said[-1])
        for each in before:
            between = (p.pause for p in pieces if each.end <= p.start <= start and p.pause != TOLD)
            yield each, TOLD if is_told else max((joined, *between))

    def _referent(
        self, pieces: Sequence[UtterancePiece], tokens: Tokens, span: tuple[int, int]
    ) -> str | None:
        """The only thing that some pieces name and a core does not, None unless it is known."""
        words = tokens.words
        named = {
            words[place]
            for each in pieces
            for place in range(each.start + 1, each.end)
            if words[place - 1] in self.reader.features.determiners
            and self._may_be_meant(words[place - 1], words[place])
        }
        things = named.difference(words[slice(*span)])
        is_known = all(self.known.lexicon.is_name(word, _THINGS) for word in things)
        is_past = any("tense=past" in each.signs for each in pieces)
        return things.pop() if is_known and len(things) == 1 and not is_past else None

    def _may_be_meant(self, before: str, word: str) -> bool:
        """Whether a pronoun may stand for a word after a determiner, if after "'s" for a name."""
        if before == "'s":
            return self.known.lexicon.is_name(word, _THINGS)
        return self.known.may_be_a_thing(word)


def kinds_of_core(meaning: Meaning) -> frozenset[str]:
    """Return the kinds of a meaning, none for one that nothing but markers may surround."""
    match meaning:
        case Command() | ToolCommand():
            return frozenset({REQUEST})
        case Question():
            return frozenset({QUESTION})
        case Statement(rules):
            return frozenset(HOLDING if isinstance(rule, ActionRule) else USE for rule in rules)
        case _:
            return frozenset()


def _announces(piece: UtterancePiece) -> bool:
    """Whether a piece announces what follows: "I tell you"."""
    unsure = _UNREAL | _CONDITIONAL | {"degree"}
    return "announced" in piece.signs and piece.signs.isdisjoint(unsure)


def _permitted(piece: UtterancePiece, pause: int) -> frozenset[str]:
    """The kinds of cores beside which a piece changes nothing."""
    return frozenset(k for k in _KINDS if any(row.allows(k, piece, pause) for row in TABLE))


def _sentences(tokens: Tokens, end: int, pieces: Sequence[UtterancePiece]) -> Iterator[Tokens]:
    """The parts before a place, split at strong pauses."""
    start = 0
    for last, piece in pairwise(pieces):
        if piece.start <= end and piece.pause != WEAK:
            yield tokens.part(start, last.end)
            start = piece.start
