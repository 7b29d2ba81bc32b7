"""SPARQL updates by hand: run and checked on a copy first, then applied to the base.

The text that is tried is the text that is applied, so an update must have the same effect each
time. It is written together with an utterance, so that the history says who changed what and when.

Run as a script, this module is the worker process (`stores.query_subprocess`) that updates a copy.
"""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..ontology.errors import ValidationError
from ..ontology.vocabulary import Iri, shortened, split
from .history import HISTORY, SEQUENCE, Utterance, utterance_iri, utterance_quads
from .knowledge_base import FORMAT, KnowledgeBase, base_format
from .rdf.terms import Quad
from .reader import BASE_GRAPH, BASE_NODE, RuleReader
from .rule import DEFAULT_SPEAKER
from .sparql.query_text import delete_insert, join_updates, with_prefixes
from .sparql.results import QueryLimits
from .sparql.safety import refuse_external_access, refuse_nondeterminism
from .stores.base import Store
from .stores.query_subprocess import WorkerProcess
from .validation import BASE_GRAPHS, check_invariants, rule_nodes
from .writer import speaker_quads, to_milliseconds

if TYPE_CHECKING:
    from .stores.oxigraph import OxigraphStore

KIND = "update"  # of the utterance that keeps it in the history
WORKER = f"{__package__}.sparql_update"


def update(
    base: KnowledgeBase,
    text: str,
    *,
    speaker: str = DEFAULT_SPEAKER,
    limits: QueryLimits | None = None,
    dry_run: bool = False,
) -> Utterance | None:
    """Change the base by a SPARQL update, and return the utterance that records it.

    What changes nothing is not recorded; then it returns None.

    Args:
        base: what is changed.
        text: the update; graphs are named (`GRAPH graph:beliefs { ... }`).
        speaker: who does it.
        limits: time and memory for trying it.
        dry_run: only try it; the utterance is the one that would record it.

    Raises:
        QueryError: the update is wrong, reaches outside, or took too long.
        ValidationError: it would break the base; says what is wrong.
        StoreError: it could not be written.
    """
    refuse_external_access(text)
    refuse_nondeterminism(text)
    with base.store.writing():
        moment = to_milliseconds(base.clock())
        utterance = Utterance(base.sequence + 1, text, "", speaker, moment, KIND)
        change, record = with_prefixes(text), _record_update(utterance)
        joined = join_updates(change, record)
        # One by one, so that an error is reported at its place in the text.
        updates, sequence = (change, record), utterance.sequence
        changes = try_updates(base.store, updates, sequence, limits or QueryLimits())
        if changes and not dry_run:
            base.store.update(joined)
    return utterance if changes else None


def try_updates(store: Store, updates: Sequence[str], sequence: int, limits: QueryLimits) -> bool:
    """Run updates on a copy of a store in a worker process, and check the copy, as `update`.

    The first is that of the user; return whether it changes anything.
    """
    folder, worker = Path(tempfile.mkdtemp(prefix="hilt-")), WorkerProcess(WORKER)
    try:
        store.save(folder / "copy")
        report = worker.request(limits, source=folder / "copy", updates=updates)
    finally:
        worker.close()
        shutil.rmtree(folder, ignore_errors=True)
    if report["sequence"] != sequence:
        raise ValidationError(["An update must not change the number of the last utterance."])
    if report["findings"]:
        raise ValidationError(report["findings"])
    return report["changed"]


def update_and_check(store: OxigraphStore, updates: Iterable[str]) -> dict[str, Any]:
    """Update a copy and report what is wrong with it: the worker's side."""
    history, rules = set(store.quads(None, None, None, HISTORY)), set(rule_nodes(store))
    change, *others = updates
    before = store.digest()
    store.update(change)
    is_changed = store.digest() != before
    for each in others:
        store.update(each)
    findings = {*_findings(store, rules), *_history_findings(store, history)}
    number = RuleReader(store).sequence
    return {"sequence": number, "findings": sorted(findings), "changed": is_changed}


def _findings(store: Store, rules: set[Iri]) -> Iterator[str]:
    for graph in {quad.graph for quad in store.quads()} - BASE_GRAPHS:
        name = shortened(graph) if graph else "without a name"
        yield f"The graph {name} is not one of a base; write GRAPH graph:beliefs {{ ... }}."
    if base_format(store) != FORMAT:
        yield "An update must not change the format of the base."
    for node in rules.difference(rule_nodes(store)):
        yield f"{shortened(node)}: An update must keep every rule; a retracted one has a status."
    yield from map(str, check_invariants(store))


def _history_findings(store: Store, before: set[Quad]) -> Iterator[str]:
    utterance = utterance_iri(RuleReader(store).sequence)
    for quad in before.symmetric_difference(store.quads(None, None, None, HISTORY)):
        kind, _ = split(quad.subject)
        if quad.subject != utterance and not (kind == "speaker" and quad not in before):
            yield f"{shortened(quad.subject)}: An update must not change the history."


def _record_update(utterance: Utterance) -> str:
    before = utterance.sequence - 1
    number = Quad(BASE_NODE, SEQUENCE, utterance.sequence, BASE_GRAPH)
    old = [number._replace(object=before)] if before else []
    return delete_insert(
        old, [number, *utterance_quads(utterance), *speaker_quads(utterance.speaker, HISTORY)]
    )


def _answer(request: dict[str, Any]) -> dict[str, Any]:
    from .stores.oxigraph import open_folder
    from .stores.query_worker import limit_memory

    store = open_folder(request["source"])
    limit_memory(request["megabytes"])
    return update_and_check(store, request["updates"])


if __name__ == "__main__":
    from .stores.query_worker import serve

    serve(_answer)
