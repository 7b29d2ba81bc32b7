# SPDX-License-Identifier: Apache-2.0
"""The scan of the rules of a store: all rows of a rule together, converted as needed."""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
from itertools import chain, groupby
from operator import itemgetter
from typing import TypeVar

from ...ontology.errors import ValidationError
from ...ontology.garbage_collection import paused_garbage_collection
from ...ontology.vocabulary import PREFIXES, Iri
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import Term
from ..rule import Rule
from ..stores.base import Store
from .nquads_reader import remember
from .statement_scan import RULE_PREDICATES, is_large, read_row, scan_graph

Converted = TypeVar("Converted")  # what the rows of a rule are converted to

_RULES = f"<{PREFIXES['rule']}"


def scan_rules(store: Store) -> Iterator[Rule]:
    """Iterate over the rules of a store; as `scan_converted`."""
    return scan_converted(store, _RuleReader().read)


def scan_converted(
    store: Store,
    convert: Callable[[Sequence[str]], Converted],
    *,
    predicates: Collection[Iri] = RULE_PREDICATES,
) -> Iterator[Converted]:
    """Iterate over the rules of a store, converted.

    Args:
        store: what is read; its rules may have any status.
        convert: converts the rows of a rule, each without the rule; see `read_row`.
        predicates: those of the rows.

    Raises:
        StoreError: the store cannot be read.
        ValidationError: a rule is malformed.
    """
    with store.writing(), paused_garbage_collection():
        batches = scan_graph(store, BELIEFS, predicates=predicates, in_order=is_large(store))
        rows = (row.split("\t", 1) for row in chain.from_iterable(batches))
        for node, some in groupby(rows, key=itemgetter(0)):
            if not node.startswith(_RULES):
                continue
            try:
                yield convert([rest for _, rest in some])
            except ValidationError as error:
                raise ValidationError([f"{node}: {one}" for one in error.findings]) from error


class _RuleReader:
    """Reads rules from rows; a row that comes again is read once."""

    def __init__(self) -> None:
        self._known: dict[str, tuple[Iri, Term]] = {}

    def read(self, rows: Sequence[str]) -> Rule:
        """Return the rule with some rows."""
        known = self._known
        pairs = [known.get(row) or remember(known, row, read_row(row)) for row in rows]
        return rule_mapping.read_rule(pairs)
