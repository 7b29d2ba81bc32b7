"""Periphery: what surrounds the core of an utterance, by its form, its pause and its operators.

"My hands are wet. Pass me the mug" has a core, a request, and before it a clause behind a strong
pause. One table (`periphery.yaml`) says beside which kinds of core a piece of periphery may stand
without a question. What no row allows is asked about, or refused.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import chain, pairwise
from pathlib import Path

from ...ontology.yaml_reader import YamlNode, read_yaml
from ..lexicon.tokenizer import Tokens
from ..semantics.meaning import ActionRule, Command, Meaning, Question, Statement, ToolCommand
from .utterance_pieces import (
    FORMS,
    LEAST_WORDS,
    MARKER,
    OTHER,
    PHRASE,
    PURPOSE,
    REASON,
    Pause,
    PieceReader,
    UtterancePiece,
)

PERIPHERY_FILE = Path(__file__).parents[2] / "ontology" / "periphery.yaml"

REQUEST, QUESTION, HOLDING, USE = "request", "question", "holding", "use"
"""The kinds of cores: a command and a question to the robot, and the rules of two kinds."""

MAX_CORES = 8  # how many cores of one utterance are parsed


@dataclass(frozen=True)
class PeripheryRow:
    """A row: beside which cores a piece of some form, so set off, changes nothing, and unless."""

    of: frozenset[str]
    forms: frozenset[str]
    pauses: frozenset[Pause]
    unless: frozenset[str]


_KINDS = frozenset({REQUEST, QUESTION, HOLDING, USE})
_THINGS = ("N", "MS")
_TELLING = frozenset({Pause.BUT, Pause.SO, Pause.TOLD})


@dataclass(frozen=True)
class PeripheryTable:
    """The rows, and the sets of operators by which they and the segments of offers go."""

    rows: Sequence[PeripheryRow]
    signs: Mapping[str, frozenset[str]]

    def permitted(self, piece: UtterancePiece, pause: Pause) -> frozenset[str]:
        """Return the kinds of cores beside which a piece changes nothing."""
        rows = (row for row in self.rows if piece.form in row.forms and pause in row.pauses)
        allowed = (row.of for row in rows if row.unless.isdisjoint(piece.signs))
        return frozenset(chain.from_iterable(allowed))

    def announces(self, piece: UtterancePiece) -> bool:
        """Whether a piece announces what follows: "I tell you"."""
        return "announced" in piece.signs and piece.signs.isdisjoint(self.signs["uncertain"])


@lru_cache(maxsize=4)
def load_table(path: Path = PERIPHERY_FILE) -> PeripheryTable:
    """Return the table of a file; `DataError` says where it is not as expected."""
    parts = read_yaml(path).entries(required=("forms", "pauses", "signs", "rows"), optional=())
    forms, pauses, signs = (_sets(parts[key]) for key in ("forms", "pauses", "signs"))
    known = {*pauses, *(each.name.lower() for each in Pause)}
    rows: list[PeripheryRow] = []
    for item in parts["rows"].items():
        row = item.entries(required=("of", "forms", "pauses"), optional=("unless",))
        apart = _union(row["pauses"].texts(choices=known), pauses)
        rows.append(
            PeripheryRow(
                frozenset(row["of"].texts(choices=_KINDS)),
                _union(row["forms"].texts(choices={*forms, *FORMS, MARKER, OTHER, PHRASE}), forms),
                frozenset(Pause[each.upper()] for each in apart),
                _union(row["unless"].texts(), signs) if "unless" in row else frozenset(),
            )
        )
    return PeripheryTable(tuple(rows), signs)


def _sets(field: YamlNode) -> dict[str, frozenset[str]]:
    found: dict[str, frozenset[str]] = {}
    for name, items in field.entries().items():
        found[name] = _union(items.texts(), found)
    return found


def _union(names: Sequence[str], sets: Mapping[str, frozenset[str]]) -> frozenset[str]:
    added = (sets.get(name, {name}) for name in names if not name.startswith("-"))
    return frozenset(chain.from_iterable(added)) - {n[1:] for n in names if n.startswith("-")}


@dataclass(frozen=True)
class Core:
    """What an utterance may mean, without what surrounds it."""

    tokens: Tokens  # the core, with its periphery as removed phrases
    kinds: frozenset[str]  # the kinds of meaning that it may have there
    preamble: tuple[Tokens, ...]  # the sentences before it
    is_referring: bool  # whether the periphery may name what a pronoun of the core stands for
    referent: str | None  # the only known thing that it names and the core does not
    has_person: bool  # whether the core has a pronoun for somebody


@dataclass(frozen=True, repr=False)
class PeripheryReader:
    """Finds the cores of utterances."""

    reader: PieceReader
    table: PeripheryTable

    def cores(self, tokens: Tokens) -> Iterator[Core]:
        """Yield the cores to try, the longest first."""
        pieces = self.reader.pieces(self.reader.known.builder.expand_endings(tokens))
        starts = {piece.core_start for piece in pieces} | {0}
        spans = [(start, piece.end) for start in starts for piece in pieces]
        for start, end in sorted(spans, key=lambda span: (span[0] - span[1], span)):
            core = self._core(tokens, (start, end), pieces) if end - start >= LEAST_WORDS else None
            if core is not None:
                yield core

    def around(
        self, expanded: Tokens, span: tuple[int, int]
    ) -> tuple[list[UtterancePiece], list[UtterancePiece], Pause]:
        """Return the pieces before and after a span, and its pause, `INSIDE` within a clause.

        In `expanded` no word is a short form.
        """
        start, end = span
        sides = (expanded.part(0, start), expanded.part(end, len(expanded.items)))
        before, after = map(self.reader.pieces, sides)
        pauses = [each.pause for each in self.reader.pieces(expanded) if each.start == start]
        beginning = [each.joined for each in before[-1:] if each.form == MARKER]
        joined = self.reader.joined(expanded.words[start:])
        return before, after, max((*pauses, *beginning, *joined), default=Pause.INSIDE)

    def _core(
        self, tokens: Tokens, span: tuple[int, int], pieces: Sequence[UtterancePiece]
    ) -> Core | None:
        start, end = span
        inner = (each for each in pieces if start < each.start and each.end < end)
        within = [each for each in inner if self.table.permitted(each, Pause.WITHIN)]
        placed = [*self._before(tokens, span, pieces)]
        for each in (each for each in pieces if each.start >= end):
            is_told = self.table.announces(each) and "pointing" in each.signs
            placed.append((each, Pause.TOLD if is_told else Pause.AFTER))
        placed += [(each, Pause.WITHIN) for each in within]
        kinds = _KINDS.intersection(*(self.table.permitted(*each) for each in placed))
        if not placed or not kinds:
            return None
        said = [(each, pause) for each, pause in placed if each.form != MARKER]
        phrases = [tokens.words[each.start : each.end] for each, _ in said]
        limiting = (
            tokens.words[each.start : each.end]
            for each, pause in said
            if each.form not in {REASON, PURPOSE} and pause not in _TELLING
        )
        left_out = {place for each in within for place in range(each.start, each.end)}
        kept = [place for place in range(start, end) if place not in left_out]
        removed = (*tokens.removed, *limiting)
        return Core(
            replace(tokens.part(0, end).only(kept), removed=removed),
            kinds,
            tuple(_sentences(tokens, start, pieces)),
            any(self.reader.known.may_be_a_thing(word) for phrase in phrases for word in phrase),
            self._referent([each for each, _ in said], tokens, span),
            any(self.reader.words.has("person", word) for word in tokens.words[start:end]),
        )

    def _before(
        self, tokens: Tokens, span: tuple[int, int], pieces: Sequence[UtterancePiece]
    ) -> Iterator[tuple[UtterancePiece, Pause]]:
        start, end = span
        before = [each for each in pieces if each.end <= start]
        joined = max((p.joined for p in pieces if p.core_start == start), default=Pause.WEAK)
        if tokens.asks and end == len(tokens.items):
            joined = max(joined, Pause.ASKING)
        said = [each for each in before if each.form != MARKER]
        is_told = bool(said) and self.table.announces(said[-1])
        heard = [p for p in pieces if p.start <= start and p.pause != Pause.TOLD]
        for each in before:
            between = (p.pause for p in heard if each.end <= p.start)
            yield each, Pause.TOLD if is_told else max((joined, *between))

    def _referent(
        self, pieces: Sequence[UtterancePiece], tokens: Tokens, span: tuple[int, int]
    ) -> str | None:
        words, known = tokens.words, self.reader.known
        pairs = [pair for each in pieces for pair in pairwise(words[each.start : each.end])]
        named = {
            word
            for before, word in pairs
            if before in self.reader.features.words["determiners"]
            and (
                known.lexicon.is_name(word, _THINGS)
                if before == "'s"
                else known.may_be_a_thing(word)
            )
        }
        things = named.difference(words[slice(*span)])
        is_known = all(known.lexicon.is_name(word, _THINGS) for word in things)
        is_past = any("tense=past" in each.signs for each in pieces)
        return things.pop() if is_known and len(things) == 1 and not is_past else None


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


def _sentences(tokens: Tokens, end: int, pieces: Sequence[UtterancePiece]) -> Iterator[Tokens]:
    start = 0
    for last, piece in pairwise(pieces):
        if piece.start <= end and piece.pause != Pause.WEAK:
            yield tokens.part(start, last.end)
            start = piece.start
