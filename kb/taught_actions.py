"""Taught actions: action trees that people have told, in a graph of their own.

A taught action is a node in the graph `actions`: its name, its meaning, who told it and in which
utterance, which has the time. Beside it are the nodes of its tree, as the graph `domain` has those
of the actions of files, so that rules can be attached to them. A retracted action stays with that
status, as a rule does; of several with one name that which was told last holds.
"""

import json
from dataclasses import dataclass, field
from hashlib import sha256

from ..ontology.vocabulary import Iri, iri, term
from .learned_words import TOLD, LearnedMapping, told_as_json
from .rdf.domain import node_statements
from .rdf.record_mapping import FieldProperty
from .rdf.rule_mapping import atom_from_iri, atom_iri
from .rdf.terms import Quad
from .rule import Atom
from .stores.base import Store

ACTIONS = iri("graph", "actions")


@dataclass(frozen=True, order=True)
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
        return {**json.loads(self.meaning), **told_as_json(self)}


def read_actions(store: Store) -> list[TaughtAction]:
    """The active taught actions of a store, one of each name, sorted by name."""
    known = sorted(TAUGHT_ACTIONS.active(store), key=lambda one: one.utterance or 0)
    latest = {each.name: each for each in known}
    return [latest[name] for name in sorted(latest)]


def _action_iri(action: TaughtAction) -> Iri:
    key = f"{action.name} {action.meaning}"
    return iri("taught", sha256(key.encode()).hexdigest()[:16])


_FIELDS = {
    "action": FieldProperty(term("denotes"), Iri, atom_iri, atom_from_iri),
    "meaning": FieldProperty(term("meaning"), str),
    **TOLD,
}
TAUGHT_ACTIONS = LearnedMapping(
    *(TaughtAction, "A taught action", term("TaughtAction"), ACTIONS, _FIELDS),
    _action_iri,
    lambda action: (Quad(*s, ACTIONS) for path in action.nodes for s in node_statements(path)),
)
