"""Learned words and turns of phrase: what utterances added to the language.

A word is an OntoLex entry in the graph `lexicon`. It denotes an object, a part, an affordance or an
action, and names its speaker and the utterance it was learned from. A phrase, whose meaning was
confirmed, is a pattern of words with slots for names, and the meaning with the same slots. What is
retracted stays in the graph with that status, as a rule does.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, replace
from hashlib import sha256

from ..ontology.vocabulary import Iri, external, iri, term
from .history import SPEAKER, TEXT, utterance_iri, utterance_number
from .rdf.record_mapping import (
    FieldProperty,
    PropertyValues,
    group_properties,
    read_fields,
    record_properties,
)
from .rdf.rule_mapping import DERIVED_FROM, LABEL, STATUS, TYPE, atom_from_iri, atom_iri, status_iri
from .rdf.terms import Quad
from .rule import Atom, Status
from .stores.base import Store

LEXICON = iri("graph", "lexicon")
WORD = term("Word")
TOLD = {  # fields of all that utterances added to the language
    "said": FieldProperty(TEXT, str),
    "speaker": SPEAKER,
    "utterance": FieldProperty(DERIVED_FROM, Iri, utterance_iri, utterance_number),
}
_FIELDS = {"atom": FieldProperty(term("denotes"), Iri, atom_iri, atom_from_iri), **TOLD}
PHRASE = term("Phrase")
_PHRASE_FIELDS = {
    "pattern": FieldProperty(term("pattern"), str),
    "meaning": FieldProperty(term("meaning"), str),
    **TOLD,
}


@dataclass(frozen=True, order=True)
class LearnedWord:
    """A learned word.

    The atom is what it denotes: its dictionary form and its kind. The utterance is the number of
    the one it was learned from; None before it is stored.
    """

    atom: Atom
    said: str
    speaker: str
    utterance: int | None = None

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt words --json`."""
        return {
            "word": self.atom.name,
            "kind": self.atom.kind,
            "said": self.said,
            "speaker": self.speaker,
            "utterance": self.utterance,
        }


def word_iri(atom: Atom) -> Iri:
    """The node of a word, from the atom it denotes."""
    return iri("word", f"{atom.kind}.{atom.name}")


def word_quads(word: LearnedWord, utterance: int, *, status: Status = "active") -> Iterator[Quad]:
    """The statements about a word learned from an utterance."""
    node = word_iri(word.atom)
    for kind in (WORD, external("ontolex:LexicalEntry")):
        yield Quad(node, TYPE, kind, LEXICON)
    yield Quad(node, LABEL, word.atom.name, LEXICON)
    yield Quad(node, STATUS, status_iri(status), LEXICON)
    for predicate, value in record_properties(replace(word, utterance=utterance), _FIELDS):
        yield Quad(node, predicate, value, LEXICON)


def read_words(store: Store) -> list[LearnedWord]:
    """The active words of a store, sorted by what they denote."""
    found = active_properties(store, WORD, LEXICON)
    return sorted(LearnedWord(**read_fields(each, _FIELDS, "A word")) for each in found)


def active_properties(store: Store, kind: Iri, graph: Iri) -> Iterator[PropertyValues]:
    """The properties of each node of a class that was learned and not revoked."""
    for node in [quad.subject for quad in store.quads(None, TYPE, kind, graph)]:
        # As a dict, because what was learned again, or merged, has several utterances.
        found = group_properties(dict(store.properties(node, graph)).items())
        if status_iri("active") in found[STATUS]:
            yield found


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
    for predicate, value in record_properties(replace(phrase, utterance=utterance), _PHRASE_FIELDS):
        yield Quad(node, predicate, value, LEXICON)


def read_phrases(store: Store) -> list[LearnedPhrase]:
    """The active phrases of a store, sorted by their patterns."""
    found = active_properties(store, PHRASE, LEXICON)
    return sorted(LearnedPhrase(**read_fields(one, _PHRASE_FIELDS, "A phrase")) for one in found)
