"""Staging of statements before they reach a base, and validation of a graph.

`stage` puts the statements of a file into a store of their own, each into the graph where it
belongs; each rule gets the id that its content makes. `check_invariants` reads every rule and
utterance back as a value and compares what it would have written: fast, and strict about statements
that belong to nothing. `check_shapes` runs SHACL over `shapes.ttl`: slower, and its messages are
those that a person wrote for each constraint. `findings` does both.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import TYPE_CHECKING, Any

from ..ontology.errors import DataError, ValidationError
from ..ontology.vocabulary import (
    ATOM_KINDS,
    GRAPH_NAMES,
    SHAPES_FILE,
    Iri,
    iri,
    shortened,
    split,
    term,
)
from .episodes import EPISODES
from .history import HISTORY, read_utterance, utterance_quads
from .learned_words import LEXICON
from .rdf import rule_mapping
from .rdf.rule_mapping import BELIEFS, TYPE
from .rdf.terms import STRING, Quad, Term, lexical
from .reader import BASE_GRAPH, TRUST_LOWER, TRUST_UPPER
from .rule import Rule
from .stores.base import MEMORY, Store
from .stores.opening import open_store
from .taught_actions import ACTIONS
from .writer import speaker_quads

if TYPE_CHECKING:
    from rdflib import Graph

RULE_CLASSES = tuple(term(name) for name in ("Rule", "FunctionalRule", "ActionRule", "Norm"))
MAX_SHACL = 200_000  # statements; SHACL on more takes minutes, and the laws find the same
_WRONG_NAME = "A rule is a node rule:ID"  # how that message of shapes.ttl begins
PORTION = 1000  # nodes that SHACL checks at a time
Progress = Callable[[int, int], None]  # is told how many are done, and of how many

# Where a node of a class belongs when a format has no graphs.
_GRAPHS = {
    "Utterance": HISTORY,
    "Episode": EPISODES,
    "Step": EPISODES,
    "GraspTrial": EPISODES,
    "Word": LEXICON,
    "Phrase": LEXICON,
    "TaughtAction": ACTIONS,
    "Base": BASE_GRAPH,
}
BASE_GRAPHS = frozenset(iri("graph", name) for name in GRAPH_NAMES)

_SUBJECT = re.compile(r"\s*(<[^<>\s]+>|[\w-]+:[^\s;,<>]+)\s")  # that of a statement, in Turtle
_OF_SPEAKERS = frozenset({TYPE, rule_mapping.LABEL, TRUST_LOWER, TRUST_UPPER})
_NAMED = frozenset((*ATOM_KINDS, "node", "functor"))


@dataclass(frozen=True, order=True)
class ValidationFinding:
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


def stage(quads: Iterable[Quad], *, source: str) -> Store:
    """Return a store with these statements, each in the graph where it belongs."""

    def checked() -> Iterator[Quad]:
        for quad in quads:
            check_graph(quad.graph, source=source)
            yield quad

    staging = open_store(MEMORY)
    staging.apply(insert=checked())
    _sort(staging)
    _rename(staging)
    return staging


def stage_rules(rules: Iterable[Rule]) -> Store:
    """Return a store with these rules."""
    staging = open_store(MEMORY)
    staging.apply(insert=(quad for rule in rules for quad in rule_mapping.rule_quads(rule)))
    return staging


def check_graph(graph: Iri | None, *, source: str) -> None:
    """Raise a DataError for a graph that a base has not."""
    if graph not in BASE_GRAPHS:
        raise DataError(
            f"the graph {shortened(str(graph))} is none of a base's; expected "
            f"{', '.join(sorted(map(shortened, BASE_GRAPHS)))}.",
            source=source,
        )


def findings(staging: Store, *, progress: Progress | None = None) -> list[ValidationFinding]:
    """Everything that is wrong with what was staged; `progress` as for `check_shapes`."""
    few = sum(1 for _ in islice(staging.quads(), MAX_SHACL + 1)) <= MAX_SHACL
    found = [*(check_shapes(staging, progress=progress) if few else ()), *check_invariants(staging)]
    # A rule that a person named could not be given its own name because something else is wrong.
    more = {finding.node for finding in found if not finding.problem.startswith(_WRONG_NAME)}
    return [
        finding
        for finding in found
        if finding.node not in more or not finding.problem.startswith(_WRONG_NAME)
    ]


def raise_findings(found: Iterable[ValidationFinding]) -> None:
    """Raise a ValidationError with all findings, when there are any."""
    problems = [str(finding) for finding in sorted(set(found))]
    if problems:
        raise ValidationError(problems)


def check_invariants(store: Store) -> Iterator[ValidationFinding]:
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
                yield ValidationFinding(shortened(quad.subject), problem, shortened(quad.predicate))


def check_shapes(store: Store, *, progress: Progress | None = None) -> Iterator[ValidationFinding]:
    """What breaks the SHACL shapes.

    A shape looks at one node and what stands at it, so the nodes are checked in portions: that
    bounds the memory, and `progress` is told how many nodes are done, and of how many.
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
        yield from _reported(report)
        if progress:
            progress(min(start + PORTION, len(nodes)), len(nodes))


