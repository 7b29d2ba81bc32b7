"""Staging of statements before they reach a base, and validation of a graph.

`stage` puts the statements of a file into a store of their own, each into the graph where it
belongs; each rule gets the id that its content makes. `check_shapes` runs SHACL over `shapes.ttl`:
its messages are those that a person wrote for each constraint, but it is slow. `findings` checks
the invariants too (`hilt.kb.invariants`), and leads with the causes.
"""

import re
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import replace
from itertools import islice
from typing import Any

from ..ontology.errors import DataError, ValidationError
from ..ontology.vocabulary import NAMED_KINDS, SHAPES_FILE, Iri, is_ontology, shortened, split, term
from .episodes import EPISODES
from .history import HISTORY
from .invariants import BASE_GRAPHS, ValidationFinding, check_invariants, is_name
from .knowledge_base import DERIVATION
from .learned import ACTIONS, LEXICON
from .rdf import rule_mapping
from .rdf.record_mapping import group_pairs
from .rdf.rule_mapping import BELIEFS, DERIVED, TYPE
from .rdf.terms import BASE_GRAPH, Quad
from .stores.base import MEMORY, ReadableStore, Store, batched
from .stores.opening import open_store
from .stores.rdf_text import write_rdf

# Statements that a person may have written, which take a second by SHACL. The invariants find the
# same; of more statements they alone are checked, in a tenth of the time.
MAX_SHACL = 5_000
_WRONG_NAME = "A rule is a node rule:ID"  # how that message of shapes.ttl begins
PORTION = 1000  # nodes that SHACL checks at a time
Progress = Callable[[int, int], None]  # is told how many are done, and of how many

_GRAPHS = {  # where a node of a class belongs when a format has no graphs
    **{"Utterance": HISTORY, "Base": BASE_GRAPH, "TaughtAction": ACTIONS},
    **dict.fromkeys(("Episode", "Step", "GraspTrial"), EPISODES),
    **dict.fromkeys(("Word", "Phrase"), LEXICON),
}

_SUBJECT = re.compile(r"\s*(<[^<>\s]+>|[\w-]+:[^\s;,<>]+)\s")  # that of a statement, in Turtle


def stage(quads: Iterable[Quad], *, source: str) -> Store:
    """Return a store with these statements, each in the graph where it belongs."""

    def checked() -> Iterator[Quad]:
        for quad in quads:
            check_graph(quad.graph, source=source)
            if quad.graph != DERIVED and quad.predicate != DERIVATION:  # it follows from the rest
                yield quad

    staging = open_store(MEMORY)
    staging.apply(insert=checked())
    _sort(staging)
    _rename(staging)
    return staging


def check_graph(graph: Iri | None, *, source: str) -> None:
    """Raise a DataError for a graph that a base has not."""
    if graph not in BASE_GRAPHS and not is_ontology(graph):
        problem = f"the graph {shortened(str(graph))} is none of a base's;"
        expected = ", ".join(sorted(map(shortened, BASE_GRAPHS)))
        raise DataError(f"{problem} expected {expected}.", source=source)


def findings(
    store: Store, *, whole: bool = False, progress: Progress | None = None
) -> list[ValidationFinding]:
    """The causes of everything that is wrong with a store, node by node.

    Of a `whole` base, what is missing is found too. Up to `MAX_SHACL` statements are checked by
    SHACL as well. `progress` is told how many statements are done, and of how many.
    """
    if not store.has_cheap_patterns:  # an endpoint is read at once, not node by node
        remote, store = store, open_store(MEMORY)
        store.apply(insert=remote.quads())
    few = sum(1 for _ in islice(store.quads(), MAX_SHACL + 1)) <= MAX_SHACL
    by_shapes = check_shapes(store) if few else ()
    return causes(by_shapes, check_invariants(store, whole=whole, progress=progress))


def causes(
    by_shapes: Iterable[ValidationFinding], by_laws: Iterable[ValidationFinding]
) -> list[ValidationFinding]:
    """One finding for each node and property that is wrong, sorted; what follows is left out.

    A node that a shape complains of is in the words of the shapes. Of others the first law that is
    broken is told, and how many more.
    """
    shaped: dict[str, dict[str, ValidationFinding]] = {}
    for one in sorted(set(by_shapes), key=lambda one: (one.problem.startswith(_WRONG_NAME), one)):
        # A rule that a person named has no name of its own where something else is wrong.
        if one.node not in shaped or not one.problem.startswith(_WRONG_NAME):
            shaped.setdefault(one.node, {}).setdefault(one.key, one)
    laws = dict.fromkeys(by_laws)
    lawless = group_pairs((one.node, one) for one in laws if one.node not in shaped)
    found = [one for several in shaped.values() for one in several.values()]
    for first, *others in lawless.values():
        more = f" ({len(others)} more about it.)" if others else ""
        found.append(replace(first, problem=first.problem + more))
    return sorted(found)


