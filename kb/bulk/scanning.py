# SPDX-License-Identifier: Apache-2.0
"""A large store gone through once, statement by statement, in its own order.

To look up how a term is written costs the engine more than to find the statement that it stands
in, and half of all terms are the same few properties, classes and states. So the engine is asked
for their numbers (`TAILS`), and looks up only what is left: nodes, and what is particular to them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple, TypeAlias, cast, get_args

from ...ontology.vocabulary import Iri, term
from ..history import ASSERTS
from ..rdf import rule_mapping
from ..rule import GRASP_OBJECT, USED_FOR, Status
from ..stores.base import Store
from .exporter import OutputStream, dump_rows
from .texts import whole_lines

_BUFFER = 2**18  # bytes that are taken apart at once


class Tail(NamedTuple):
    """What follows the node of a statement: a property and, where it is one of a few, its value."""

    key: Iri
    value: Iri | None = None


_VALUES = {
    rule_mapping.TYPE: (*rule_mapping.CLASSES.values(), term("Utterance")),
    rule_mapping.STATUS: tuple(
        rule_mapping.status_iri(cast(Status, one)) for one in get_args(Status)
    ),
    rule_mapping.FUNCTOR: (term(USED_FOR), term(GRASP_OBJECT)),
}
_KEYS = (
    *(
        rule_mapping.FEATURE,
        rule_mapping.CONTEXT,
        rule_mapping.LOWER,
        rule_mapping.UPPER,
        rule_mapping.DERIVED_FROM,
    ),
    *(
        rule_mapping.GENERATED_AT,
        rule_mapping.ATTRIBUTED_TO,
        rule_mapping.PART,
        rule_mapping.AFFORDANCE,
        rule_mapping.ARGUMENT,
    ),
    *(
        ASSERTS,
        rule_mapping.RULE,
        rule_mapping.LABEL,
        rule_mapping.edge_property(USED_FOR),
        rule_mapping.edge_property(GRASP_OBJECT),
    ),
    *(rule_mapping.TYPE, rule_mapping.STATUS, rule_mapping.FUNCTOR),
)
# By number, from 1: first those whose value has to be looked up.
TAILS: tuple[Tail, ...] = (
    *(Tail(key) for key in _KEYS),
    *(Tail(key, value) for key, values in _VALUES.items() for value in values),
)
NUMBERS = {tail: str(number) for number, tail in enumerate(TAILS, 1)}

# Takes lines, one a statement, of four fields with tabs between: the node; the number of its tail,
# "0" where it has none; its property, where it has none; its value, where the tail does not tell
# it. Terms are written as in Turtle, numbers and truths without quotes.
Take: TypeAlias = Callable[[Sequence[str]], object]


def scan(store: Store, graph: Iri, take: Take, *, keys: Collection[Iri] = ()) -> None:
    """Go through the statements of a graph; those of a node come together.

    Args:
        store: one that `dumping.is_large` says yes to.
        graph: whose statements.
        take: is given lines, some at a time.
        keys: the properties that are wanted, some of those in `TAILS`; all where none is given.

    Raises:
        OSError: `take` raised it.
        StoreError: the store cannot be read.
    """
    lines = _Lines(take)
    dump_rows(store, _query(graph, keys), OutputStream(lines.feed))
    lines.finish()


def graphs_of(store: Store) -> list[Iri]:
    """The graphs of a store, in alphabetical order."""
    rows = store.select("SELECT DISTINCT ?graph { GRAPH ?graph {} }")
    return sorted(graph for (graph,) in rows if isinstance(graph, Iri))


class _Lines:
    """Gathers what comes in small pieces, and gives it on as whole lines."""

    def __init__(self, take: Take) -> None:
        self._take, self._held, self._size = take, list[bytes](), 0
        self._rest, self._is_head = b"", True

    def feed(self, chunk: bytes) -> None:
        """Take a piece."""
        self._held.append(chunk)
        self._size += len(chunk)
        if self._size > _BUFFER:
            self.finish()

    def finish(self) -> None:
        """Give on what is there."""
        lines, self._rest = whole_lines(self._rest, b"".join(self._held))
        self._held.clear()
        self._size = 0
        if lines and self._is_head:
            self._is_head = False
            del lines[0]
        self._take(lines)


def _query(graph: Iri, keys: Collection[Iri]) -> str:
    number = "0"
    for key in reversed([key for key in _KEYS if not keys or key in keys]):
        inner = NUMBERS[Tail(key)]
        for value in _VALUES.get(key, ()):
            inner = f"IF(sameTerm(?end, <{value}>), {NUMBERS[Tail(key, value)]}, {inner})"
        number = f"IF(sameTerm(?key, <{key}>), {inner}, {number})"
    return f"""SELECT ?node ?number ?other ?value {{
  GRAPH <{graph}> {{ ?node ?key ?end }}
  BIND({number} AS ?number) {"FILTER(?number > 0)" if keys else ""}
  BIND(IF(?number = 0, ?key, ?nothing) AS ?other)
  BIND(IF(?number > {len(_KEYS)}, ?nothing, ?end) AS ?value)
}}"""
