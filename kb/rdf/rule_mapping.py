"""Mapping of rules to RDF statements, and back.

RDF 1.1 cannot annotate an edge, so a rule is one node with properties in the graph of beliefs:

    rule:3f9c  hilt:feature object:knife ; hilt:context action:pass ; hilt:part part:blade ; ...

What follows from it is in the derived graph: the names of what it speaks of, and while it is active
the edge from the action-tree node that uses it, so that the query for the rules of a node need not
test the status, and edges for property paths and graph tools, with and without their conditions:

    node:pass.graspObject  hilt:rule  rule:3f9c .
    object:knife  hilt:graspedBy  part:blade ;  relation:graspedBy.action-pass  part:blade .
    relation:graspedBy.action-pass  rdfs:subPropertyOf hilt:graspedBy ; hilt:context action:pass .
"""

import re
from collections.abc import Iterable, Iterator, Mapping
from decimal import Decimal
from functools import lru_cache
from typing import Any, cast, get_args

from ...ontology import vocabulary
from ...ontology.errors import ValidationError
from ...ontology.vocabulary import HILT, Iri, external, iri, shortened, split, term
from ..interval import DIGITS, VACUOUS, Interval
from ..rule import GRASP_OBJECT, KIND_OF, USED_FOR, Atom, Rule, Status
from .record_mapping import TYPE, group_pairs
from .terms import Literal, Property, Quad, Term

BELIEFS, DERIVED = iri("graph", "beliefs"), iri("graph", "derived")

LABEL = external("rdfs:label")
DERIVED_FROM = external("prov:wasDerivedFrom")
ATTRIBUTED_TO = external("prov:wasAttributedTo")
GENERATED_AT = external("prov:generatedAtTime")
RULE, FEATURE, CONTEXT, STATUS = (term(n) for n in ("rule", "feature", "context", "status"))
ACTIVE = (STATUS, term("active"))  # the property of a rule that counts
FUNCTOR, LOWER, UPPER = (term(n) for n in ("functor", "lower", "upper"))
PART, AFFORDANCE, ARGUMENT = (term(n) for n in ("part", "affordance", "argument"))

OWN = (FEATURE, LOWER, UPPER, DERIVED_FROM, GENERATED_AT)  # what each rule has for itself
ARGUMENTS = (PART, AFFORDANCE, ARGUMENT)
KEYS = {  # all properties of rules, as the objects that are quick to compare
    key: key for key in (*OWN, *ARGUMENTS, TYPE, CONTEXT, FUNCTOR, STATUS, ATTRIBUTED_TO)
}
RULE_NODE = re.compile(f"{re.escape(vocabulary.PREFIXES['rule'])}([0-9a-f]{{16}})")
ANY = Atom("object", "any")  # stands for the features of a rule

CLASSES = {
    "functional": term("FunctionalRule"),
    "action": term("ActionRule"),
    "norm": term("Norm"),
    "general": term("Rule"),
}
_ARGUMENTS = {"part": PART, "affordance": AFFORDANCE}
_EDGES = {USED_FOR: term("usedFor"), GRASP_OBJECT: term("graspedBy")}
STATUSES: tuple[str, ...] = get_args(Status)
_EDGE_OF = {**_EDGES, KIND_OF: external("rdfs:subClassOf")}
_OTHER_EDGE = term("affords")
PLAIN_EDGES = frozenset((*_EDGES.values(), _OTHER_EDGE))
_KINDS_OF_THINGS = frozenset({"object", "part", "material", "action"})
_OWL_CLASS, _SUBPROPERTY = external("owl:Class"), external("rdfs:subPropertyOf")
_WORD_START = re.compile("(?<=[a-z])(?=[A-Z])")  # pickUp is pick up
LANGUAGE = "en"  # of the names of atoms


def rule_iri(rule_id: str) -> Iri:
    """The IRI of a rule with an id such as "rule/3f9c..."."""
    return iri("rule", rule_id.removeprefix("rule/"))


def rule_id(node: Iri) -> str:
    """The id of a rule, from its IRI."""
    return f"rule/{split(node)[1]}"


