"""What utterances taught besides rules: words, turns of phrase, and actions.

A word is an OntoLex entry in the graph `lexicon`. It denotes an object, a part, an affordance or an
action, and names its speaker and the utterance it was learned from; an object that was shown has
its look, too. A phrase, whose meaning was confirmed, is a pattern of words with slots for names,
and the meaning with the same slots.

A taught action is a node in the graph `actions`: its name, its meaning, who told it and in which
utterance. Beside it are the nodes of its tree, as the graph `domain` has those of the actions of
files, so that rules can be attached to them; of several with one name the last one told holds.

What is retracted stays in its graph with that status, as a rule does.
"""

import json
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from hashlib import sha256
from typing import Annotated

from ..ontology.vocabulary import Iri, external, iri, term
from .history import SPEAKER, TEXT, utterance_property
from .rdf.domain import node_statements
from .rdf.record_mapping import FieldProperty, Record, RecordMapping, group_pairs
from .rdf.rule_mapping import ACTIVE, DERIVED_FROM, LABEL, STATUS, TYPE, atom_from_iri, atom_iri
from .rdf.terms import Quad
from .rule import Atom, Status
from .stores.base import Store, described_nodes

LEXICON, ACTIONS = iri("graph", "lexicon"), iri("graph", "actions")
TOLD = ("said", "speaker", "utterance")  # fields of all that utterances taught besides rules
_SAID = FieldProperty(TEXT, str)
_UTTERANCE = utterance_property(DERIVED_FROM)
_DENOTES = FieldProperty(term("denotes"), Iri, atom_iri, atom_from_iri)
LOOK = FieldProperty(term("look"), str, default="")
_PATTERN, _MEANING = (FieldProperty(term(name), str) for name in ("pattern", "meaning"))


@dataclass(frozen=True)
class LearnedMapping(RecordMapping[Record]):
    """How records are stored that utterances taught and that may be retracted.

    `node` gives a record's node, `names` what it is called, `besides` what only follows from it.
    """

    node: Callable[[Record], Iri]
    names: Callable[[Record], list[str]]
    besides: Callable[[Record], Iterator[Quad]] = lambda _: iter(())

    def learned_quads(self, record: Record, *, status: Status = "active") -> Iterator[Quad]:
        """The statements about a record, which has the number of its utterance."""
        node = self.node(record)
        yield from self.quads(node, record)
        yield Quad(node, STATUS, term(status), self.graph)
        yield from self.besides(record)

    def active(self, store: Store) -> list[Record]:
        """The records of a store that were not retracted, sorted."""
        wanted = {(TYPE, self.type), ACTIVE}
        found = (some for _, some in described_nodes(store, self.graph) if wanted.issubset(some))
        # One value of each, because what was learned again, or merged, has several utterances.
        known = [self.read(group_pairs(dict(one).items())) for one in found]
        return sorted(known)  # pyright: ignore[reportArgumentType] - ordered dataclasses


@dataclass(frozen=True, order=True)
class LearnedWord:
    """A learned word, what it denotes, and its utterance, which is None before it is stored."""

    atom: Annotated[Atom, _DENOTES]
    said: Annotated[str, _SAID]
    speaker: Annotated[str, SPEAKER]
    utterance: Annotated[int | None, _UTTERANCE] = None
    look: Annotated[str, LOOK] = ""  #: of an object that was shown, compact JSON of what was seen

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt words --json`."""
        shown = {"shown": True, "parts": [*self.parts]} if self.look else {}
        return {"word": self.atom.name, "kind": self.atom.kind, **_told(self), **shown}

    @property
    def parts(self) -> tuple[str, ...]:
        """What the parts of an object are called that was shown."""
        return tuple(json.loads(self.look)["names"].values()) if self.look else ()


@dataclass(frozen=True, order=True)
class LearnedPhrase:
    """A learned phrase, who used it first, and the utterance that confirmed it, once it is stored.

    Pattern and meaning (compact JSON) have slots: "?affordance is what you want a ?object for".
    """

    pattern: Annotated[str, _PATTERN]
    meaning: Annotated[str, _MEANING]
    said: Annotated[str, _SAID]
    speaker: Annotated[str, SPEAKER]
    utterance: Annotated[int | None, _UTTERANCE] = None

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt words --json`."""
        meaning = json.loads(self.meaning)
        return {"word": self.pattern, "kind": "phrase", **_told(self), "meaning": meaning}


@dataclass(frozen=True, order=True)
class TaughtAction:
    """A taught action, who taught it, and the utterance in which, once it is stored.

    The meaning is compact JSON. `nodes` are the paths of the nodes of its tree; written only.
    """

    action: Annotated[Atom, _DENOTES]
    meaning: Annotated[str, _MEANING]
    said: Annotated[str, _SAID]
    speaker: Annotated[str, SPEAKER]
    utterance: Annotated[int | None, _UTTERANCE] = None
    nodes: tuple[str, ...] = field(default=(), compare=False)

    @property
    def name(self) -> str:
        """Its verb, with its particle."""
        return self.action.name

    def as_json(self) -> dict[str, object]:
        """One entry of `hilt actions --json`."""
        return {**json.loads(self.meaning), **_told(self)}


def _told(record: object) -> dict[str, object]:
    return {name: getattr(record, name) for name in TOLD}


def _word_entry(word: LearnedWord) -> Iterator[Quad]:
    node = WORDS.node(word)
    yield Quad(node, TYPE, external("ontolex:LexicalEntry"), LEXICON)
    yield Quad(node, LABEL, word.atom.name, LEXICON)


def _hashed(kind: str, content: str) -> Iri:
    return iri(kind, sha256(content.encode()).hexdigest()[:16])


WORDS = LearnedMapping(
    *(LearnedWord, "A learned word", term("Word"), LEXICON),
    lambda word: iri("word", f"{word.atom.kind}.{word.atom.name}"),
    lambda word: [word.atom.name],
    _word_entry,
)
PHRASES = LearnedMapping(
    *(LearnedPhrase, "A learned phrase", term("Phrase"), LEXICON),
    lambda phrase: _hashed("phrase", phrase.pattern),
    lambda phrase: [phrase.said, phrase.pattern],
)
TAUGHT_ACTIONS = LearnedMapping(
    *(TaughtAction, "A taught action", term("TaughtAction"), ACTIONS),
    lambda action: _hashed("taught", f"{action.name} {action.meaning}"),
    lambda action: [action.name],
    lambda action: (Quad(*one, ACTIONS) for path in action.nodes for one in node_statements(path)),
)
