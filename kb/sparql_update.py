"""SPARQL updates by hand: their difference is found first, checked, and only then applied.

What an update would delete and insert follows from the solutions of its WHERE groups, which are
found by queries with limits. Only the nodes that it touches are checked, by the invariants of a
base and the shapes. What was checked is what is written, as one unit with an utterance, so that the
history says who changed what and when. The graphs that Hilt makes cannot be changed by hand.
"""

import contextlib
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, closing
from dataclasses import replace
from itertools import chain
from pathlib import Path
from typing import NamedTuple, cast

from ..ontology.errors import QueryError, QueryLimitError, ValidationError
from ..ontology.vocabulary import Iri, is_ontology, shortened, split
from . import invariants
from .episodes import EPISODES, observation_quads
from .history import HISTORY, TRUST, Utterance
from .invariants import Invariants, ValidationFinding, trust_findings, written
from .knowledge_base import KnowledgeBase
from .rdf import rule_mapping
from .rdf.domain import DOMAIN
from .rdf.record_mapping import group_pairs
from .rdf.rule_mapping import BELIEFS, DERIVED
from .rdf.terms import BASE_GRAPH, Quad, Term
from .rule import DEFAULT_SPEAKER, Rule
from .sparql.query_text import refuse_external_access
from .sparql.results import QueryLimits, SelectResult
from .sparql.update_operations import UpdateOperation, parse_update, readable_update
from .stores.base import ReadableStore, Store
from .stores.opening import open_store
from .stores.query_subprocess import WorkerProcess
from .validation import causes, check_shapes, raise_findings
from .writer import to_milliseconds

KIND = "update"  # of the utterance that keeps it in the history
MAX_CHANGED = 100_000  # solutions of an operation, and statements that change
_KEPT_BY_HILT = {
    HISTORY: "An update must not change the history; it only grows, by what is said.",
    BASE_GRAPH: "An update must not change the format, the number of the last utterance, or "
    "anything else that Hilt notes of the base itself.",
    DERIVED: "What follows from rules is made by Hilt; insert rules, or change their hilt:status.",
    DOMAIN: "The domain comes from the files of objects and actions; change those.",
}
_RULE = (BELIEFS, "rule")  # what is written with its utterance
_MUST_KEEP = "An update must keep every rule; a retracted one has a status."
_ONLY_STATUS = (
    "Of a rule only the hilt:status changes, from or to hilt:active; another content is another "
    "rule. Retract it, and insert the other."
)
_NO_TRUST = "An update must not delete trust; set hilt:trustLower and hilt:trustUpper to 0.0."


def update(
    base: KnowledgeBase,
    text: str,
    *,
    speaker: str = DEFAULT_SPEAKER,
    limits: QueryLimits | None = None,
    dry_run: bool = False,
) -> Utterance | None:
    """Change the base by a SPARQL update, and return the utterance that records it.

    What changes nothing is not recorded; then it returns None. A rule that it inserts or makes
    active is asserted by that utterance, and one whose status ends it is retracted or superseded.

    Graphs are named (`GRAPH graph:beliefs { ... }`); as in a query, what stands in no GRAPH of a
    WHERE group is looked for in all graphs. `limits` are for finding out what it would change; a
    `dry_run` changes nothing, and returns the utterance that would record it.

    QueryError if the update is wrong, reaches outside, changes too much, or took too long.
    ValidationError if it would break the base; says what is wrong. StoreError if writing fails.
    """
    refuse_external_access(text)
    with base.store.writing():
        if not any(change := find_difference(base.store, text, limits or QueryLimits())):
            return None
        plan = _Plan(base.store, change)
        said = Utterance(
            *(base.sequence + 1, text, "", speaker, to_milliseconds(base.clock()), KIND),
            asserts=tuple(sorted(rule.id for rule in plan.asserted)),
            retracts=tuple(sorted(plan.ended["retracted"])),
            supersedes=tuple(sorted(plan.ended["superseded"])),
        )
        if dry_run:
            return said
        return base.write(said, plan.asserted, insert=plan.insert, delete=plan.delete)


class Difference(NamedTuple):
    """What an update deletes and inserts in the end."""

    delete: set[Quad]
    insert: set[Quad]


def find_difference(store: Store, text: str, limits: QueryLimits) -> Difference:
    """What an update would change in a store; errors as for `update`."""
    readable, end = readable_update(text), time.monotonic() + limits.seconds
    gone, new = set[Quad](), set[Quad]()
    try:
        with ExitStack() as stack:
            worker, trial = stack.enter_context(closing(WorkerProcess())), store
            worker.request(limits, update=readable)  # an error says where it is in the whole text
            operations = parse_update(text)
            if len(operations) > 1:  # on a copy: each sees what those before it have changed
                folder = tempfile.TemporaryDirectory(prefix="hilt-", ignore_cleanup_errors=True)
                store.save(place := Path(stack.enter_context(folder)) / "copy")
                trial = stack.enter_context(closing(open_store(place)))
            for operation in operations:
                left = replace(limits, seconds=max(0.001, end - time.monotonic()))
                delete, insert = _effect(trial, worker, operation, left)
                new, gone = (new - delete) | (insert - gone), (gone - insert) | (delete - new)
                if trial is not store:
                    trial.apply(insert=insert, delete=delete)
    except QueryLimitError as error:
        raise limits.time_error() if time.monotonic() >= end else error from None
    return Difference(gone, new)


