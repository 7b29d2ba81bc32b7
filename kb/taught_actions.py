"""Taught actions: action trees that people have told, in a graph of their own.

A taught action is a node in the graph `actions`: its name, its meaning, who told it and in which
utterance, which has the time. Beside it are the nodes of its tree, as the graph `domain` has those
of the actions of files, so that rules can be attached to them. A retracted action stays with that
status, as a rule does; of several with one name that which was told last holds.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from hashlib import sha256

from ..ontology.vocabulary import Iri, iri, term
from .learned_words import TOLD, active_properties
from .rdf.domain import node_statements
from .rdf.record_mapping import FieldProperty, read_fields, record_properties
from .rdf.rule_mapping import STATUS, TYPE, atom_from_iri, atom_iri, status_iri
from .rdf.terms import Quad
from .rule import Atom, Status
from .stores.base import Store

ACTIONS = iri("graph", "actions")
TAUGHT_ACTION = term("TaughtAction")
_FIELDS = {
    "action": FieldProperty(term("denotes"), Iri, atom_iri, atom_from_iri),
    "meaning": FieldProperty(term("meaning"), str),
    **TOLD,
}


@dataclass(frozen=True)
class TaughtAction:
    """A taught action.

    Attributes:
        action: its name, as an atom of the kind "action".
        meaning: the JSON object of its meaning, as compact JSON.
        said: as it was said.
        speaker: who taught it.
        utterance: number of the utterance that taught it; None before it is stored.
        nodes: the paths of the nodes of its tree; written only.
    """

    action: Atom
    meaning: str
    said: str
    speaker: str
    utterance: int | None = None
    nodes: tuple[str, ...] = field(default=(), compare=False)

    @property
    def name(self) -> str:
        """Its verb, with its particle."""
        return self.action.name

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt actions --json`."""
        who = {"said": self.said, "speaker": self.speaker, "utterance": self.utterance}
        return {**json.loads(self.meaning), **who}


def action_node(action: TaughtAction) -> Iri:
    """The node of a taught action, from its name and meaning."""
    key = f"{action.name} {action.meaning}"
    return iri("taught", sha256(key.encode()).hexdigest()[:16])


def action_quads(
    action: TaughtAction, utterance: int, *, status: Status = "active"
) -> Iterator[Quad]:
    """The statements about an action that an utterance taught."""
    node = action_node(action)
    yield Quad(node, TYPE, TAUGHT_ACTION, ACTIONS)
    yield Quad(node, STATUS, status_iri(status), ACTIONS)
    for predicate, value in record_properties(replace(action, utterance=utterance), _FIELDS):
        yield Quad(node, predicate, value, ACTIONS)
    for path in action.nodes:
        for subject, predicate, value in node_statements(path):
            yield Quad(subject, predicate, value, ACTIONS)


def read_actions(store: Store) -> list[TaughtAction]:
    """The active taught actions of a store, one of each name, sorted by name."""
    found = active_properties(store, TAUGHT_ACTION, ACTIONS)
    known = [TaughtAction(**read_fields(each, _FIELDS, "A taught action")) for each in found]
    latest = {each.name: each for each in sorted(known, key=lambda one: one.utterance or 0)}
    return [latest[name] for name in sorted(latest)]
