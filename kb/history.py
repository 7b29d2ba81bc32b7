"""The history: every utterance with its speaker, its time and the rules it changed.

Utterances are numbered from 1 as they arrive; inference notices new ones by that number. A rule
stays linked to the utterance that asserted it when it is later retracted or superseded, so the
rules of any earlier time can be found (`views`).
"""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from datetime import datetime
from decimal import Decimal
from functools import partial
from pathlib import PurePath
from typing import Annotated

from ..ontology.errors import ValidationError
from ..ontology.vocabulary import Iri, external, iri, term
from .interval import Interval
from .rdf.record_mapping import REQUIRED, FieldProperty, RecordMapping, group_pairs, local_name
from .rdf.rule_mapping import ATTRIBUTED_TO, DERIVED, GENERATED_AT, TYPE, decimal, rule_id, rule_iri
from .rdf.terms import Quad, Term, lexical
from .rule import MAX_NAME, check_speaker

HISTORY = iri("graph", "history")
IMPORT = "import"  # the kind of an utterance that stands for an imported file
_NOT_IN_NAMES = re.compile(r"[^\w.@+-]+")
MAX_TEXT = 100_000  # characters of an utterance or its predicate that are kept

SEQUENCE, TEXT, PREDICATE, KIND = (term(n) for n in ("sequence", "text", "predicate", "kind"))
ACCEPTED, ANSWER, HEARD = (term(n) for n in ("accepted", "answer", "heard"))
TRUST = TRUST_LOWER, TRUST_UPPER = term("trustLower"), term("trustUpper")
_GENERATED_BY, _AGENT = external("prov:wasGeneratedBy"), external("prov:wasAssociatedWith")
_STARTED = external("prov:startedAtTime")
_TRUST = re.compile(r"trust\(([^,()]+),([0-9.e-]+),([0-9.e-]+)\)")  # as `set_trust` writes it
ASSERTS, RETRACTS, SUPERSEDES = (term(n) for n in ("asserts", "retracts", "supersedes"))
SPEAKER = FieldProperty(ATTRIBUTED_TO, Iri, partial(iri, "speaker"), local_name)


def rules_property(predicate: Iri) -> FieldProperty:
    """How ids of rules are stored."""
    return FieldProperty(predicate, Iri, rule_iri, rule_id, default=())


def utterance_property(predicate: Iri, default: object = REQUIRED) -> FieldProperty:
    """How the number of an utterance is stored."""
    return FieldProperty(predicate, Iri, utterance_iri, lambda node: int(local_name(node)), default)


@dataclass(frozen=True)
class Utterance:
    """One utterance of the history, with the text as its speaker said it."""

    sequence: Annotated[int, FieldProperty(SEQUENCE, int)]  #: its number, from 1
    text: Annotated[str, FieldProperty(TEXT, str)]
    #: its meaning in predicate form; empty when it was not understood
    predicate: Annotated[str, FieldProperty(PREDICATE, str, default="")]
    speaker: Annotated[str, SPEAKER]
    #: when it was said, with a time zone
    time: Annotated[datetime, FieldProperty(GENERATED_AT, datetime)]
    #: statement, command, question, correction, ...
    kind: Annotated[str, FieldProperty(KIND, str)] = "statement"
    #: whether it was believed or carried out
    accepted: Annotated[bool, FieldProperty(ACCEPTED, bool)] = True
    #: the answer to it; empty when not known
    answer: Annotated[str, FieldProperty(ANSWER, str, default="")] = ""
    #: asserts, retracts, supersedes: ids of the rules that it asserted, retracted, superseded
    asserts: Annotated[tuple[str, ...], rules_property(ASSERTS)] = ()
    retracts: Annotated[tuple[str, ...], rules_property(RETRACTS)] = ()
    supersedes: Annotated[tuple[str, ...], rules_property(SUPERSEDES)] = ()
    #: confidence of the speech recognition, in [0, 1]; 1 where it was typed
    heard: Annotated[float, FieldProperty(HEARD, Decimal, decimal, float, 1.0)] = 1.0

    def __post_init__(self) -> None:
        check_speaker(self.speaker)
        for text in (self.text, self.predicate, self.kind, self.answer):
            try:
                lexical(text)
            except ValueError as error:
                raise ValidationError([f"The text is no Unicode: {text[:60]!r}."]) from error
            if len(text) > MAX_TEXT:
                problem = f"The text has {len(text)} characters; at most {MAX_TEXT} are kept."
                raise ValidationError([problem])
        if self.time.tzinfo is None:
            raise ValidationError([f"The time {self.time} has no time zone."])

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt history --json`."""
        return {
            **vars(self),
            **{name: list(getattr(self, name)) for name in ("asserts", "retracts", "supersedes")},
            "predicate": self.predicate or None,
            "time": lexical(self.time)[0],
            "answer": self.answer or None,
        }


def import_utterance(source: str, sequence: int, time: datetime, *, some: str = "") -> Utterance:
    """The utterance that stands for a file whose rules do not say where they come from.

    `source` names the file, "-" is standard input; `some` says for which rules, if not for all.
    """
    name = "standard input" if source == "-" else PurePath(source).name
    speaker = f"file {_NOT_IN_NAMES.sub(' ', name).strip()}"[:MAX_NAME].rstrip(" '@+-")
    return Utterance(sequence, f"import of {source}{some}", "", speaker, time, IMPORT)


def utterance_iri(sequence: int) -> Iri:
    """The node of an utterance."""
    return iri("utterance", str(sequence))


def utterance_quads(utterance: Utterance) -> Iterator[Quad]:
    """The statements about an utterance, its activity (time and agent), and the trust it set."""
    node, activity = utterance_iri(utterance.sequence), iri("activity", str(utterance.sequence))
    yield from _UTTERANCES.quads(node, utterance)
    yield Quad(node, _GENERATED_BY, activity, DERIVED)
    yield Quad(activity, TYPE, external("prov:Activity"), DERIVED)
    yield Quad(activity, _AGENT, iri("speaker", utterance.speaker), DERIVED)
    yield Quad(activity, _STARTED, utterance.time, DERIVED)
    if found := parse_trust(utterance):
        speaker, trust = found
        yield Quad(node, term("trusted"), iri("speaker", speaker), DERIVED)
        yield from trust_bounds(node, trust, DERIVED)


def parse_trust(utterance: Utterance) -> tuple[str, Interval] | None:
    """The speaker and the trust that an utterance set; None when it set none."""
    found = _TRUST.fullmatch(utterance.predicate) if utterance.kind == "trust" else None
    return (found[1], Interval(float(found[2]), float(found[3]))) if found else None


def trust_bounds(node: Iri, trust: Interval, graph: Iri) -> Iterator[Quad]:
    """The statements of the bounds of a trust."""
    yield Quad(node, TRUST_LOWER, decimal(trust.lower), graph)
    yield Quad(node, TRUST_UPPER, decimal(trust.upper), graph)


def read_utterance(properties: Iterable[tuple[Iri, Term]]) -> Utterance:
    """The utterance with a node's properties; ValidationError if one is missing or malformed."""
    return _UTTERANCES.read(group_pairs(properties))


_UTTERANCES = RecordMapping(Utterance, "An utterance", term("Utterance"), HISTORY)
