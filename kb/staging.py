# SPDX-License-Identifier: Apache-2.0
"""Staging: statements of a file in a store of their own, before they reach a base.

There each statement is moved to the graph where it belongs, each rule gets the id that its content
makes, and everything is checked by SHACL and by the laws of intervals and rules.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import islice

from ..ontology.errors import DataError, ValidationError
from ..ontology.vocabulary import GRAPH_NAMES, Iri, iri, shortened, term
from .episodes import EPISODES
from .history import HISTORY
from .learned_words import LEXICON
from .rdf import rule_mapping
from .rdf.rule_mapping import BELIEFS, TYPE
from .rdf.terms import Quad
from .reader import BASE_GRAPH
from .rule import Rule
from .stores.base import MEMORY, Store
from .stores.opening import open_store
from .validation import Finding, Progress, check_invariants, check_shapes, rule_nodes

MAX_SHACL = 200_000  # statements; SHACL on more takes minutes, and the laws find the same
WRONG_NAME = "A rule is a node rule:ID"  # how that message of shapes.ttl begins

# Where a node of a class belongs when a format has no graphs.
_GRAPHS = {
    "Utterance": HISTORY,
    "Episode": EPISODES,
    "Step": EPISODES,
    "Word": LEXICON,
    "Base": BASE_GRAPH,
}
GRAPHS = frozenset(iri("graph", name) for name in GRAPH_NAMES)


def stage(quads: Iterable[Quad], *, source: str) -> Store:
    """Return a store with these statements, each in the graph where it belongs.

    Raises:
        DataError: a statement is in a graph that a base has not.
    """
    staging = open_store(MEMORY)
    staging.apply(insert=placed(quads, source=source))
    _sort(staging)
    _rename(staging)
    return staging


def stage_rules(rules: Iterable[Rule]) -> Store:
    """Return a store with these rules."""
    staging = open_store(MEMORY)
    staging.apply(insert=(quad for rule in rules for quad in rule_mapping.rule_quads(rule)))
    return staging


def placed(quads: Iterable[Quad], *, source: str) -> Iterable[Quad]:
    """The statements as they come.

    Raises:
        DataError: one is in a graph that a base has not.
    """
    for quad in quads:
        check_graph(quad.graph, source=source)
        yield quad


def check_graph(graph: Iri | None, *, source: str) -> None:
    """Refuse a graph that a base has not.

    Raises:
        DataError: it is one.
    """
    if graph not in GRAPHS:
        raise DataError(
            f"the graph {shortened(str(graph))} is none of a base's; expected "
            f"{', '.join(sorted(map(shortened, GRAPHS)))}.",
            source=source,
        )


def findings(staging: Store, *, progress: Progress | None = None) -> list[Finding]:
    """Everything that is wrong with what was staged; `progress` as for `check_shapes`."""
    few = sum(1 for _ in islice(staging.quads(), MAX_SHACL + 1)) <= MAX_SHACL
    found = [*(check_shapes(staging, progress=progress) if few else ()), *check_invariants(staging)]
    # A rule that a person named could not be given its own name because something else is wrong.
    more = {finding.node for finding in found if not finding.problem.startswith(WRONG_NAME)}
    return [
        finding
        for finding in found
        if finding.node not in more or not finding.problem.startswith(WRONG_NAME)
    ]


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
        old = [q for q in staging.quads() if q.subject in names or q.object in names]
        staging.apply(insert=[_renamed(quad, names) for quad in old], delete=old)


def _renamed(quad: Quad, names: dict[Iri, Iri]) -> Quad:
    value = quad.object
    return quad._replace(
        subject=names.get(quad.subject, quad.subject),
        object=names.get(value, value) if isinstance(value, Iri) else value,
    )
