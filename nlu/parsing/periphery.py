# SPDX-License-Identifier: Apache-2.0
"""Periphery: what surrounds the core of an utterance, by its form, its pause and its operators.

"My hands are wet. Pass me the mug" has a core, a request, and before it a clause behind a strong
pause. `TABLE` says beside which kinds of core a piece of periphery may stand without a question.
What no row allows is asked about, or refused. The words are data (`periphery.yaml`).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

from ...ontology.yaml_reader import read_yaml
from ..grammar.word_patterns import Steps, match_pattern, read_pattern, spellings
from ..lexicon.discourse_markers import DiscourseMarkers
from ..lexicon.tokenizer import BREAK, Tokens
from ..lexicon.unknown_words import KnownWords
from ..semantics.clause_features import MAIN, ClausePosition, FeatureReader
from ..semantics.meaning import ActionRule, Command, Meaning, Question, Statement, ToolCommand

Phrase = tuple[str, ...]

REQUEST, QUESTION, HOLDING, USE = "request", "question", "holding", "use"
"""The kinds of cores: a command and a question to the robot, and the rules of two kinds."""

MARKER, REASON, PURPOSE, ASIDE = "marker", "reason", "purpose", "aside"
OWN, HEARER, IMPERSONAL, OTHER = "own", "hearer", "impersonal", "other"
PHRASE, PROPERTY = "phrase", "property"
"""The forms of periphery; a clause goes by its subject, and with another one it is `OTHER`.

A phrase has no verb of its own, so it belongs to the core: "by the handle", "with two hands".
"""

INSIDE = -1
WEAK, ASKING, COLON, BUT, SO, STRONG, AFTER, WITHIN = range(8)
"""How a piece is set off: the strongest pause between it and the core, or its other place.

