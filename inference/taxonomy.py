"""The is-a hierarchy of objects, parts, actions and places, along which rules are inherited.

A bread knife is a knife, so rules about knives apply to it unless there is a rule about bread
knives: more specific rules override general ones (`specificity`). Distances are numbers of is-a
steps.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping

from ..kb.interval import Interval
from ..kb.knowledge_base import KnowledgeBase
from ..kb.rule import KIND_OF, Atom, Rule
from ..ontology.errors import DataError
from ..ontology.vocabulary import Iri, split
from .interval_operators import fuse_yager

_IS_A = "SELECT ?kind ?above { GRAPH graph:domain { ?kind hilt:isA ?above } } ORDER BY ?kind ?above"
_KINDS = ("object", "part", "property", "action", "place", "role")


class Taxonomy:
    """An immutable is-a hierarchy, made of pairs (atom, more general atom).

    >>> bread_knife, knife = Atom("object", "bread knife"), Atom("object", "knife")
    >>> [(str(kind), steps) for kind, steps in Taxonomy([(bread_knife, knife)]).above(bread_knife)]
    [('object:bread knife', 0), ('object:knife', 1)]

    Raises:
        DataError: the hierarchy has a cycle.
    """

    def __init__(self, pairs: Iterable[tuple[Atom, Atom]] = ()) -> None:
        self._parents: dict[Atom, list[Atom]] = defaultdict(list)
        self._children: dict[Atom, list[Atom]] = defaultdict(list)
        for kind, above in pairs:
            self._parents[kind].append(above)
            self._children[above].append(kind)
        for kind in self._parents:
            if any(kind in _reachable(self._parents, above) for above in self._parents[kind]):
                raise DataError(f'"{kind}" would be a kind of itself.', source="is-a")
        self._above: dict[Atom, tuple[tuple[Atom, int], ...]] = {}

    @classmethod
    def declared(cls, base: KnowledgeBase) -> Taxonomy:
        """Return the taxonomy in the domain graph of a knowledge base, without what was taught."""
        atoms = ((_atom(kind), _atom(above)) for kind, above in base.select(_IS_A))
        return cls((kind, above) for kind, above in atoms if kind and above)

    @classmethod
    def from_base(cls, base: KnowledgeBase) -> Taxonomy:
        """Return the taxonomy in the domain graph of a knowledge base, and what was taught."""
        return cls.declared(base).with_rules(base.rules_at_nodes([KIND_OF]))

    def with_rules(self, rules: Iterable[Rule]) -> Taxonomy:
        """Return this taxonomy with the kinds that rules conclude, those told last coming first.

        What several say of one pair is fused; it holds if it is more plausible than not. What would
        close a cycle is left out.
        """
        said: dict[tuple[Atom, Atom], list[Interval]] = defaultdict(list)
        for rule in sorted(rules, key=lambda each: -(each.utterance or 0)):
            if rule.object and rule.argument:
                said[Atom("object", rule.object), rule.argument].append(rule.support)
        fused = ((pair, fuse_yager(supports)) for pair, supports in said.items())
        told = [pair for pair, interval in fused if interval.lower + interval.upper > 1]
        if not told:
            return self
        found = Taxonomy((kind, above) for kind, each in self._parents.items() for above in each)
        for kind, above in told:
            if kind not in _reachable(found._parents, above):
                found._parents[kind].append(above)
                found._children[above].append(kind)
        return found

    def is_above(self, name: str, other: str) -> bool:
        """Whether an object is another one, or a more general kind of it."""
        return Atom("object", name) in _reachable(self._parents, Atom("object", other))

    def above(self, atom: Atom) -> tuple[tuple[Atom, int], ...]:
        """Return the atom and its superclasses, each with its distance, nearest first."""
        if atom not in self._above:
            self._above[atom] = tuple(_reachable(self._parents, atom).items())
        return self._above[atom]

    def below(self, atom: Atom) -> tuple[Atom, ...]:
        """Return the atom and its subclasses, nearest first."""
        return tuple(_reachable(self._children, atom))


def _reachable(edges: Mapping[Atom, Iterable[Atom]], start: Atom) -> dict[Atom, int]:
    found, waiting = {start: 0}, [start]
    for atom in waiting:  # which grows meanwhile
        for further in edges.get(atom, ()):
            if further not in found:
                found[further] = found[atom] + 1
                waiting.append(further)
    return found


def _atom(node: object) -> Atom | None:
    """Return the atom of a node; None if rules cannot refer to it (the blade of one knife type)."""
    kind, name = split(node) if isinstance(node, Iri) else ("", "")
    return Atom(kind, name) if kind in _KINDS and "." not in name else None


FLAT = Taxonomy()  # without any is-a relation
