"""Rules as annotated edges: the RDF 1.2 dialect of Turtle, to read and to write.

    object:knife hilt:usedFor affordance:cutting {| hilt:lower 0.95 ; hilt:upper 1.0 |} .

No store needs to support this form: what is read becomes the properties of `rule_mapping`, and
what an annotation leaves out (its feature, its speaker) is filled in from its edge or by default.
An annotation without a name becomes a rule with one.
"""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import groupby

from ...ontology.errors import DataError
from ...ontology.vocabulary import PREFIXES, Iri, external, iri, prefixed, shortened, split, term
from ..rule import DEFAULT_SPEAKER, GRASP_OBJECT, USED_FOR
from . import rule_mapping
from .record_mapping import group_pairs
from .rule_mapping import BELIEFS
from .terms import AnnotatedEdge, Properties, Quad, ReifyingTriple, Term, as_sparql, is_blank

REIFIES = external("rdf:reifies")
_FUNCTORS = {term("usedFor"): USED_FOR, term("graspedBy"): GRASP_OBJECT}
_CLASSES: Mapping[tuple[str | None, Iri], str] = {
    (USED_FOR, rule_mapping.AFFORDANCE): "FunctionalRule",
    (GRASP_OBJECT, rule_mapping.PART): "ActionRule",
}
_BOUNDS = (rule_mapping.LOWER, rule_mapping.UPPER)
_LOCAL = re.compile(r"[A-Za-z0-9_-]+(\.[A-Za-z0-9_-]+)*")


def expand_annotations(statements: Iterable[Quad | ReifyingTriple], *, source: str) -> list[Quad]:
    """Statements with annotated edges as the properties of rules; DataError for any other."""
    plain: list[Quad] = []
    edges: dict[Iri, list[AnnotatedEdge]] = {}
    for one in statements:
        if isinstance(one, Quad):
            plain.append(one)
        elif one.predicate != REIFIES or (one.graph not in (None, BELIEFS)):
            problem = "A statement about a statement (RDF 1.2) is read as a rule only."
            raise DataError(problem, source=source)
        else:
            edges.setdefault(one.subject, []).append(one.edge)
    about = group_pairs((q.subject, (q.predicate, q.object)) for q in plain if q.subject in edges)
    annotated = {edge for several in edges.values() for edge in several}
    kept = [q for q in plain if q.subject not in edges and AnnotatedEdge(*q[:3]) not in annotated]
    for number, (node, several) in enumerate(edges.items()):
        name = iri("rule", f"annotation-{number}") if is_blank(node) else node
        kept += (Quad(name, key, value, BELIEFS) for key, value in _completed(about[node], several))
    for end in filter(is_blank, (end for quad in kept for end in (quad.subject, quad.object))):
        raise DataError(f"A base has no blank nodes; give {end} a name, as rule:1.", source=source)
    return kept


def write_annotated(quads: Iterable[Quad]) -> Iterator[str]:
    """The lines of a Turtle text of statements, sorted by subject, with annotated edges."""
    yield from (f"@prefix {name}: <{space}> .\n" for name, space in PREFIXES.items())
    for node, several in groupby(quads, key=lambda quad: quad.subject):
        found = [(quad.predicate, quad.object) for quad in several]
        is_active = split(node)[0] == "rule" and rule_mapping.ACTIVE in found
        edges = rule_mapping.plain_edges(rule_mapping.read_rule(found)) if is_active else []
        if edges:
            said = _pairs(sorted(found, key=lambda one: one[0] not in _BOUNDS))
            first, *others = [f"{' '.join(map(_short, e[:3]))} ~ {_short(node)}" for e in edges]
            yield f"\n{first} {{|\n    {said} |}} .\n"
            yield from (f"{edge} .\n" for edge in others)
        elif plain := [one for one in found if one[0] not in rule_mapping.PLAIN_EDGES]:
            yield f"{_short(node)} {_pairs(plain)} .\n"


def _completed(found: Properties, edges: Sequence[AnnotatedEdge]) -> Iterator[tuple[Iri, Term]]:
    yield from found
    there = {key for key, _ in found}
    first = edges[0]
    functor = _FUNCTORS.get(first.predicate)
    kind = split(first.object)[0] if isinstance(first.object, Iri) else ""
    argument = rule_mapping.argument_property(kind)
    if kind and there.isdisjoint(rule_mapping.ARGUMENTS):
        yield argument, first.object
    defaults: dict[Iri, Sequence[Iri]] = {
        rule_mapping.TYPE: [term(_CLASSES.get((functor, argument), "Rule"))],
        rule_mapping.FEATURE: [edge.subject for edge in edges],
        rule_mapping.FUNCTOR: [term(functor)] if functor else [],
        rule_mapping.STATUS: [term("active")],
        rule_mapping.ATTRIBUTED_TO: [iri("speaker", DEFAULT_SPEAKER)],
    }
    for key, values in defaults.items():
        yield from ((key, value) for value in values if key not in there)


def _pairs(found: Iterable[tuple[Iri, Term]]) -> str:
    return " ;\n    ".join(f"{_short(key)} {_short(value)}" for key, value in found)


def _short(value: Term) -> str:
    if isinstance(value, Iri):
        if (name := prefixed(value)) != value and _LOCAL.fullmatch(name.partition(":")[2]):
            return name
        if shortened(value) == "rdf:type":
            return "a"
    return as_sparql(value)
