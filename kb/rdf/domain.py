"""The household domain as a graph: objects with their parts and properties, and the action trees.

It comes from `objects.yaml` and `actions.yaml` and is rewritten whenever they have changed. It has
the classes, parts and properties of objects, never their affordances.
"""

import hashlib
from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, TypeAlias

from ...ontology.vocabulary import Iri, external, iri, term
from ..rule import Atom
from .rule_mapping import LABEL, TYPE, atom_label_quads, decimal, label
from .terms import Quad, Term, as_sparql

if TYPE_CHECKING:
    from ...ontology.actions import Actions
    from ...ontology.objects import ObjectTypes

Statement: TypeAlias = tuple[Iri, Iri, Term]
DOMAIN = iri("graph", "domain")
DOMAIN_HASH = term("domainHash")

IS_A, PART_OF, PROPERTY, ROLE = (term(n) for n in ("isA", "partOf", "property", "role"))
WHOLE, UNDER, DOES, HEEDS = (term(n) for n in ("whole", "under", "does", "heeds"))
MASS, SUBCLASS_OF = term("mass"), external("rdfs:subClassOf")


def domain_quads(
    objects: "ObjectTypes",
    actions: "Actions",
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
    return sorted((Quad(*each, DOMAIN) for each in found), key=_written)


def content_hash(quads: Iterable[Quad]) -> str:
    """A hash of statements, the same for the same ones."""
    return hashlib.sha256("\n".join(sorted(map(_written, quads))).encode()).hexdigest()


def _class_statements(kind: str, names: Mapping[str, str | None]) -> Iterator[Statement]:
    for name, above in names.items():
        yield from _named(kind, name)
        if above:
            yield from _named(kind, above)
            yield from _is_a(iri(kind, name), iri(kind, above))


def _object_statements(objects: "ObjectTypes") -> Iterator[Statement]:
    for name, kind in objects.items():
        yield iri("object", name), MASS, decimal(kind.mass)
        yield from _having(iri("object", name), PROPERTY, "property", kind.properties)
        for part_name, part in kind.parts.items():
            of_any, node = iri("part", part_name), iri("part", f"{name}.{part_name}")
            yield from _named("part", part_name)
            yield of_any, PART_OF, iri("object", name)
            yield node, TYPE, term("Part")
            yield node, LABEL, label(f"{part_name} of {name}")
            yield from _is_a(node, of_any)
            yield node, WHOLE, iri("object", name)
            yield node, MASS, decimal(part.mass)
            yield from _having(node, ROLE, "role", [part.role])
            yield from _having(node, PROPERTY, "property", part.properties)


def _action_statements(actions: "Actions") -> Iterator[Statement]:
    for name in (*actions.primitives, *actions.trees):
        yield from _named("action", name)
    for name, above in actions.kinds.items():
        yield from _is_a(iri("action", name), iri("action", above))
    for path in actions.nodes:
        yield from node_statements(path)


def node_statements(path: str) -> Iterator[Statement]:
    """Yield the statements about the node of an action tree with this path."""
    node, (above, _, action) = iri("node", _key(path)), path.rpartition("/")
    yield node, TYPE, term("Node")
    yield node, LABEL, _key(path)
    yield node, DOES, iri("action", action)
    if above:
        yield node, UNDER, iri("node", _key(above))
    for context in (*reversed(above.split("/") if above else ()), None):
        key = f"{context}.{action}" if context else action
        yield node, HEEDS, iri("node", key)
        yield iri("node", key), TYPE, term("Node")
        yield iri("node", key), LABEL, key


def _key(path: str) -> str:
    """The name of a node; that of a node below the root is the name to which rules are attached."""
    return ".".join(path.replace("/", "-").rsplit("-", maxsplit=1))  # parsers may read one dot only


def _having(node: Iri, key: Iri, kind: str, names: Iterable[str]) -> Iterator[Statement]:
    for name in names:
        yield from _named(kind, name)
        yield node, key, iri(kind, name)


def _named(kind: str, name: str) -> Iterator[Statement]:
    return (quad[:3] for quad in atom_label_quads([Atom(kind, name)]))


def _is_a(node: Iri, above: Iri) -> Iterator[Statement]:
    yield node, IS_A, above
    yield node, SUBCLASS_OF, above


def _written(quad: Quad) -> str:
    return " ".join(map(as_sparql, quad[:3]))