@lru_cache(maxsize=2**18)
def atom_iri(atom: Atom) -> Iri:
    """The IRI of an atom."""
    return iri(atom.kind, atom.name)


@lru_cache(maxsize=2**18)
def atom_from_iri(node: Iri) -> Atom:
    """The atom of an IRI; ValidationError if it is not the IRI of an atom."""
    kind, name = split(node)
    if kind not in vocabulary.ATOM_KINDS:
        raise ValidationError([f"<{node}> is no object, part, property, action, place or role."])
    return Atom(kind, name)


def rule_quads(rule: Rule) -> Iterator[Quad]:
    """All statements of a rule: its properties, labels and edges."""
    yield from property_quads(rule)
    yield from atom_label_quads({*rule.features, *rule.contexts, rule.argument})
    yield from node_label_quads(rule)
    yield from relation_quads(rule)
    if rule.status == "active":
        yield node_edge(rule)
        yield from edges(rule)


def property_quads(rule: Rule) -> Iterator[Quad]:
    """The statements whose subject is the rule."""
    found: list[Property] = [(TYPE, CLASSES[rule.kind])]
    found += [(FEATURE, atom_iri(feature)) for feature in sorted(rule.features)]
    found += [(CONTEXT, atom_iri(context)) for context in sorted(rule.contexts)]
    found.append((FUNCTOR, _functor_iri(rule.functor)))
    if rule.argument:
        found.append((argument_property(rule.argument.kind), atom_iri(rule.argument)))
    found += [(LOWER, decimal(rule.interval.lower)), (UPPER, decimal(rule.interval.upper))]
    found += [(STATUS, term(rule.status)), (ATTRIBUTED_TO, iri("speaker", rule.speaker))]
    if rule.utterance is not None:
        found.append((DERIVED_FROM, iri("utterance", str(rule.utterance))))
    if rule.time is not None:
        found.append((GENERATED_AT, rule.time))
    return (Quad(rule_iri(rule.id), predicate, value, BELIEFS) for predicate, value in found)


def node_edge(rule: Rule) -> Quad:
    """The edge from the action-tree node to the rule."""
    return Quad(iri("node", rule.node), RULE, rule_iri(rule.id), DERIVED)


def plain_edges(rule: Rule) -> list[Quad]:
    """The plain edges from features to the argument; none for a norm or a rule that opposes it."""
    if rule.argument is None or not rule.asserts or rule.kind == "norm":
        return []
    edge, end = _EDGE_OF.get(rule.functor, _OTHER_EDGE), atom_iri(rule.argument)
    return [Quad(atom_iri(feature), edge, end, DERIVED) for feature in sorted(rule.features)]


def edges(rule: Rule) -> list[Quad]:
    """The plain edges, and those whose relation says under which conditions they hold."""
    conditional = (edge._replace(predicate=node) for edge, node, _ in _relations(rule))
    return [*plain_edges(rule), *conditional]


def relation_quads(rule: Rule) -> Iterator[Quad]:
    """The statements about the relations of the edges of a rule."""
    for plain, node, more in _relations(rule):
        yield Quad(node, TYPE, term("Relation"), DERIVED)
        yield Quad(node, _SUBPROPERTY, plain.predicate, DERIVED)
        for key, atoms in ((CONTEXT, rule.contexts), (FEATURE, more)):
            yield from (Quad(node, key, atom_iri(atom), DERIVED) for atom in sorted(atoms))


def _relations(rule: Rule) -> Iterator[tuple[Quad, Iri, frozenset[Atom]]]:
    contexts = [f"{atom.kind}-{atom.name}" for atom in sorted(rule.contexts)]
    for plain in plain_edges(rule):
        more = rule.features - {atom_from_iri(plain.subject)}
        if conditions := [*contexts, *(f"with-{atom.kind}-{atom.name}" for atom in sorted(more))]:
            name = f"{plain.predicate.rpartition('#')[2]}.{'--'.join(conditions)}"
            yield plain, iri("relation", name), more


def argument_property(kind: str) -> Iri:
    """The property of an argument of a kind of atom."""
    return _ARGUMENTS.get(kind, ARGUMENT)