def raise_findings(found: Iterable[ValidationFinding]) -> None:
    """Raise a ValidationError with all findings, when there are any."""
    if problems := [str(finding) for finding in sorted(set(found))]:
        raise ValidationError(problems)


def check_shapes(
    store: ReadableStore, *, nodes: Iterable[Iri] | None = None
) -> Iterator[ValidationFinding]:
    """What breaks the SHACL shapes, at some nodes or at all."""
    import pyshacl  # slow to import, and only validation needs it
    from rdflib import RDF, SH, Graph, URIRef

    shapes_graph = Graph().parse(SHAPES_FILE, format="turtle")
    own = (quad.subject for quad in store.quads() if not is_ontology(quad.graph))
    # In portions: a shape looks at one node and what stands at it.
    for some in batched(sorted(set(own if nodes is None else nodes)), PORTION):
        quads = (quad for node in some for quad in store.quads(node))
        graph = Graph(bind_namespaces="none")
        graph.parse(data=write_rdf(quads, format="ntriples"), format="nt")
        options: Any = {"shacl_graph": shapes_graph, "inplace": True, "do_owl_imports": False}
        report: Any = pyshacl.validate(graph, **options)[1]
        for result in report.subjects(RDF.type, SH.ValidationResult):
            message, found = report.value(result, SH.resultMessage), report.value(result, SH.value)
            brief = shortened(str(found)) if ":" in str(found)[:8] else f'"{str(found)[:60]}"'
            text = "" if found is None else f" Found {brief}."
            path = report.value(result, SH.resultPath)
            key = shortened(str(path)) if isinstance(path, URIRef) else ""
            node = shortened(str(report.value(result, SH.focusNode)))
            yield ValidationFinding(node, f"{message}{text}", key)


def locate_findings(found: Iterable[ValidationFinding], text: str) -> list[ValidationFinding]:
    """The findings about an RDF text with the lines at which their nodes are described.

    A node is described where a line begins with it, by its prefixed name or its whole address.
    """
    lines: dict[str, int] = {}
    for number, line in enumerate(text.splitlines(), start=1):
        if start := _SUBJECT.match(line):
            name = shortened(start[1][1:-1]) if start[1].startswith("<") else start[1]
            lines.setdefault(name, number)
    return sorted(replace(one, line=lines.get(one.node, 0)) for one in set(found))


def _sort(staging: Store) -> None:
    places = {
        typed.subject: graph
        for name, graph in _GRAPHS.items()
        for typed in staging.quads(None, TYPE, term(name), BELIEFS)
    }
    moved = [q for node in places for q in staging.quads(node, None, None, BELIEFS)]
    there = [quad._replace(graph=places[quad.subject]) for quad in moved]
    beliefs = staging.quads(None, None, None, BELIEFS)
    edges = [q for q in beliefs if split(q.subject)[0] in NAMED_KINDS and not is_name(q)]
    # In format 1 the edge of "a ladle is a kind of spoon" was one of these.
    there += [q._replace(graph=DERIVED) for q in edges if q.predicate != term("affords")]
    staging.apply(insert=there, delete=[*moved, *edges])


def _rename(staging: Store) -> None:
    names: dict[Any, Any] = {}
    classes = set(rule_mapping.CLASSES.values())
    typed = (quad for quad in staging.quads(None, TYPE, None, BELIEFS) if quad.object in classes)
    for node in {quad.subject for quad in typed}:
        with suppress(ValidationError):  # validation will say it
            rule = rule_mapping.read_rule(staging.properties(node, BELIEFS))
            names[node] = rule_mapping.rule_iri(rule.id)
    if names := {node: name for node, name in names.items() if node != name}:
        old = [q for q in staging.quads() if q.subject in names or q.object in names]
        new = [Quad(*(names.get(part, part) for part in quad)) for quad in old]
        staging.apply(insert=new, delete=old)
