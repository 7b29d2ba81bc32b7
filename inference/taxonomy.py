# SPDX-License-Identifier: Apache-2.0
"""What is a kind of what: objects, parts, actions and places with what stands above them.

A bread knife is a knife, so what was told of knives holds for it, unless something was told of
bread knives: a nearer rule goes before an inherited one. Distances count steps upwards.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from ..kb.knowledge_base import KnowledgeBase
from ..kb.rule import Atom
from ..ontology.errors import DataError
from ..ontology.vocabulary import Iri, split

_IS_A = "SELECT ?kind ?above { GRAPH graph:domain { ?kind hilt:isA ?above } } ORDER BY ?kind ?above"
_KINDS = ("object", "part", "property", "action", "place", "role")


class Taxonomy:
    """Kinds and what they are kinds of; never changes.

    >>> bread_knife, knife = Atom("object", "bread knife"), Atom("object", "knife")
    >>> [(str(kind), steps) for kind, steps in Taxonomy([(bread_knife, knife)]).above(bread_knife)]
    [('object:bread knife', 0), ('object:knife', 1)]

    Args:
        pairs: (kind, what it is a kind of).

    Raises:
        DataError: something would be a kind of itself.
    """

    def __init__(self, pairs: Iterable[tuple[Atom, Atom]] = ()) -> None:
        self._parents: dict[Atom, list[Atom]] = {}
        self._children: dict[Atom, list[Atom]] = {}
        for kind, above in pairs:
            self._parents.setdefault(kind, []).append(above)
            self._children.setdefault(above, []).append(kind)
        for kind in self._parents:
            if any(kind in _reached(self._parents, above) for above in self._parents[kind]):
                raise DataError(f'"{kind}" would be a kind of itself.', source="is-a")
        self._above: dict[Atom, tuple[tuple[Atom, int], ...]] = {}

    @classmethod
    def of(cls, base: KnowledgeBase) -> Taxonomy:
        """The taxonomy that a base's domain graph holds."""
        atoms = ((_atom(kind), _atom(above)) for kind, above in base.select(_IS_A))
        return cls((kind, above) for kind, above in atoms if kind and above)

    def above(self, atom: Atom) -> tuple[tuple[Atom, int], ...]:
        """The atom itself and all that it is a kind of, each with its distance, nearest first."""
        if atom not in self._above:
            self._above[atom] = tuple(_reached(self._parents, atom).items())
        return self._above[atom]

    def below(self, atom: Atom) -> tuple[Atom, ...]:
        """The atom itself and all its kinds, nearest first."""
        return tuple(_reached(self._children, atom))


def _reached(edges: Mapping[Atom, Iterable[Atom]], start: Atom) -> dict[Atom, int]:
    """What is reached along edges, breadth first, with the number of steps."""
    found = {start: 0}
    waiting = [start]
    while waiting:
        atom = waiting.pop(0)
        for further in edges.get(atom, ()):
            if further not in found:
                found[further] = found[atom] + 1
                waiting.append(further)
    return found


def _atom(node: object) -> Atom | None:
    """The atom of a node; None for what no rule speaks of, as the blade of one kind of knife."""
    kind, name = split(node) if isinstance(node, Iri) else ("", "")
    return Atom(kind, name) if kind in _KINDS and "." not in name else None


FLAT = Taxonomy()  # nothing is a kind of anything
