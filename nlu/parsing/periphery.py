"""Periphery: what surrounds the core of an utterance, by its form, its pause and its operators.

"My hands are wet, so pass me the mug" has two pieces from pause to pause. The second is its core, a
request, which a lead joins to what precedes it. A piece goes by how it begins, by its subject, or
by what it announces; its signs are the features of its words and all else on which a meaning may
depend. One table (`periphery.yaml`) says beside which kinds of core a piece of periphery may stand
without a question. What no row allows is asked about, or refused.
"""

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from enum import IntEnum, auto
from functools import cached_property, lru_cache
from itertools import chain, pairwise
from pathlib import Path

from ...ontology.yaml_reader import YamlNode, read_yaml
from ..grammar.word_patterns import Phrase, WordLists
from ..lexicon.tokenizer import BREAK, Tokens
from ..lexicon.unknown_words import KnownWords
from ..semantics import meaning as meanings
from ..semantics.clause_features import MAIN, FeatureReader
from ..semantics.meaning import AskBack, Command, Meaning, NormStatement, Question, Statement

PERIPHERY_FILE = Path(__file__).parents[2] / "ontology" / "periphery.yaml"

LEAST_WORDS = 3  # the least length of a core [words]
MAX_CORES = 8  # how many cores of one utterance are parsed

REQUEST, QUESTION, HOLDING, USE = "request", "question", "holding", "use"
"""The kinds of cores: a command and a question to the robot, and the rules of two kinds."""

MARKER, REASON, PURPOSE, ASIDE = "marker", "reason", "purpose", "aside"
OWN, HEARER, IMPERSONAL, OTHER = "own", "hearer", "impersonal", "other"
PHRASE, PROPERTY = "phrase", "property"
"""The forms of pieces; a clause goes by its subject, and with another one it is `OTHER`.

A phrase has no verb of its own, so it belongs to the core: "by the handle", "with two hands".
"""


class Pause(IntEnum):
    """How a piece is set off: the strongest pause between it and the core, or its other place."""

    WEAK = auto()
    ASKING = auto()  # a weak one before a question, which begins as clearly as after a strong one
    COLON = auto()
    BUT = auto()
    SO = auto()
    STRONG = auto()
    AFTER = auto()
    WITHIN = auto()
    TOLD = auto()  # of a piece that ends in an announcement, or precedes one


FORMS = (REASON, PURPOSE, ASIDE, OWN, HEARER, IMPERSONAL)
_LEADS: Mapping[str, Pause] = {"so": Pause.SO, "but": Pause.BUT, "and": Pause.WEAK}
_DASHES = frozenset(":–—")
_QUOTED = re.compile(r"[\"“”„«»]|(?<!\w)'\w[^']*'(?!\w)")
_PEOPLE, _THINGS = ("RN", "HN"), ("N", "MS")
_KINDS = frozenset({REQUEST, QUESTION, HOLDING, USE})
_TELLING = frozenset({Pause.BUT, Pause.SO, Pause.TOLD})
_PLACED_NAMES = ("object", "part", "affordance", "context")
_DENIED = frozenset({"polarity=negative", "belief=denied", "implied_negation", "unreal"})
_OLD = frozenset({"agent=they", "agent=people", "agent=somebody", "agent=speaker"})


@dataclass(frozen=True)
class UtterancePiece:
    """A piece of an utterance from pause to pause: tokens `[start, end)`, form and operators."""

    start: int
    end: int
    pause: Pause  # the pause before it
    lead: int  # how many words of it only join it to what precedes: "so", "but"
    joined: Pause  # the pause that these words amount to
    form: str
    signs: frozenset[str]

    @property
    def core_start(self) -> int:
        """Where a core begins that begins with this piece."""
        return self.start + self.lead