def _effect(
    store: Store, worker: WorkerProcess, operation: UpdateOperation, limits: QueryLimits
) -> tuple[set[Quad], set[Quad]]:
    rows: Sequence[Sequence[Term | None]] = [(None,)]
    if operation.where:
        rows = cast(SelectResult, store.run(operation.query(MAX_CHANGED + 1), limits)).rows
        _check_size(len(rows))
        invariants.refuse_blank_nodes(chain.from_iterable(rows))
    delete, insert = (
        set[Quad](worker.request(limits, update=operation.insertion(template, rows)))
        if template and rows
        else set[Quad]()
        for template in (operation.deleted, operation.inserted)
    )
    _check_size(max(len(delete), len(insert)))
    changed = delete | insert
    for graph in {quad.graph for quad in changed} - invariants.BASE_GRAPHS:
        if not is_ontology(graph):
            name = shortened(graph) if graph else "without a name"
            problem = f"The graph {name} is not one of a base; write GRAPH graph:beliefs {{ ... }}."
            raise ValidationError([problem])
    invariants.refuse_blank_nodes(chain.from_iterable(changed))
    there = {quad for quad in changed if any(store.quads(*quad))}
    return (delete & there) - insert, insert - there


def _check_size(changed: int) -> None:
    if changed > MAX_CHANGED:
        raise QueryError(
            f"The update changes more than {MAX_CHANGED} statements. Narrow it, or export the "
            "base, and import what is to be."
        )


class _Plan:
    """Rules that an update asserts or ends, and statements besides; ValidationError if unlawful."""

    def __init__(self, store: Store, change: Difference) -> None:
        self.insert = list[Quad]()
        self.delete = [q for q in change.delete if (q.graph, split(q.subject)[0]) != _RULE]
        self.asserted = list[Rule]()
        self.ended: dict[str, list[str]] = {"retracted": [], "superseded": []}
        self._before, self._after = store, _ChangedStore(store, change)
        changes = change.insert | change.delete
        touched = sorted({(quad.subject, cast(Iri, quad.graph)) for quad in changes})
        raise_findings(
            ValidationFinding(shortened(graph), _KEPT_BY_HILT[graph])
            for _, graph in touched
            if graph in _KEPT_BY_HILT
        )
        laws, by_laws = Invariants(self._after, whole=True), list[ValidationFinding]()
        for node, graph in touched:
            self._take(node, graph)
            by_laws += laws.check(node, graph, self._after.properties(node, graph))
            if split(node)[0] == "rule" and graph == BELIEFS:
                by_laws += self._rule_findings(node)
            elif split(node)[0] == "speaker":
                by_laws += self._speaker_findings(node, graph)
        by_shapes = check_shapes(self._after, nodes=[node for node, _ in touched])
        raise_findings(causes(by_shapes, by_laws))

    def _rule_findings(self, node: Iri) -> Iterator[ValidationFinding]:
        name, before, after = shortened(node), _rule(self._before, node), _rule(self._after, node)
        if not self._after.properties(node, BELIEFS):
            yield ValidationFinding(name, _MUST_KEEP)
        if after is None:
            return
        if after.status == "active" and (before is None or before.status != "active"):
            self.asserted.append(after)
        elif before and before.status != after.status and after.status in self.ended:
            self.ended[after.status].append(after.id)
        else:
            yield ValidationFinding(name, _ONLY_STATUS)

    def _speaker_findings(self, node: Iri, graph: Iri) -> Iterator[ValidationFinding]:
        was, now = (
            any(key in TRUST for key, _ in store.properties(node, graph))
            for store in (self._before, self._after)
        )
        if was and not now:
            yield ValidationFinding(shortened(node), _NO_TRUST)
        elif was or now:
            yield from trust_findings(self._after)

    def _take(self, node: Iri, graph: Iri) -> None:
        inserted = self._after.inserted
        with contextlib.suppress(ValidationError):  # a finding will say it
            known = written(self._after, node, graph, self._after.properties(node, graph))
            inserted[node] = [known.get(quad, quad) for quad in inserted[node]]
        if (graph, split(node)[0]) != _RULE:
            self.insert += (quad for quad in inserted[node] if quad.graph == graph)
        if graph == EPISODES:
            before, after = (
                {*observation_quads(node, store.properties(node, graph))}
                for store in (self._before, self._after)
            )
            self.insert += after - before
            self.delete += before - after


class _ChangedStore(ReadableStore):
    """What a store holds with a difference applied, as far as the laws read it."""

    def __init__(self, store: Store, change: Difference) -> None:
        self._store, self._change = store, change
        self.inserted = group_pairs((quad.subject, quad) for quad in change.insert)

    def quads(
        self,
        subject: Iri | None = None,
        predicate: Iri | None = None,
        object: Term | None = None,
        graph: Iri | None = None,
    ) -> Iterator[Quad]:
        """All statements that match."""
        wanted = (subject, predicate, object, graph)
        yield from (q for q in self._store.quads(*wanted) if q not in self._change.delete)
        subjects = list(self.inserted) if subject is None else [subject]
        for quad in (quad for each in subjects for quad in self.inserted[each]):
            if all(part in (None, there) for part, there in zip(wanted, quad, strict=True)):
                yield quad


def _rule(store: ReadableStore, node: Iri) -> Rule | None:
    try:
        return rule_mapping.read_rule(store.properties(node, BELIEFS))
    except ValidationError:
        return None
