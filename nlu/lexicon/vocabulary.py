"""Vocabulary of a domain: names of objects, parts, affordances and people, and learned words.

They are names only: the language does not know which object has which part or affordance. By
default they come from the household domain of the ontology.
"""

from collections.abc import Mapping
from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ...ontology.objects import ObjectType

ROLES = ("object", "part", "affordance", "context", "property", "person", "place")


@dataclass(frozen=True)
class Vocabulary:
    """Names by role, all in their dictionary form: singular, bare verb, gerund for affordances."""

    objects: tuple[str, ...] = ()  #: kinds of objects ("knife", "wine glass")
    parts: tuple[str, ...] = ()  #: kinds of parts ("handle")
    affordances: tuple[str, ...] = ()  #: gerunds of uses ("cutting")
    contexts: tuple[str, ...] = ()  #: bare verbs of acts on an object ("throw")
    properties: tuple[str, ...] = ()  #: what can be seen of an object ("sharp")
    people: tuple[str, ...] = ()  #: names of speakers, lower case
    places: tuple[str, ...] = ()  #: where Hilt may be ("kitchen"), besides those of the language

    def names(self, role: str) -> tuple[str, ...]:
        """The names that have a role, one of `ROLES`, which are in the order of the fields."""
        return getattr(self, fields(self)[ROLES.index(role)].name)


@dataclass(frozen=True)
class NewWord:
    """A word that was not known, and the role that the rest of its sentence gives it."""

    word: str  #: its dictionary form: singular, bare verb for a context, gerund for an affordance
    role: str  #: `object`, `part`, `affordance`, `context` or `place`; `person` for somebody known
    said: str  #: the word as it was said

    def as_json(self) -> dict[str, object]:
        """This word as `new_words` lists it."""
        return {"word": self.word, "role": self.role, "said": self.said}


def household_vocabulary(objects: "Mapping[str, ObjectType] | None" = None) -> Vocabulary:
    """The names of objects (by default the household ones), their parts and their properties."""
    from ...ontology.objects import load_objects  # here: who brings a vocabulary need not read it

    objects = load_objects() if objects is None else objects
    parts = {name: part for each in objects.values() for name, part in each.parts.items()}
    properties = {name for each in objects.values() for name in each.properties}
    properties |= {name for part in parts.values() for name in part.properties}
    return Vocabulary(
        objects=tuple(objects),
        parts=tuple(parts),
        properties=tuple(sorted(properties)),
        people=("sam",),
    )
