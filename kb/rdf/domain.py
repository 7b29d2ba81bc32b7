"""The household domain as a graph: objects with their parts and properties, and the action trees.

It comes from `objects.yaml` and `actions.yaml` and is rewritten whenever they have changed. It has
the classes, parts and properties of objects, never their affordances.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal
from typing import TYPE_CHECKING

from ...ontology.vocabulary import Iri, external, iri, term
from ..rule import Atom
from .rule_mapping import LABEL, TYPE, atom_iri, atom_label_quads, label
from .terms import Quad, Term, as_sparql

if TYPE_CHECKING:
    from ...ontology.actions import Actions
    from ...ontology.objects import ObjectType, ObjectTypes

DOMAIN = iri("graph", "domain")
DOMAIN_HASH = term("domainHash")

IS_A, PART_OF, PROPERTY, ROLE = (term(n) for n in ("isA", "partOf", "property", "role"))
WHOLE, UNDER, DOES, HEEDS = (term(n) for n in ("whole", "under", "does", "heeds"))
MASS, SUBCLASS_OF = term("mass"), external("rdfs:subClassOf")


def domain_quads(
    objects: ObjectTypes,
    actions: Actions,
    classes: Mapping[str, str | None] | None = None,
    people: Mapping[str, str] | None = None,
) -> list[Quad]:
    """The statements of the domain graph, sorted; arguments as for `KnowledgeBase.load_domain`."""
    kinds = {name: kind.is_a for name, kind in objects.items()} | dict(classes or {})
    found = {
        *_class_statements("object", kinds),
        *_class_statements("role", people or {}),
        *_object_statements(objects),
        *_action_statements(actions),
    }
    quads = (Quad(subject, predicate, value, DOMAIN) for subject, predicate, value in found)
    return sorted(quads, key=_written)


def content_hash(quads: Iterable[Quad]) -> str:
    """A hash of statements, the same for the same ones."""
    return hashlib.sha256("\n".join(sorted(map(_written, quads))).encode()).hexdigest()


def _class_statements(
    kind: str, names: Mapping[str, str] | Mapping[str, str | None]
) -> Iterator[tuple[Iri, Iri, Term]]:
    for name, above in names.items():
        yield from _named(Atom(kind, name))
        if above:
            yield from _named(Atom(kind, above))
            yield from _is_a(Atom(kind, name), Atom(kind, above))


def _object_statements(objects: ObjectTypes) -> Iterator[tuple[Iri, Iri, Term]]:
    for name, kind in objects.items():
        node = atom_iri(Atom("object", name))
        yield node, MASS, _kilograms(kind.mass)
        for prop in kind.properties:
            yield from _with_atom(node, "property", prop)
        for part in kind.parts:
            yield from _part_statements(kind, part)


def _part_statements(kind: ObjectType, name: str) -> Iterator[tuple[Iri, Iri, Term]]:
    part, node = kind.parts[name], iri("part", f"{kind.name}.{name}")
    yield from _named(Atom("part", name))
    yield atom_iri(Atom("part", name)), PART_OF, atom_iri(Atom("object", kind.name))
    yield node, TYPE, term("Part")
    yield node, LABEL, label(f"{name} of {kind.name}")
    yield node, IS_A, atom_iri(Atom("part", name))
    yield node, SUBCLASS_OF, atom_iri(Atom("part", name))
    yield node, WHOLE, atom_iri(Atom("object", kind.name))
    yield node, MASS, _kilograms(part.mass)
    yield from _with_atom(node, "role", part.role)
    for prop in part.properties:
        yield from _with_atom(node, "property", prop)


def _action_statements(actions: Actions) -> Iterator[tuple[Iri, Iri, Term]]:
    for name in (*actions.primitives, *actions.trees):
        yield from _named(Atom("action", name))
    for name, above in actions.kinds.items():
        yield from _is_a(Atom("action", name), Atom("action", above))
    for path in actions.nodes:
        yield from node_statements(path)


def node_statements(path: str) -> Iterator[tuple[Iri, Iri, Term]]:
    """Yield the statements about the node of an action tree with this path."""
    node, (above, _, action) = _node(path), path.rpartition("/")
    yield node, TYPE, term("Node")
    yield node, LABEL, _key(path)
    yield node, DOES, atom_iri(Atom("action", action))
    if above:
        yield node, UNDER, _node(above)
    for context in (*reversed(above.split("/") if above else ()), None):
        key = f"{context}.{action}" if context else action
        yield node, HEEDS, iri("node", key)
        yield iri("node", key), TYPE, term("Node")
        yield iri("node", key), LABEL, key


def _node(path: str) -> Iri:
    return iri("node", _key(path))


def _key(path: str) -> str:
    """The name of a node; that of a node below the root is the name to which rules are attached.

    There is one dot at most, as some SPARQL parsers read no more of them in a prefixed name.
    """
    return ".".join(path.replace("/", "-").rsplit("-", maxsplit=1))


def _with_atom(node: Iri, kind: str, name: str) -> Iterator[tuple[Iri, Iri, Term]]:
    yield from _named(Atom(kind, name))
    yield node, ROLE if kind == "role" else PROPERTY, atom_iri(Atom(kind, name))


def _named(atom: Atom) -> Iterator[tuple[Iri, Iri, Term]]:
    yield from (quad[:3] for quad in atom_label_quads([atom]))


def _is_a(kind: Atom, above: Atom) -> Iterator[tuple[Iri, Iri, Term]]:
    yield atom_iri(kind), IS_A, atom_iri(above)
    yield atom_iri(kind), SUBCLASS_OF, atom_iri(above)


def _kilograms(mass: float) -> Decimal:
    return Decimal(f"{mass:.6f}").normalize() + 0


def _written(quad: Quad) -> str:
    return " ".join(map(as_sparql, quad[:3]))
