# SPDX-License-Identifier: Apache-2.0
"""The history: every utterance with its speaker, its time and the rules it changed.

Utterances are numbered from 1 as they arrive; inference notices new ones by that number. A rule
stays linked to the utterance that asserted it when it is later retracted or superseded, so the
rules of any earlier time can be found (`views`).
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from decimal import Decimal
from pathlib import PurePath
from typing import TypeVar, cast

from ..ontology.errors import ValidationError
from ..ontology.vocabulary import Iri, iri, shortened, split, term
from .rdf.rule_mapping import ATTRIBUTED_TO, GENERATED_AT, TYPE, rule_id, rule_iri
from .rdf.terms import Quad, Term, lexical
from .rule import MAX_NAME, check_speaker

T = TypeVar("T", int, str, bool, Iri, datetime, Decimal)

HISTORY = iri("graph", "history")
IMPORT = "import"  # the kind of an utterance that stands for an imported file
_NOT_IN_NAMES = re.compile(r"[^\w.@+-]+")
MAX_TEXT = 100_000  # characters of an utterance or its predicate that are kept

SEQUENCE, TEXT, PREDICATE, KIND = (term(n) for n in ("sequence", "text", "predicate", "kind"))
ACCEPTED, ANSWER, HEARD = (term(n) for n in ("accepted", "answer", "heard"))
ASSERTS, RETRACTS, SUPERSEDES = (term(n) for n in ("asserts", "retracts", "supersedes"))


@dataclass(frozen=True)
class Utterance:
    """One utterance of the history.

    Attributes:
        sequence: its number, from 1.
        text: as it was said.
        predicate: its meaning in predicate form; empty when it was not understood.
        speaker: who said it.
        time: when it was said, with a time zone.
        kind: statement, command, question, correction, ...
        accepted: whether it was believed or carried out.
        answer: the answer to it; empty when not known.
        asserts: ids of the rules it asserted.
        retracts: ids of the rules it retracted.
        supersedes: ids of the rules it superseded.
        heard: confidence of the speech recognition, in [0, 1]; 1 where it was typed.
    """

    sequence: int
    text: str
    predicate: str
    speaker: str
    time: datetime
    kind: str = "statement"
    accepted: bool = True
    answer: str = ""
    asserts: tuple[str, ...] = ()
    retracts: tuple[str, ...] = ()
    supersedes: tuple[str, ...] = ()
    heard: float = 1.0

    def __post_init__(self) -> None:
        check_speaker(self.speaker)
        for text in (self.text, self.predicate, self.kind, self.answer):
            _check_text(text)
        if self.time.tzinfo is None:
            raise ValidationError([f"The time {self.time} has no time zone."])

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt history --json`."""
        return {
            "sequence": self.sequence,
            "text": self.text,
            "predicate": self.predicate or None,
            "speaker": self.speaker,
            "time": lexical(self.time)[0],
            "kind": self.kind,
            "accepted": self.accepted,
            "answer": self.answer or None,
            "asserts": list(self.asserts),
            "retracts": list(self.retracts),
            "supersedes": list(self.supersedes),
            "heard": self.heard,
        }


def import_utterance(
    source: str, sequence: int, time: datetime, *, some: str = "", asserts: tuple[str, ...] = ()
) -> Utterance:
    """The utterance that stands for a file whose rules do not say where they come from.

    Args:
        source: the name of the file; "-" is standard input.
        sequence: the number of the utterance.
        time: when it was read.
        some: which of its rules, where it stands for only some of them.
        asserts: ids of the rules.
    """
    name = "standard input" if source == "-" else PurePath(source).name
    speaker = f"file {_NOT_IN_NAMES.sub(' ', name).strip()}"[:MAX_NAME].rstrip(" '@+-")
    return Utterance(
        sequence, f"import of {source}{some}", "", speaker, time, IMPORT, asserts=asserts
    )


def utterance_iri(sequence: int) -> Iri:
    """The node of an utterance."""
    return iri("utterance", str(sequence))


def utterance_quads(utterance: Utterance) -> Iterator[Quad]:
    """The statements about an utterance."""
    node = utterance_iri(utterance.sequence)
    for predicate, value in _properties(utterance):
        yield Quad(node, predicate, value, HISTORY)


def read_utterance(properties: Iterable[tuple[Iri, Term]]) -> Utterance:
    """The utterance with a node's properties, as `utterance_quads` writes them.

    Raises:
        ValidationError: something is missing or malformed.
    """
    found: dict[Iri, list[Term]] = defaultdict(list)
    for predicate, value in properties:
        found[predicate].append(value)
    asserts, retracts, supersedes = (
        tuple(sorted(rule_id(cast(Iri, node)) for node in found[link]))
        for link in (ASSERTS, RETRACTS, SUPERSEDES)
    )
    return Utterance(
        _one(found, SEQUENCE, int),
        _one(found, TEXT, str),
        _one(found, PREDICATE, str, ""),
        split(_one(found, ATTRIBUTED_TO, Iri))[1],
        _one(found, GENERATED_AT, datetime),
        _one(found, KIND, str),
        _one(found, ACCEPTED, bool),
        _one(found, ANSWER, str, ""),
        asserts,
        retracts,
        supersedes,
        heard=float(_one(found, HEARD, Decimal, Decimal(1))),
    )


def _one(found: dict[Iri, list[Term]], key: Iri, kind: type[T], default: T | None = None) -> T:
    values = found[key]
    if not values and default is not None:
        return default
    if len(values) != 1 or not isinstance(values[0], kind):
        raise ValidationError(
            [f"An utterance has {len(values)} {shortened(key)}; expected one {kind.__name__}."]
        )
    return values[0]


def _properties(utterance: Utterance) -> Iterator[tuple[Iri, Term]]:
    yield TYPE, term("Utterance")
    yield SEQUENCE, utterance.sequence
    yield TEXT, utterance.text
    if utterance.predicate:
        yield PREDICATE, utterance.predicate
    yield KIND, utterance.kind
    yield ACCEPTED, utterance.accepted
    if utterance.answer:
        yield ANSWER, utterance.answer
    if utterance.heard < 1.0:
        yield HEARD, Decimal(str(round(utterance.heard, 6)))
    yield ATTRIBUTED_TO, iri("speaker", utterance.speaker)
    yield GENERATED_AT, utterance.time
    for link, ids in (
        (ASSERTS, utterance.asserts),
        (RETRACTS, utterance.retracts),
        (SUPERSEDES, utterance.supersedes),
    ):
        for one in ids:
            yield link, rule_iri(one)


def _check_text(text: str) -> None:
    try:
        lexical(text)
    except ValueError as error:
        raise ValidationError([f"The text is no Unicode: {text[:60]!r}."]) from error
    if len(text) > MAX_TEXT:
        raise ValidationError(
            [f"The text has {len(text)} characters; at most {MAX_TEXT} are kept."]
        )
