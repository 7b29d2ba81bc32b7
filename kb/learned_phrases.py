"""Learned phrases: turns of phrase that Hilt did not understand and whose meaning was confirmed.

A phrase is a node in the graph `lexicon`: a pattern of words with slots for names, and the meaning
with the same slots. It names its speaker and the utterance it was learned from. A retracted phrase
stays in the graph with that status, as a word does.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from hashlib import sha256

from ..ontology.vocabulary import Iri, iri, term
from .history import SPEAKER, TEXT, utterance_iri, utterance_number
from .learned_words import LEXICON
from .rdf.record_mapping import FieldProperty, group_properties, read_fields, record_properties
from .rdf.rule_mapping import DERIVED_FROM, STATUS, TYPE, status_iri
from .rdf.terms import Quad
from .rule import Status
from .stores.base import Store

PHRASE = term("Phrase")
_FIELDS = {
    "pattern": FieldProperty(term("pattern"), str),
    "meaning": FieldProperty(term("meaning"), str),
    "said": FieldProperty(TEXT, str),
    "speaker": SPEAKER,
    "utterance": FieldProperty(DERIVED_FROM, Iri, utterance_iri, utterance_number),
}


@dataclass(frozen=True, order=True)
class LearnedPhrase:
    """A learned phrase.

    Attributes:
        pattern: its words, with slots for names: "?affordance is what you want a ?object for".
        meaning: the JSON object of its meaning with the same slots, as compact JSON.
        said: as it was said.
        speaker: who used it first.
        utterance: number of the utterance that confirmed it; None before it is stored.
    """

    pattern: str
    meaning: str
    said: str
    speaker: str
    utterance: int | None = None

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt words --json`."""
        return {
            "word": self.pattern,
            "kind": "phrase",
            "said": self.said,
            "speaker": self.speaker,
            "utterance": self.utterance,
            "meaning": json.loads(self.meaning),
        }


def phrase_iri(pattern: str) -> Iri:
    """The node of a phrase, from its pattern."""
    return iri("phrase", sha256(pattern.encode()).hexdigest()[:16])


def phrase_quads(
    phrase: LearnedPhrase, utterance: int, *, status: Status = "active"
) -> Iterator[Quad]:
    """The statements about a phrase learned from an utterance."""
    node = phrase_iri(phrase.pattern)
    yield Quad(node, TYPE, PHRASE, LEXICON)
    yield Quad(node, STATUS, status_iri(status), LEXICON)
    for predicate, value in record_properties(replace(phrase, utterance=utterance), _FIELDS):
        yield Quad(node, predicate, value, LEXICON)


def read_phrases(store: Store) -> list[LearnedPhrase]:
    """The active phrases of a store, sorted by their patterns."""
    nodes = [q.subject for q in store.quads(None, TYPE, PHRASE, LEXICON)]
    # As a dict, because a phrase that both bases of a merge have has two utterances.
    found = (group_properties(dict(store.properties(node, LEXICON)).items()) for node in nodes)
    return sorted(
        LearnedPhrase(**read_fields(each, _FIELDS, "A phrase"))
        for each in found
        if status_iri("active") in each[STATUS]
    )
