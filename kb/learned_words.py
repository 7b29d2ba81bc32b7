# SPDX-License-Identifier: Apache-2.0
"""Learned words: words of the lexicon that an utterance introduced.

A word is an OntoLex entry in the graph `lexicon`. It denotes an object, a part, an affordance or an
action, and names its speaker and the utterance it was learned from. A retracted word stays in the
graph with that status, as a rule does.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import cast

from ..ontology.vocabulary import Iri, external, iri, split, term
from .history import utterance_iri
from .rdf.rule_mapping import (
    ATTRIBUTED_TO,
    LABEL,
    STATUS,
    TYPE,
    atom_from_iri,
    atom_iri,
    status_iri,
)
from .rdf.terms import Quad, Term
from .rule import Atom, Status
from .stores.base import Store

LEXICON = iri("graph", "lexicon")
DERIVED_FROM, DENOTES, TEXT = external("prov:wasDerivedFrom"), term("denotes"), term("text")


@dataclass(frozen=True, order=True)
class Word:
    """A learned word.

    Attributes:
        atom: what it denotes: its dictionary form and its kind.
        said: as it was said.
        speaker: who used it first.
        utterance: number of the utterance it was learned from; None before it is stored.
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


def word_quads(word: Word, utterance: int, *, status: Status = "active") -> Iterator[Quad]:
    """The statements about a word learned from an utterance."""
    properties: list[tuple[Iri, Term]] = [
        (TYPE, term("Word")),
        (TYPE, external("ontolex:LexicalEntry")),
        (LABEL, word.atom.name),
        (TEXT, word.said),
        (DENOTES, atom_iri(word.atom)),
        (STATUS, status_iri(status)),
        (ATTRIBUTED_TO, iri("speaker", word.speaker)),
        (DERIVED_FROM, utterance_iri(utterance)),
    ]
    node = word_iri(word.atom)
    for predicate, value in properties:
        yield Quad(node, predicate, value, LEXICON)


def read_words(store: Store) -> list[Word]:
    """The active words of a store, sorted by what they denote."""
    nodes = [q.subject for q in store.quads(None, STATUS, status_iri("active"), LEXICON)]
    return sorted(_read(store, node) for node in nodes)


def _read(store: Store, node: Iri) -> Word:
    found = {q.predicate: q.object for q in store.quads(node, None, None, LEXICON)}
    return Word(
        atom_from_iri(cast(Iri, found[DENOTES])),
        cast(str, found[TEXT]),
        split(cast(Iri, found[ATTRIBUTED_TO]))[1],
        int(split(cast(Iri, found[DERIVED_FROM]))[1]),
    )