`ASKING` is a weak pause before a question, whose beginning is as clear as after a strong one.
"""

LEAST_WORDS = 3
"""The least length of a core [words]."""

MAX_CORES = 8
"""How many cores of one utterance are parsed."""

_ANYWHERE = frozenset({WEAK, ASKING, COLON, BUT, SO, STRONG, AFTER})
_BEFORE = frozenset({COLON, BUT, SO, STRONG})
_LEADS: Mapping[str, int] = {"so": SO, "but": BUT, "and": WEAK}
_FORMS = (REASON, PURPOSE, ASIDE, OWN, HEARER, IMPERSONAL)
_LISTS = (
    "unwanted",
    "finite",
    "restricting",
    "auxiliary",
    "speaker",
    "speech",
    "knowledge",
    "unreal",
    "person",
    "listener",
)
_DASHES = ":–—"
_QUOTED = re.compile(r"[\"“”„«»]|(?<!\w)'\w[^']*'(?!\w)")
_WANTING = frozenset({"want", "need", "prefer", "like", "wanted"})
_THINGS, _PEOPLE = ("N", "MS"), ("RN", "HN")
_PLACED_NAMES = ("object", "part", "affordance", "context")

# With these a piece makes the core somebody else's word or a pretence, or it is not sure to do so.
_PRETENDED = frozenset(
    {
        *("report", "unreal", "quoted", "called", "doubtful", "source=hearsay", "source=other"),
        *("attitude=hypothetical", "attitude=doubt", "belief=denied"),
    }
)
# The same, and what asks for something else or only under a condition.
_REPORTED = _PRETENDED | {
    *("knowledge", "act", "condition", "exception", "condition=absent", "held", "unwanted")
}
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


class PieceBoundary(NamedTuple):
    """Where a piece ends and the next one begins, and the pause between them."""

    end: int
    start: int
    pause: int


@dataclass(frozen=True)
class UtterancePiece:
    """A piece of an utterance from pause to pause: its tokens `[start, end)`, form and operators.

    Attributes:
        lead: how many words of it only join it to what precedes: "so", "but".
        joined: the pause that these words amount to.
    """

    start: int
    end: int
    lead: int
    joined: int
    form: str
    signs: frozenset[str]

    @property
    def is_announcement(self) -> bool:
        """Whether its speaker announces something: "I tell you"."""
        return self.form in _PERSONS and "announced" in self.signs


@dataclass(frozen=True)
class PeripheryRow:
    """A row of the table: beside which cores a piece of some form, so set off, changes nothing.

    Attributes:
        unless: the operators with which it does.
    """

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
    # What is asked for at the end is wanted, whatever made the speaker ask.
    PeripheryRow(_REQUESTS, _CLAUSES, _BEFORE - {COLON}, _REPORTED),
    PeripheryRow(_REQUESTS, _CLAUSES, frozenset({COLON}), _REPORTED | {"pointing"}),
    PeripheryRow(_REQUESTS, frozenset({OWN, IMPERSONAL, OTHER}), frozenset({ASKING}), _NAMING),
    PeripheryRow(_REQUESTS, frozenset({HEARER}), frozenset({SO}), _REPORTED),
    PeripheryRow(_REQUESTS, _CAUSES, _ANYWHERE, _REPORTED),
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
    PeripheryRow(_RULES, frozenset({OWN}), frozenset({STRONG, BUT}), _LIMITING),
    PeripheryRow(_RULES, frozenset({HEARER}), frozenset({BUT}), _LIMITING),
    # What is said of the thing by the way says nothing of its use.
    PeripheryRow(_KINDS, _CAUSES | {ASIDE, OWN}, frozenset({WITHIN}), _LIMITING_ASIDE),
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


@dataclass(frozen=True)
class PeripheryWords:
    """The words of `periphery.yaml`.

    Attributes:
        patterns: how the pieces of each form begin, and what only joins a piece, by key.
        lists: single words and phrases by key.
    """

    patterns: Mapping[str, tuple[Steps, ...]]
    lists: Mapping[str, frozenset[Phrase]]

    def begins(self, key: str, words: Phrase) -> int:
        """The length of the longest beginning of some words that a key has, 0 without one."""
        ends = (end for steps in self.patterns[key] for _, end in match_pattern(steps, words, 0))
        return max(ends, default=0)


@dataclass(frozen=True, repr=False)
class PeripheryReader:
    """Finds the cores of utterances.

    Attributes:
        operators: the words on which a meaning may depend, by kind.
        degrees: the words for degrees of confidence.
    """

    words: PeripheryWords
    operators: Mapping[str, frozenset[Phrase]]
    degrees: frozenset[Phrase]
    features: FeatureReader
    markers: DiscourseMarkers
    known: KnownWords

    def property_clause(self, tokens: Tokens) -> tuple[int, int]:
        """The place of what follows "because it is" up to the next pause; (0, 0) without one."""
        words = tokens.words
        breaks = (place for place, word in enumerate(words) if word == BREAK)
        ends = sorted({*tokens.pauses, *breaks, len(words)})
        for start in range(len(words)):
            length = self.words.begins(PROPERTY, words[start:])
            if length:
                return start + length, next(end for end in ends if end >= start + length)
        return 0, 0

    def cores(self, tokens: Tokens, expanded: Tokens) -> Iterator[Core]:
        """Yield the cores to try, the longest first.

        Args:
            tokens: the utterance.
            expanded: the same with its short forms written out, word by word.
        """
        gaps = list(self._gaps(expanded))
        pieces = list(self._pieces(expanded, gaps))
        starts = {piece.start + piece.lead for piece in pieces} | {0}
        spans = ((start, piece.end) for start in starts for piece in pieces)
        long_enough = [s for s in spans if s[1] - s[0] >= LEAST_WORDS]
        for start, end in sorted(long_enough, key=lambda span: (span[0] - span[1], span)):
            core = self._core(tokens, (start, end), pieces, gaps)
            if core is not None:
                yield core

    def around(
        self, expanded: Tokens, span: tuple[int, int]
    ) -> tuple[list[UtterancePiece], list[UtterancePiece], int]:
        """Return the pieces before and after a span, and the pause or word that sets it off.

        That is `INSIDE` for a span within a clause.
        """
        start, end = span
        before, after = expanded.part(0, start), expanded.part(end, len(expanded.items))
        pieces = [list(self._pieces(each, list(self._gaps(each)))) for each in (before, after)]
        pauses = (gap.pause for gap in self._gaps(expanded) if gap.end <= start <= gap.start)
        beginning = [p.joined for p in pieces[0][-1:] if p.form == MARKER]
        words = expanded.words[start:]
        leads = (joined for lead, joined in _LEADS.items() if self.words.begins(lead, words))
        return pieces[0], pieces[1], max((*pauses, *beginning, *leads), default=INSIDE)

    def _core(
        self,
        tokens: Tokens,
        span: tuple[int, int],
        pieces: Sequence[UtterancePiece],
        gaps: Sequence[PieceBoundary],
    ) -> Core | None:
        start, end = span
        around = [each for each in pieces if each.end <= start or each.start >= end]
        within = [each for each in pieces if start < each.start and each.end < end]
        asides = [each for each in within if _permitted(each, WITHIN)]
        if not around and not asides:
            return None
        joined = max((p.joined for p in pieces if p.lead and p.start + p.lead == start), default=0)
        if any(each.is_announcement and each.end <= start for each in around):
            joined = max(joined, STRONG)
        elif tokens.asks and end == len(tokens.items):
            joined = max(joined, ASKING)
        placed = [(each, _pause(each, start, gaps, joined)) for each in around]
        kinds = _KINDS.intersection(
            *(_permitted(*each) for each in placed), *(_permitted(each, WITHIN) for each in asides)
        )
        if not kinds:
            return None
        said = [each for each in (*around, *asides) if each.form != MARKER]
        phrases = tuple(tokens.words[each.start : each.end] for each in said)
        limiting = tuple(
            phrase for each, phrase in zip(said, phrases, strict=True) if each.form not in _CAUSES
        )
        left_out = {place for each in asides for place in range(each.start, each.end)}
        kept = [place for place in range(start, end) if place not in left_out]
        return Core(
            replace(tokens.part(0, end).only(kept), removed=(*tokens.removed, *limiting)),
            kinds,
            tuple(_sentences(tokens, start, gaps)),
            any(self.known.may_be_a_thing(word) for phrase in phrases for word in phrase),
            self._referent(said, tokens, (start, end)),
            any((word,) in self.words.lists["person"] for word in tokens.words[start:end]),
        )

    def _referent(
        self, pieces: Sequence[UtterancePiece], tokens: Tokens, span: tuple[int, int]
    ) -> str | None:
        """The only thing that some pieces name and a core does not, None unless it is known."""
        words = tokens.words
        named = {
            words[place]
            for each in pieces
            for place in range(each.start + 1, each.end)
            if words[place - 1] in self.features.determiners
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

    def _gaps(self, tokens: Tokens) -> Iterator[PieceBoundary]:
        """The gaps between the pieces of an utterance, from left to right."""
        words = tokens.words
        for place, word in enumerate(words):
            if word == BREAK:
                yield PieceBoundary(place, place + 1, STRONG)
            elif place in tokens.pauses and place and words[place - 1] != BREAK:
                between = tokens.text[tokens.items[place - 1].end : tokens.items[place].start]
                yield PieceBoundary(place, place, COLON if set(_DASHES) & set(between) else WEAK)
            elif self._may_join(tokens, place):
                yield PieceBoundary(place, place, WEAK)

    def _may_join(self, tokens: Tokens, place: int) -> bool:
        """Whether a clause may begin without a pause: "I am tired so pass me the mug"."""
        is_within = place > 0 and tokens.words[place - 1] != BREAK
        is_lead = is_within and self.words.begins("so", tokens.words[place : place + 1]) > 0
        return is_lead and not _ends_soon(tokens, place + 1)

    def _pieces(self, tokens: Tokens, gaps: Sequence[PieceBoundary]) -> Iterator[UtterancePiece]:
        starts = (0, *(gap.start for gap in gaps))
        ends = (*(gap.end for gap in gaps), len(tokens.items))
        for start, end in zip(starts, ends, strict=True):
            if start < end:
                yield self._piece(tokens, start, end)

    def _piece(self, tokens: Tokens, start: int, end: int) -> UtterancePiece:
        part = tokens.part(start, end)
        lead, joined = max((self.words.begins(k, part.words), p) for k, p in _LEADS.items())
        joined = joined if lead else WEAK
        bare = self.markers.remove_markers(part).words
        form = MARKER if not bare else self._form(part.words, bare)
        if form == OTHER and len(bare) > 1 and not self._has_verb(bare):
            form = PHRASE
        said = tokens.part(start + lead, end)
        signs = frozenset() if form == MARKER else frozenset(self._signs(said, form))
        return UtterancePiece(start, end, lead, joined, form, signs)

    def _form(self, words: Phrase, bare: Phrase) -> str:
        lead = self.words.begins("and", bare)
        found = (
            form
            for form in _FORMS
            if self.words.begins(form, words) or self.words.begins(form, bare[lead:])
        )
        return next(found, OTHER)

    def _has_verb(self, words: Phrase) -> bool:
        """Whether a piece may be a clause: it has a finite verb, or a form of a verb inside.

        Behind a word that restricts, as "with" in "with two hands", such a form is a plural.
        """
        if any((word,) in self.words.lists["finite"] for word in words):
            return True
        is_restricting = words[:1] in self.words.lists["restricting"]
        return (self._is_act(words[0]) and not is_restricting) or any(
            self._may_be_verb(one, two)
            for one, two in pairwise(words)
            if not is_restricting or self._is_subject(one)
        )

    def _is_subject(self, word: str) -> bool:
        is_pronoun = any(self.words.begins(form, (word,)) for form in (OWN, HEARER, IMPERSONAL))
        return is_pronoun or (word,) in self.words.lists["person"]

    def _may_be_verb(self, before: str, word: str) -> bool:
        """Whether a word after another one looks like a verb with a subject before it."""
        if before in self.features.determiners:
            return False
        is_inflected = word.endswith(("s", "ed")) and not word.endswith("ss")
        return is_inflected or not (self.known.has(word) or self.features.is_noun(word))

    def _signs(self, tokens: Tokens, form: str) -> Iterator[str]:
        words = tokens.words
        features = self.features.features([ClausePosition(word, MAIN) for word in words], ())
        found = {f"{name}={value}" for name, said in features.main.items() for value in said}
        yield from found
        lead = self.words.begins(form, words) if form in _FORMS else 0
        yield from self._circumstances(words[lead:])
        others = {"agent=they", "agent=people", "agent=somebody"}
        if "tense=past" in found and ("that" in words or not others.isdisjoint(found)):
            yield "custom"
        for place, word in enumerate(words):
            for phrase, kind in self._operators.get(word, ()):
                if words[place : place + len(phrase)] == phrase:
                    yield kind
        yield from self._speech(words, form)
        if _QUOTED.search(tokens.text):
            yield "quoted"
        if self._calls(tokens):
            yield "called"
        if form == IMPERSONAL and words[-1] in _WANTING:
            yield "held"
        if words and self.words.begins(IMPERSONAL, words[-1:]):
            yield "pointing"
        if any(map(self._is_name, words)):
            yield "named"
        if words and self._is_act(words[0]):
            yield "act"

    def _circumstances(self, words: Phrase) -> Iterator[str]:
        """By what and when something is done: "by the rim", "in winter"."""
        if words[:1] in self.words.lists["restricting"]:
            yield "restricting"
        for one, two in pairwise(words):
            if one in self.features.holding_words and two in self.features.determiners | {"its"}:
                yield "held"
            if (one,) in self.words.lists["restricting"] and self.features.is_abstract(two):
                yield "circumstance"

    @cached_property
    def _operators(self) -> Mapping[str, Sequence[tuple[Phrase, str]]]:
        """The phrases on which a meaning may depend, with their kinds, by their first word."""
        found: dict[str, list[tuple[Phrase, str]]] = {}
        unreal = {
            **{key: self.words.lists[key] for key in ("unreal", "unwanted")},
            "degree": self.degrees,
        }
        for kind, phrases in {**self.operators, **unreal}.items():
            for phrase in phrases:
                found.setdefault(phrase[0], []).append((phrase, kind))
        return found

    def _speech(self, words: Phrase, form: str) -> Iterator[str]:
        """Whether somebody else says, knows or thinks something in a piece, or its speaker says it.

        "In case nobody has told you" reports nothing, nor does who asks for a thing.
        """
        for place, word in enumerate(words):
            is_said = (word,) in self.words.lists["speech"]
            is_known = (word,) in self.words.lists["knowledge"]
            if word.startswith("ask") and words[place + 1 : place + 2] == ("for",):
                continue
            if not is_said and not is_known and word not in self.features.embedding:
                continue
            if is_said and words[place + 1 : place + 2] in self.words.lists["listener"]:
                yield "report"
            elif self._is_own(words, place, or_of_hearer=not is_said):
                if is_said or is_known:
                    yield "announced"
            elif form != PURPOSE:
                yield "report" if is_said else "knowledge"

    def _is_own(self, words: Phrase, place: int, *, or_of_hearer: bool) -> bool:
        """Whether a verb has the speaker, or also the hearer, as subject, or is an imperative."""
        first = place
        while first and (words[first - 1],) in self.words.lists["auxiliary"]:
            first -= 1
        if not first:
            return not words[place].endswith(("s", "d"))
        is_joined = any(self.words.begins(key, words[first - 1 : first]) for key in _LEADS)
        subject = words[0] if is_joined else words[first - 1]
        is_hearer = bool(self.words.begins(HEARER, (subject,)))
        return (subject,) in self.words.lists["speaker"] or (or_of_hearer and is_hearer)

    def _calls(self, tokens: Tokens) -> bool:
        """Whether a piece may only call somebody: by one word, or by a name."""
        is_name = any(map(self._is_person, tokens.words)) or any(
            t.capital for t in tokens.items[1:]
        )
        return len(tokens.words) == 1 or (len(tokens.words) < LEAST_WORDS and is_name)

    def _is_person(self, word: str) -> bool:
        return self.known.lexicon.is_name(word, _PEOPLE)

    def _is_name(self, word: str) -> bool:
        return any(self.known.names(word, role) for role in _PLACED_NAMES)

    def _is_act(self, word: str) -> bool:
        return self.known.names(word, "context")


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


@lru_cache(maxsize=4)
def load_periphery(path: Path) -> PeripheryWords:
    """Return the words of a file; `DataError` says where it is not as expected."""
    begins = (*_LEADS, *_FORMS, PROPERTY)
    parts = read_yaml(path).entries(required=(*begins, *_LISTS), optional=())
    patterns = {key: tuple(map(read_pattern, parts[key].items())) for key in begins}
    lists = {
        key: frozenset(words for item in parts[key].items() for words in spellings(item))
        for key in _LISTS
    }
    return PeripheryWords(patterns, lists)


def _permitted(piece: UtterancePiece, pause: int) -> frozenset[str]:
    """The kinds of cores beside which a piece changes nothing."""
    return frozenset(k for k in _KINDS if any(row.allows(k, piece, pause) for row in TABLE))


def _pause(piece: UtterancePiece, start: int, gaps: Sequence[PieceBoundary], joined: int) -> int:
    """How a piece around a core that begins at a place, so joined to it, is set off."""
    if piece.end > start:
        return AFTER
    return max(joined, *(gap.pause for gap in gaps if piece.end <= gap.end <= start))


def _ends_soon(tokens: Tokens, start: int) -> bool:
    """Whether too few words for a core stand between a place and the next pause."""
    near = range(start, start + LEAST_WORDS)
    return any(
        n >= len(tokens.items) or n in tokens.pauses or tokens.words[n] == BREAK for n in near
    )


def _sentences(tokens: Tokens, end: int, gaps: Sequence[PieceBoundary]) -> Iterator[Tokens]:
    """The parts before a place, split at strong pauses."""
    start = 0
    for gap in gaps:
        if gap.end <= end and gap.pause != WEAK and start < gap.end:
            yield tokens.part(start, gap.end)
            start = gap.start