def locate_findings(found: Iterable[ValidationFinding], text: str) -> list[ValidationFinding]:
    """The findings about an RDF text with the lines at which their nodes are described.

    A node is described where a line begins with it, by its prefixed name or its whole address.
    """
    lines: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        start = _SUBJECT.match(line)
        if start:
            name = shortened(start[1][1:-1]) if start[1].startswith("<") else start[1]
            lines.setdefault(name, number)
    return sorted(replace(one, line=lines.get(one.node, 0)) for one in set(found))


def rule_nodes(store: Store) -> list[Iri]:
    """The nodes of all rules, sorted."""
    found = (_of_class(store, kind, BELIEFS) for kind in RULE_CLASSES)
    return sorted({node for nodes in found for node in nodes})


def _of_class(store: Store, kind: Iri, graph: Iri) -> list[Iri]:
    return sorted(quad.subject for quad in store.quads(None, TYPE, kind, graph))


def _gather(
    node: Iri,
    store: Store,
    graph: Iri,
    read: Callable[[Iri, list[tuple[Iri, Term]]], Iterable[Quad]],
    expected: set[Quad],
) -> Iterator[ValidationFinding]:
    properties = store.properties(node, graph)
    try:
        expected.update(read(node, properties))
    except ValidationError as error:
        yield from (ValidationFinding(shortened(node), problem) for problem in error.findings)
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


def _reported(report: Any) -> Iterator[ValidationFinding]:
    from rdflib import RDF, SH, URIRef

    for result in report.subjects(RDF.type, SH.ValidationResult):
        message, found = report.value(result, SH.resultMessage), report.value(result, SH.value)
        brief = shortened(str(found)) if ":" in str(found)[:8] else f'"{str(found)[:60]}"'
        text = "" if found is None else f" Found {brief}."
        path = report.value(result, SH.resultPath)
        key = shortened(str(path)) if isinstance(path, URIRef) else ""
        yield ValidationFinding(
            shortened(str(report.value(result, SH.focusNode))), f"{message}{text}", key
        )


def _sort(staging: Store) -> None:
    """Move what a format without graphs has put among the beliefs to where it belongs."""
    places = {
        typed.subject: graph
        for name, graph in _GRAPHS.items()
        for typed in staging.quads(None, TYPE, term(name), BELIEFS)
    }
    moved = [q for node in places for q in staging.quads(node, None, None, BELIEFS)]
    there = [quad._replace(graph=places[quad.subject]) for quad in moved]
    staging.apply(insert=there, delete=moved)


def _rename(staging: Store) -> None:
    """Give rules that a person named (rule:1) the names that their content makes."""
    names: dict[Iri, Iri] = {}
    for node in rule_nodes(staging):
        try:
            rule = rule_mapping.read_rule(staging.properties(node, BELIEFS))
        except ValidationError:
            continue  # validation will say it
        if rule_mapping.rule_iri(rule.id) != node:
            names[node] = rule_mapping.rule_iri(rule.id)
    if names:
        new_name: dict[object, Any] = {**names}
        old = [q for q in staging.quads() if q.subject in names or q.object in names]
        new = [Quad(*(new_name.get(part, part) for part in quad)) for quad in old]
        staging.apply(insert=new, delete=old)
