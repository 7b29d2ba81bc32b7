"""The is-a hierarchy of objects, parts, actions and places, along which rules are inherited.

A bread knife is a knife, so rules about knives apply to it unless a rule about bread knives, being
more specific, overrides them (`node_rules`). Distances are numbers of is-a steps.
"""

import re
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping
from itertools import chain, product
from typing import cast
from urllib.parse import unquote

from ..kb.interval import Interval
from ..kb.knowledge_base import KnowledgeBase
from ..kb.rdf.terms import Literal
from ..kb.rule import KIND_OF, MAX_NAME, Atom, Rule
from ..ontology.errors import DataError
from ..ontology.vocabulary import Iri, ontology_graph, split
from .interval_operators import fuse_yager

_IS_A = "SELECT ?kind ?above { GRAPH graph:domain { ?kind hilt:isA ?above } } ORDER BY ?kind ?above"
_LABELS = """SELECT ?node ?label { VALUES ?key { rdfs:label skos:prefLabel }
    GRAPH ?g { ?node ?key ?label } }"""
_FOREIGN = """SELECT ?kind ?same ?above {
    VALUES (?key ?same) { (rdfs:subClassOf false) (owl:sameAs true) (owl:equivalentClass true) }
    GRAPH ?g { ?kind ?key ?above } FILTER(isIRI(?above)) }"""
GENID = "/.well-known/genid/"
ImpliedAtoms = Mapping[Atom, tuple[int, Atom]]  # atom -> steps up from the given atom, given atom
_KINDS = ("object", "part", "property", "action", "place", "role")


class Taxonomy:
    """An immutable is-a hierarchy of pairs (atom, more general atom); DataError if it has a cycle.

    >>> bread_knife, knife = Atom("object", "bread knife"), Atom("object", "knife")
    >>> [(str(kind), steps) for kind, steps in Taxonomy([(bread_knife, knife)]).above(bread_knife)]
    [('object:bread knife', 0), ('object:knife', 1)]
    """

    def __init__(
        self, pairs: Iterable[tuple[Atom, Atom]] = (), *, foreign: Iterable[tuple[Atom, Atom]] = ()
    ) -> None:
        """Make it of pairs, and of those of ontologies, which may have cycles: of synonyms."""
        self._parents: dict[Atom, list[Atom]] = defaultdict(list)
        self._children: dict[Atom, list[Atom]] = defaultdict(list)
        for pair in pairs:
            self._add(*pair)
        for kind in self._parents:
            if any(kind in _reachable(self._parents, above) for above in self._parents[kind]):
                raise DataError(f'"{kind}" would be a kind of itself.', source="is-a")
        self._above: dict[Atom, tuple[tuple[Atom, int], ...]] = {}
        own = {kind: [*above] for kind, above in self._parents.items()}
        for kind, above in foreign:
            if kind not in _reachable(own, above):  # else the household says the opposite
                self._add(kind, above)

    def _add(self, kind: Atom, above: Atom) -> None:
        self._parents[kind].append(above)
        self._children[above].append(kind)

    @classmethod
    def declared(cls, base: KnowledgeBase) -> "Taxonomy":
        """Return the taxonomy in the domain graph of a knowledge base, without what was taught."""
        atoms = ((_atom(kind), _atom(above)) for kind, above in base.select(_IS_A))
        foreign = chain.from_iterable(_foreign_pairs(base, name) for name in base.taxonomies)
        return cls(((kind, above) for kind, above in atoms if kind and above), foreign=foreign)

    @classmethod
    def from_base(cls, base: KnowledgeBase) -> "Taxonomy":
        """Return the taxonomy in the domain graph of a knowledge base, and what was taught."""
        return cls.declared(base).with_rules(base.rules_at_nodes([KIND_OF]))

    def with_rules(self, rules: Iterable[Rule]) -> "Taxonomy":
        """Return this taxonomy with the kinds that rules conclude, those told last coming first.

        What several say of a pair is fused; it holds if likelier than not, and closes no cycle.
        """
        said: dict[tuple[Atom, Atom], list[Interval]] = defaultdict(list)
        for rule in sorted(rules, key=lambda each: -(each.utterance or 0)):
            if rule.object and rule.argument:
                said[Atom("object", rule.object), rule.argument].append(rule.support)
        fused = ((pair, fuse_yager(supports)) for pair, supports in said.items())
        if not (told := [pair for pair, interval in fused if interval.lower + interval.upper > 1]):
            return self
        known = ((kind, above) for kind, each in self._parents.items() for above in each)
        found = Taxonomy(foreign=known)  # without looking for cycles
        for kind, above in told:
            if kind not in _reachable(found._parents, above):
                found._add(kind, above)
        return found

    def names_above(self, kind: str, name: str | None) -> frozenset[str]:
        """Return the name of an atom of a kind and those of its superclasses; of None nothing."""
        return frozenset(atom.name for atom, _ in (self.above(Atom(kind, name)) if name else ()))

    def above(self, atom: Atom) -> tuple[tuple[Atom, int], ...]:
        """Return the atom and its superclasses, each with its distance, nearest first."""
        if atom not in self._above:
            self._above[atom] = tuple(_reachable(self._parents, atom).items())
        return self._above[atom]

    def implied(self, atoms: Iterable[Atom]) -> ImpliedAtoms:
        """Return the atoms and all kinds above them, with distance and the atom they come from."""
        found: dict[Atom, tuple[int, Atom]] = {}
        for atom in atoms:
            for above, distance in self.above(atom):
                if above not in found or distance < found[above][0]:
                    found[above] = (distance, atom)
        return found

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
    kind, name = split(node) if isinstance(node, Iri) else ("", "")
    return Atom(kind, name) if kind in _KINDS and "." not in name else None


def _foreign_pairs(base: KnowledgeBase, name: str) -> Iterator[tuple[Atom, Atom]]:
    """The kinds in an ontology: each name of a class is below those of one above."""
    graph = {"g": ontology_graph(name)}
    names: dict[Iri, set[str]] = defaultdict(set)
    for node, label in base.select(_LABELS, graph):
        if isinstance(label, str) or (isinstance(label, Literal) and label.language[:2] == "en"):
            names[cast(Iri, node)].add(_words(label if isinstance(label, str) else label.lexical))
    for kind, is_same, above in base.select(_FOREIGN, graph):
        ends = [cast(Iri, kind), cast(Iri, above)]
        words = ({*names[end], _words(unquote(re.split(r"[/#]", end)[-1]))} for end in ends)
        atoms = [
            [Atom("object", name) for name in sorted(some) if 0 < len(name) <= MAX_NAME]
            for some in words
        ]
        for lower, upper in product(*atoms) if not any(GENID in end for end in ends) else ():
            yield lower, upper
            if is_same:
                yield upper, lower


def _words(text: str) -> str:
    apart = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", text)
    return " ".join(re.findall(r"[^\W_]+", apart)).lower()


FLAT = Taxonomy()  # without any is-a relation