def atom_label_quads(atoms: Iterable[Atom | None]) -> Iterator[Quad]:
    """The types and labels of atoms; None is left out."""
    for atom in sorted(filter(None, atoms)):
        node = atom_iri(atom)
        yield Quad(node, TYPE, term(atom.kind.capitalize()), DERIVED)
        if atom.kind in _KINDS_OF_THINGS:
            yield Quad(node, TYPE, _OWL_CLASS, DERIVED)
        yield Quad(node, LABEL, label(atom.name), DERIVED)


def label(name: str) -> Literal:
    """The label of a name that consists of words: those of an action are written apart."""
    return Literal(_WORD_START.sub(" ", name).lower(), language=LANGUAGE)


def node_label_quads(rule: Rule) -> Iterator[Quad]:
    """The types and labels of the action-tree node of a rule, and of its functor."""
    yield Quad(iri("node", rule.node), TYPE, term("Node"), DERIVED)
    yield Quad(iri("node", rule.node), LABEL, rule.node, DERIVED)
    if rule.functor not in _EDGES:
        yield Quad(_functor_iri(rule.functor), TYPE, term("Functor"), DERIVED)
        yield Quad(_functor_iri(rule.functor), LABEL, rule.functor, DERIVED)


def read_rule(properties: Iterable[Property]) -> Rule:
    """The rule with a node's properties; ValidationError if one is missing or malformed."""
    own: dict[Iri, list[Any]] = {key: [] for key in OWN}
    shared: list[Property] = []
    try:
        for one in properties:
            key, value = one
            if key in own:
                own[key].append(value)
            else:
                shared.append(one)
        source, time = own[DERIVED_FROM], own[GENERATED_AT]
        return _shared_content(tuple(shared)).restated(
            _atoms_of(tuple(own[FEATURE])),
            _interval(_one(own, LOWER), _one(own, UPPER)),
            int(split(source[0])[1]) if source else None,
            time[0] if time else None,
        )
    except ValidationError:
        raise
    except KeyError as error:
        raise ValidationError([f"A rule has no {shortened(error.args[0])}."]) from error
    except (TypeError, ValueError, AttributeError) as error:
        raise ValidationError([f"A rule is malformed: {error}"]) from error


@lru_cache(maxsize=2**18)
def _shared_content(properties: tuple[Property, ...]) -> Rule:
    found = group_pairs(properties)
    arguments: list[Any] = [value for key in ARGUMENTS for value in found[key]]
    functor: Iri = _one(found, FUNCTOR)
    status_node: Iri = _one(found, STATUS)
    if (status := status_node.removeprefix(HILT)) not in STATUSES:
        expected = ", ".join(STATUSES)
        raise ValidationError([f"{shortened(status_node)} is no status; expected {expected}."])
    return Rule(
        frozenset([ANY]),
        _atoms_of(tuple(found[CONTEXT])),
        functor.removeprefix(HILT) if functor.startswith(HILT) else split(functor)[1],
        atom_from_iri(arguments[0]) if arguments else None,
        VACUOUS,
        split(_one(found, ATTRIBUTED_TO))[1],
        status=cast(Status, status),
    )


@lru_cache(maxsize=2**18)
def _atoms_of(nodes: tuple[Term, ...]) -> frozenset[Atom]:
    return frozenset(atom_from_iri(cast(Iri, node)) for node in nodes)


@lru_cache(maxsize=2**16)
def _interval(lower: Any, upper: Any) -> Interval:
    return Interval(lower, upper).rounded()


def _one(found: Mapping[Iri, list[Any]], predicate: Iri) -> Any:
    if not (values := found.get(predicate)):
        raise KeyError(predicate)
    if len(values) > 1:
        raise ValueError(f"{shortened(predicate)} stands there {len(values)} times.")
    return values[0]


def _functor_iri(functor: str) -> Iri:
    return term(functor) if functor in _EDGES else iri("functor", functor)


def decimal(number: float) -> Decimal:
    """A number as it is stored, with at most `DIGITS` fractional digits; never -0."""
    return Decimal(f"{number:.{DIGITS}f}").normalize() + 0