@dataclass(frozen=True, repr=False)
class PieceReader:
    """Splits utterances into pieces.

    `operators` are the words on which a meaning may depend, by kind.
    """

    words: WordLists
    operators: Mapping[str, frozenset[Phrase]]
    features: FeatureReader
    known: KnownWords

    def property_clause(self, tokens: Tokens) -> tuple[int, int]:
        """Return the place of what follows "because it is" up to the next pause, or (0, 0)."""
        for start in range(len(tokens.words)):
            place = self.words.end(PROPERTY, tokens.words, start)
            if place > start:
                return place, min(end for end in tokens.edges if end >= place)
        return 0, 0

    def pieces(self, tokens: Tokens) -> list[UtterancePiece]:
        """Return the pieces of an utterance, whose short forms are written out, in order."""
        found: list[UtterancePiece] = []
        start, last, pause = 0, len(tokens.items), Pause.WEAK
        for end, after, next_pause in (*self._gaps(tokens), (last, last, Pause.WEAK)):
            if next_pause == Pause.TOLD and not self._announces(tokens, start, end):
                continue
            if start < end:
                found.append(self._piece(tokens, start, end, pause))
                pause = Pause.WEAK
            start, pause = after, max(pause, next_pause)
        return found

    def joined(self, words: Phrase) -> list[Pause]:
        """The pauses that the words amount to with which some words begin: "so", "but"."""
        return [pause for lead, pause in _LEADS.items() if self.words.end(lead, words)]

    def _gaps(self, tokens: Tokens) -> Iterator[tuple[int, int, Pause]]:
        words = tokens.words
        ends = {len(words), *tokens.pauses, *(n for n, word in enumerate(words) if word == BREAK)}
        for place, word in enumerate(words):
            if word == BREAK:
                yield place, place + 1, Pause.STRONG
            elif place in tokens.pauses and place and words[place - 1] != BREAK:
                between = tokens.text[tokens.items[place - 1].end : tokens.items[place].start]
                yield place, place, Pause.WEAK if _DASHES.isdisjoint(between) else Pause.COLON
            elif ends.intersection(range(place + 1, place + 1 + LEAST_WORDS)):
                continue
            elif (
                place
                and (self.words.end("so", (word,)) or self.words.has("because", word))
                and words[place - 1] != BREAK
                and not self.words.has("speech", words[place - 1])
            ):
                yield place, place, Pause.WEAK
            elif self.words.has("complement", word):
                yield place, place + 1, Pause.TOLD

    def _announces(self, tokens: Tokens, start: int, end: int) -> bool:
        words = tokens.words[start:end]
        if not words or any(self.words.has("thinking", word) for word in words[-LEAST_WORDS:]):
            return False
        signs = self._piece(tokens, start, end, Pause.WEAK).signs
        return "announced" in signs and signs.isdisjoint(_DENIED)

    def _piece(self, tokens: Tokens, start: int, end: int, pause: Pause) -> UtterancePiece:
        part = tokens.part(start, end)
        lead, joined = max((self.words.end(k, part.words), p) for k, p in _LEADS.items())
        joined = joined if lead else Pause.WEAK
        bare = self.known.builder.discourse_markers.remove_markers(part).words
        form = MARKER if not bare else self._form(part.words, bare)
        if form == OTHER and len(bare) > 1 and not self._has_verb(bare):
            form = PHRASE
        said = tokens.part(start + lead, end)
        signs = frozenset() if form == MARKER else frozenset(self._signs(said, form))
        return UtterancePiece(start, end, pause, lead, joined, form, signs)

    def _form(self, words: Phrase, bare: Phrase) -> str:
        said = (words, bare[self.words.end("and", bare) :])
        found = (form for form in FORMS if any(self.words.end(form, each) for each in said))
        return next(found, OTHER)

    def _has_verb(self, words: Phrase) -> bool:
        has_subject = any(self._is_subject(word, OWN, HEARER) for word in words[:-1])
        is_finite = any(self.words.has(key, word) for word in words for key in ("finite", "speech"))
        if has_subject or is_finite:
            return True
        if not self.words.has("restricting", words[0]):
            is_act = self.known.names(words[0], "context")
            return is_act or any(self._may_be_verb(*pair) for pair in pairwise(words))
        return any(
            (self._is_subject(one, OWN, HEARER, IMPERSONAL) or self.words.has("person", one))
            and self._may_be_verb(one, two)
            for one, two in pairwise(words)
        )

    def _is_subject(self, word: str, *forms: str) -> bool:
        return any(self.words.end(form, (word,)) for form in forms)

    def _may_be_verb(self, before: str, word: str) -> bool:
        if before in self.features.words["determiners"]:
            return False
        is_inflected = word.endswith(("s", "ed")) and not word.endswith("ss")
        return is_inflected or not (self.known.has(word) or self.features.is_noun(word))

    def _signs(self, tokens: Tokens, form: str) -> Iterator[str]:
        words = tokens.words
        starts = (n for n in range(len(words)) if not n or self.joined(words[n - 1 : n]))
        if any(self.words.is_all("presenting", words, n) for n in starts):
            yield "announced"
        if self.words.is_all("presenting", words):
            return
        features = self.features.features([(word, MAIN) for word in words], ())
        found = {f"{name}={value}" for name, said in features.main.items() for value in said}
        is_past = "tense=past" in found
        yield from found
        lead = self.words.end(form, words) if form in FORMS else 0
        yield from self._circumstances(words[lead:])
        has_complement = any(self.words.has("complement", word) for word in words)
        if is_past and (has_complement or not _OLD.isdisjoint(found)):
            yield "custom"
        is_memory = is_past and self.words.end("temporal", words) > 0
        yield from (k for k in self._dependence(words) if k != "condition" or not is_memory)
        yield from self._speech(words, form)
        named = (self.known.names(word, role) for word in words for role in _PLACED_NAMES)
        is_name = any(self.known.lexicon.is_name(word, _PEOPLE) for word in words)
        is_name = is_name or any(token.capital for token in tokens.items[1:])
        shown = {
            "quoted": _QUOTED.search(tokens.text),
            "called": len(words) == 1 or (len(words) < LEAST_WORDS and is_name),
            "held": form == IMPERSONAL and self.words.has("wanting", *words[-1:]),
            "pointing": words and self.words.end(IMPERSONAL, words[-1:]),
            "short": len(words) < LEAST_WORDS,
            "named": any(named),
            "act": words and self.known.names(words[0], "context"),
        }
        yield from (sign for sign, is_shown in shown.items() if is_shown)

    def _dependence(self, words: Phrase) -> Iterator[str]:
        for place, word in enumerate(words):
            for phrase, kind in self._operators.get(word, ()):
                end = place + len(phrase)
                is_said = words[place:end] == phrase
                # At the end they are adverbs: "before", "otherwise".
                if is_said and not (end == len(words) and kind in {"condition", "exception"}):
                    yield kind

    def _circumstances(self, words: Phrase) -> Iterator[str]:
        if self.words.has("restricting", *words[:1]):
            yield "restricting"
        for one, two in pairwise(words):
            is_owned = two in self.features.words["determiners"]
            is_owned = is_owned or self.words.has("possessive", two)
            if one in self.features.words["holding_words"] and is_owned:
                yield "held"
            if self.words.has("restricting", one) and self.features.is_abstract(two):
                yield "circumstance"

    @cached_property
    def _operators(self) -> Mapping[str, Sequence[tuple[Phrase, str]]]:
        found: dict[str, list[tuple[Phrase, str]]] = {}
        others = {key: self.words.phrases(key) for key in ("unreal", "unwanted")}
        others["degree"] = frozenset(self.known.builder.degree_of)
        for kind, phrases in {**self.operators, **others}.items():
            for phrase in phrases:
                found.setdefault(phrase[0], []).append((phrase, kind))
        return found

    def _speech(self, words: Phrase, form: str) -> Iterator[str]:
        for place, word in enumerate(words):
            is_said, is_known = (self.words.has(key, word) for key in ("speech", "knowledge"))
            is_any = is_said or is_known or word in self.features.words["embedding"]
            if not is_any or self.words.has("asking", *words[place : place + 2]):
                continue
            if is_said and self.words.has("listener", *words[place + 1 : place + 2]):
                yield "report"
            elif self._is_own(words, place, or_of_hearer=not is_said):
                if is_said or is_known:
                    yield "announced"
            elif form != PURPOSE:
                yield "report" if is_said else "knowledge"

    def _is_own(self, words: Phrase, place: int, *, or_of_hearer: bool) -> bool:
        first = place
        while first and self.words.has("auxiliary", words[first - 1]):
            first -= 1
        if not first:
            return place > 0 or (or_of_hearer and not words[place].endswith(("s", "d")))
        is_first = first == 2 and self.words.end(OWN, words[:1]) > 0
        is_joined = is_first or bool(self.joined(words[first - 1 : first]))
        subject = words[0] if is_joined else words[first - 1]
        is_let = self.words.has("auxiliary", *words[first - 2 : first - 1])
        if self.words.end(OWN, (subject,)) or (is_let and self.words.has("speaker", subject)):
            return True
        is_hearer = self.words.has("generic", words[0]) or self.words.end(HEARER, (subject,)) > 0
        return or_of_hearer and is_hearer


