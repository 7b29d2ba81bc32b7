# SPDX-License-Identifier: Apache-2.0
"""The scan of the rules of a store: all rows of a rule together, converted as needed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import Generic, TypeVar

from ...ontology.errors import ValidationError
from ...ontology.garbage_collection import paused_garbage_collection
from ...ontology.vocabulary import PREFIXES, Iri
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import Term
from ..rule import Rule
from ..stores.base import Store
from .nquads_reader import MAX_KNOWN
from .statement_scan import (
    RULE_PREDICATES,
    Progress,
    ProgressCounter,
    is_large,
    read_row,
    scan_graph,
)

Converted = TypeVar("Converted")  # what the rows of a rule are converted to

_RULES = f"<{PREFIXES['rule']}"


def scan_rules(
    store: Store, take: Callable[[Sequence[Rule]], object], progress: Progress | None = None
) -> int:
    """Pass every rule of a store to `take`, and return their number; as `scan_converted`."""
    return scan_converted(store, _RuleReader().read, take, progress)


def scan_converted(
    store: Store,
    convert: Callable[[Sequence[str]], Converted],
    take: Callable[[Sequence[Converted]], object],
    progress: Progress | None = None,
    *,
    predicates: Collection[Iri] = RULE_PREDICATES,
) -> int:
    """Pass every rule of a store, converted, to `take`, and return the number of rules.

    Args:
        store: what is read; its rules may have any status.
        convert: converts the rows of a rule, each without the rule; see `read_row`.
        take: is called with some rules at a time.
        progress: is called with how many rules are done.
        predicates: those of the rows.

    Raises:
        OSError: `take` raised it.
        StoreError: the store cannot be read.
        ValidationError: a rule is malformed.
    """
    rules = _RuleRows(convert, take, ProgressCounter(progress))
    with store.writing(), paused_garbage_collection():
        scan_graph(store, BELIEFS, rules.feed, predicates=predicates, in_order=is_large(store))
    return rules.finish()


class _RuleRows(Generic[Converted]):
    """Gathers the rows of each rule, and converts them."""

    def __init__(
        self,
        convert: Callable[[Sequence[str]], Converted],
        take: Callable[[Sequence[Converted]], object],
        counter: ProgressCounter,
    ) -> None:
        self._convert, self._take, self._counter = convert, take, counter
        self._node, self._rows = "", list[str]()  # of the current rule

    def feed(self, rows: Sequence[str]) -> None:
        """Read some rows."""
        converted, node, gathered = list[Converted](), self._node, self._rows
        for row in rows:
            subject, rest = row.split("\t", 1)
            if subject != node:
                converted += self._complete(node, gathered)
                node, gathered = subject, []
            gathered.append(rest)
        self._node, self._rows = node, gathered
        self._pass_on(converted)

    def finish(self) -> int:
        """Convert the last rule, and return how many there were."""
        self._pass_on(self._complete(self._node, self._rows))
        return self._counter.total

    def _pass_on(self, converted: Sequence[Converted]) -> None:
        self._take(converted)
        self._counter.add(len(converted))

    def _complete(self, node: str, rows: Sequence[str]) -> Sequence[Converted]:
        """The converted rule, if the rows are of a rule."""
        if not node.startswith(_RULES):
            return ()
        try:
            return (self._convert(rows),)
        except ValidationError as error:
            raise ValidationError([f"{node}: {one}" for one in error.findings]) from error


class _RuleReader:
    """Reads rules from rows; a row that comes again is read once."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[Iri, Term]] = {}

    def read(self, rows: Sequence[str]) -> Rule:
        """Return the rule with some rows."""
        known = self._known
        if len(known) >= MAX_KNOWN:
            known.clear()
        for row in rows:
            if row not in known:
                known[row] = read_row(row)
        return rule_mapping.read_rule([known[row] for row in rows])
