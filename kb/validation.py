# SPDX-License-Identifier: Apache-2.0
"""Validation of a graph: the invariants of rules and utterances, and the SHACL shapes.

Two checks, which find the same faults where both look. `check_invariants` reads every rule and
utterance back as a value and compares what it would have written: fast, and strict about statements
that belong to nothing. `check_shapes` runs SHACL over `shapes.ttl`: slower, and its messages are
those that a person wrote for each constraint.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

from ..ontology.errors import ValidationError
from ..ontology.vocabulary import ATOM_KINDS, SHAPES_FILE, Iri, shortened, split, term
from .history import HISTORY, read_utterance, utterance_quads
from .rdf import rule_mapping
from .rdf.rule_mapping import BELIEFS, TYPE
from .rdf.terms import STRING, Quad, Term, lexical
from .reader import TRUST_LOWER, TRUST_UPPER
from .stores.base import Store
from .writer import speaker_quads

if TYPE_CHECKING:
    from rdflib import Graph

RULE_CLASSES = tuple(term(name) for name in ("Rule", "FunctionalRule", "ActionRule"))
PORTION = 1000  # nodes that SHACL checks at a time
Progress = Callable[[int, int], None]  # is told how many are done, and of how many

_SUBJECT = re.compile(r"\s*(<[^<>\s]+>|[\w-]+:[^\s;,<>]+)\s")  # that of a statement, in Turtle
_OF_SPEAKERS = frozenset({TYPE, rule_mapping.LABEL, TRUST_LOWER, TRUST_UPPER})
_NAMED = frozenset((*ATOM_KINDS, "node", "functor"))


@dataclass(frozen=True, order=True)
class Finding:
    """One thing that is wrong.

    Attributes:
        node: what it is about, as a prefixed name.
        problem: what was expected, and what was found where that helps.
        key: the property that is wrong, as a prefixed name; empty where it is more than one.
        line: 1-based line of the file at which the node is described; 0 when not known.
    """

    node: str
    problem: str
    key: str = field(default="", compare=False)
    line: int = field(default=0, compare=False)

    def __str__(self) -> str:
        return f"{self.node}: {self.problem}"

    def as_json(self) -> dict[str, object]:
        """As `hilt validate --json` prints it."""
        where = {"node": self.node, "property": self.key or None, "line": self.line or None}
        return {**where, "problem": self.problem}


def raise_findings(findings: Iterable[Finding]) -> None:
    """Raise when anything was found.

    Raises:
        ValidationError: with all findings.
    """
    found = sorted(set(findings))
    if found:
        raise ValidationError([str(finding) for finding in found])


def check_invariants(store: Store) -> Iterator[Finding]:
    """What breaks the laws of rules and utterances, or belongs to none of them."""
    expected = {graph: set[Quad]() for graph in (BELIEFS, HISTORY)}
    for node in rule_nodes(store):
        yield from _gather(node, store, BELIEFS, _rule_statements, expected[BELIEFS])
    for node in _of_class(store, term("Utterance"), HISTORY):
        yield from _gather(node, store, HISTORY, _utterance_statements, expected[HISTORY])
    for graph, known in expected.items():
        for quad in store.quads(None, None, None, graph):
            if quad not in known and not _stands_alone(quad):
                problem = f"{_shown(quad)} belongs to nothing known."
                yield Finding(shortened(quad.subject), problem, shortened(quad.predicate))


def check_shapes(store: Store, *, progress: Progress | None = None) -> Iterator[Finding]:
    """What breaks the SHACL shapes.

    A shape looks at one node and what stands at it, so the nodes are checked in portions: that
    bounds the memory, and tells how far it is.

    Args:
        store: what is checked.
        progress: is told how many nodes are done, and of how many.
    """
    import pyshacl  # slow to import, and only validation needs it
    from rdflib import Graph

    shapes_graph = Graph().parse(SHAPES_FILE, format="turtle")
    nodes = sorted({quad.subject for quad in store.quads()})
    for start in range(0, len(nodes), PORTION):
        quads = (quad for node in nodes[start : start + PORTION] for quad in store.quads(node))
        _, report, _ = pyshacl.validate(
            _as_rdflib(quads), shacl_graph=shapes_graph, inplace=True, do_owl_imports=False
        )
        yield from _findings(report)
        if progress:
            progress(min(start + PORTION, len(nodes)), len(nodes))


def locate_findings(found: Iterable[Finding], text: str) -> list[Finding]:
    """The findings about an RDF text with the lines at which their nodes are described.

    A node is described where a line begins with it, by its prefixed name or its whole address.
    """
    lines: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        start = _SUBJECT.match(line)
        if start:
            lines.setdefault(_as_named(start[1]), number)
    return sorted(replace(one, line=lines.get(one.node, 0)) for one in set(found))


def rule_nodes(store: Store) -> list[Iri]:
    """The nodes of all rules, sorted."""
    found = (_of_class(store, kind, BELIEFS) for kind in RULE_CLASSES)
    return sorted({node for nodes in found for node in nodes})


def _as_named(subject: str) -> str:
    return shortened(subject[1:-1]) if subject.startswith("<") else subject


def _of_class(store: Store, kind: Iri, graph: Iri) -> list[Iri]:
    return sorted(quad.subject for quad in store.quads(None, TYPE, kind, graph))


def _gather(
    node: Iri,
    store: Store,
    graph: Iri,
    read: Callable[[Iri, list[tuple[Iri, Term]]], Iterable[Quad]],
    expected: set[Quad],
) -> Iterator[Finding]:
    """Add what a node should stand for to what is expected, or say why it cannot be read."""
    properties = store.properties(node, graph)
    try:
        expected.update(read(node, properties))
    except ValidationError as error:
        yield from (Finding(shortened(node), problem) for problem in error.findings)
        # What is said of it already is not said again, statement by statement.
        expected.update(Quad(node, key, value, graph) for key, value in properties)


def _rule_statements(node: Iri, properties: list[tuple[Iri, Term]]) -> Iterator[Quad]:
    rule = rule_mapping.read_rule(properties)
    if rule_mapping.rule_iri(rule.id) != node:
        raise ValidationError([f"Its content makes it {rule.id.replace('/', ':')}."])
    yield from rule_mapping.rule_quads(rule)


def _utterance_statements(node: Iri, properties: list[tuple[Iri, Term]]) -> Iterator[Quad]:
    utterance = read_utterance(properties)
    yield from utterance_quads(utterance)
    yield from speaker_quads(utterance.speaker, HISTORY)
    if node != next(utterance_quads(utterance)).subject:
        raise ValidationError([f"Its sequence number is {utterance.sequence}."])


def _stands_alone(quad: Quad) -> bool:
    """Types and names of what no rule speaks of any more, and speakers with their trust."""
    kind, _ = split(quad.subject)
    if kind == "speaker":
        return quad.predicate in _OF_SPEAKERS
    return kind in _NAMED and quad.predicate in {TYPE, rule_mapping.LABEL}


def _shown(quad: Quad) -> str:
    value = quad.object
    shown = shortened(value) if isinstance(value, Iri) else f'"{lexical(value)[0][:60]}"'
    return f"{shortened(quad.predicate)} {shown}"


def _as_rdflib(quads: Iterable[Quad]) -> Graph:
    from rdflib import Graph, Literal, URIRef

    def as_node(value: Term) -> URIRef | Literal:
        if isinstance(value, Iri):
            return URIRef(str(value))
        text, datatype, language = lexical(value)
        if language:
            return Literal(text, lang=language)
        if datatype == STRING:
            return Literal(text)  # rdflib takes a text with its type for another one
        return Literal(text, datatype=URIRef(datatype), normalize=False)

    graph = Graph(bind_namespaces="none")
    for quad in quads:
        graph.add((URIRef(str(quad.subject)), URIRef(str(quad.predicate)), as_node(quad.object)))
    return graph


def _findings(report: Any) -> Iterator[Finding]:
    from rdflib import RDF, SH, URIRef

    for result in report.subjects(RDF.type, SH.ValidationResult):
        found = report.value(result, SH.value)
        text = "" if found is None else f" Found {_brief(found)}."
        message = str(report.value(result, SH.resultMessage))
        path = report.value(result, SH.resultPath)
        key = shortened(str(path)) if isinstance(path, URIRef) else ""
        yield Finding(shortened(str(report.value(result, SH.focusNode))), f"{message}{text}", key)


def _brief(node: Any) -> str:
    return shortened(str(node)) if ":" in str(node)[:8] else f'"{str(node)[:60]}"'