@dataclass(frozen=True)
class PeripheryRow:
    """A row: beside which cores a piece of some form, so set off, changes nothing, and unless."""

    of: frozenset[str]
    forms: frozenset[str]
    pauses: frozenset[Pause]
    unless: frozenset[str]


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
        asked = {QUESTION} if tokens.asks and end < len(tokens.items) else _KINDS
        kinds = _KINDS.intersection(asked, *(self.table.permitted(*each) for each in placed))
        if not placed or not kinds:
            return None
        said = [(each, pause) for each, pause in placed if each.form != MARKER]
        phrases = [tokens.words[each.start : each.end] for each, _ in said if each.start < end]
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
            any(
                self.reader.known.may_be_a_thing(word) and not self.reader.words.has("speech", word)
                for word in chain.from_iterable(phrases)
            ),
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
        is_open = not {"something", "anything"}.isdisjoint(words)
        is_other = is_open or any(each.signs & {"tense=past", "agent=addressee"} for each in pieces)
        return things.pop() if is_known and len(things) == 1 and not is_other else None


def kinds_of_core(meaning: Meaning) -> frozenset[str]:
    """Return the kinds of a meaning, none for one that nothing but markers may surround."""
    match meaning:
        case Command() | meanings.ToolCommand():
            return frozenset({REQUEST})
        case Question():
            return frozenset({QUESTION})
        case NormStatement():
            return frozenset({HOLDING})
        case Statement(rules):
            return frozenset(
                HOLDING if isinstance(rule, meanings.ActionRule) else USE for rule in rules
            )
        case AskBack(choices=(Statement() | Command() as asked,)):
            return kinds_of_core(asked)
        case _:
            return frozenset()


def _sentences(tokens: Tokens, end: int, pieces: Sequence[UtterancePiece]) -> Iterator[Tokens]:
    start = 0
    for last, piece in pairwise(pieces):
        if piece.start <= end and piece.pause != Pause.WEAK:
            yield tokens.part(start, last.end)
            start = piece.start
