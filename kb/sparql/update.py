# SPDX-License-Identifier: Apache-2.0
"""SPARQL updates by hand: tried out on a copy and checked there, before the base is touched.

What is tried and what is applied is the same text, so an update must do the same each time. It is
written together with a line of the history, so that it is known who changed what and when.
"""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path

from ...ontology.errors import ValidationError
from ...ontology.vocabulary import GRAPH_NAMES, Iri, iri, shortened, split
from ..history import HISTORY, SEQUENCE, Utterance, utterance_iri, utterance_quads
from ..knowledge_base import KnowledgeBase
from ..migration import FORMAT, format_of
from ..rdf.terms import Quad
from ..reader import BASE_GRAPH, BASE_NODE, RuleReader
from ..rule import DEFAULT_SPEAKER
from ..stores.base import Store
from ..validation import lawful, rule_nodes
from ..writer import speaker_quads, to_milliseconds
from .limits import Limits
from .safety import refuse_chance, refuse_outside
from .sandbox import Worker
from .text import declared, delete_insert, joined

KIND = "update"  # of the utterance that keeps it in the history


def update(
    base: KnowledgeBase,
    text: str,
    *,
    speaker: str = DEFAULT_SPEAKER,
    limits: Limits | None = None,
    dry_run: bool = False,
) -> Utterance:
    """Change the base by a SPARQL update, unless it would break the laws of a base.

    Args:
        base: what is changed.
        text: the update; graphs are named (`GRAPH graph:beliefs { ... }`).
        speaker: who does it.
        limits: time and memory for trying it out.
        dry_run: only try it out.

    Returns:
        How it stands, or would stand, in the history.

    Raises:
        QueryError: the update is wrong, reaches outside, or took too long.
        ValidationError: it would break the base; says what is wrong.
        StoreError: it could not be written.
    """
    refuse_outside(text)
    refuse_chance(text)
    with base.store.writing():
        said = Utterance(base.sequence + 1, text, "", speaker, to_milliseconds(base.clock()), KIND)
        change, record = declared(text), _recorded(said)
        whole = joined(change, record)
        # One by one, so that a mistake is told where it stands.
        try_out(base.store, [change, record], said.sequence, limits or Limits())
        if not dry_run:
            base.store.update(whole)
    return said


def try_out(store: Store, updates: Sequence[str], sequence: int, limits: Limits) -> None:
    """Run updates on a copy of a store, in a process of its own, and check what comes of it.

    Raises:
        QueryError: one is wrong or was stopped.
        ValidationError: the copy is no lawful base afterwards.
    """
    folder, worker = Path(tempfile.mkdtemp(prefix="hilt-")), Worker()
    try:
        store.save(folder / "copy")
        found = worker.try_updates(folder / "copy", updates, limits)
    finally:
        worker.close()
        shutil.rmtree(folder, ignore_errors=True)
    if found["sequence"] != sequence:
        raise ValidationError(["An update must leave the number of the last utterance alone."])
    if found["findings"]:
        raise ValidationError(found["findings"])


def tried(store: Store, updates: Iterable[str]) -> bytes:
    """What comes of updates to a copy, as JSON: the worker's side of `try_out`."""
    told, rules = set(store.quads(None, None, None, HISTORY)), set(rule_nodes(store))
    for update in updates:
        store.update(update)
    findings = sorted({*_findings(store), *_rewritten(store, told), *_lost(store, rules)})
    return json.dumps({"sequence": RuleReader(store).sequence, "findings": findings}).encode()


def _findings(store: Store) -> Iterator[str]:
    known = {iri("graph", name) for name in GRAPH_NAMES}
    foreign = {quad.graph for quad in store.quads() if quad.graph not in known}
    for graph in foreign:
        name = shortened(graph) if graph else "without a name"
        yield f"The graph {name} is none of a base's; write GRAPH graph:beliefs {{ ... }}."
    if format_of(store) != FORMAT:
        yield "An update must leave the format of the base alone."
    yield from (str(finding) for finding in lawful(store))


def _rewritten(store: Store, told: set[Quad]) -> Iterator[str]:
    """What an update changed in the history, but for the line that says that it was done."""
    number = RuleReader(store).sequence
    said = utterance_iri(number)
    for quad in told.symmetric_difference(store.quads(None, None, None, HISTORY)):
        kind, _ = split(quad.subject)
        if quad.subject != said and not (kind == "speaker" and quad not in told):
            yield f"{shortened(quad.subject)}: An update must leave the history alone."


def _lost(store: Store, rules: set[Iri]) -> Iterator[str]:
    """The rules that are no more, although the history speaks of them."""
    for node in rules.difference(rule_nodes(store)):
        yield f"{shortened(node)}: An update must leave every rule; retracted ones have a status."


def _recorded(said: Utterance) -> str:
    """The update that puts an utterance into the history."""
    before = said.sequence - 1
    number = Quad(BASE_NODE, SEQUENCE, said.sequence, BASE_GRAPH)
    gone = [number._replace(object=before)] if before else []
    return delete_insert(
        gone, [number, *utterance_quads(said), *speaker_quads(said.speaker, HISTORY)]
    )
