# SPDX-License-Identifier: Apache-2.0
"""A large store gone through once, statement by statement, in its own order.

To look up how a term is written costs the engine more than to find the statement that it stands
in, and half of all terms are the same few properties, classes and states. So the engine is asked
for their numbers (`TAILS`), and looks up only what is left: nodes, and what is particular to them.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from typing import NamedTuple, TypeAlias, cast, get_args

from ..ontology.vocabulary import Iri, term
from . import stars
from .dumping import Sink, dump_rows
from .history import ASSERTS
from .rule import GRASP_OBJECT, USED_FOR, Status
from .store import Store
from .texts import whole_lines

_BUFFER = 2**18  # bytes that are taken apart at once


class Tail(NamedTuple):
    """What follows the node of a statement: a property and, where it is one of a few, its value."""

    key: Iri
    value: Iri | None = None


_VALUES = {
    stars.TYPE: (*stars.CLASSES.values(), term("Utterance")),
    stars.STATUS: tuple(stars.status_iri(cast(Status, one)) for one in get_args(Status)),
    stars.FUNCTOR: (term(USED_FOR), term(GRASP_OBJECT)),
}
_KEYS = (
    *(stars.FEATURE, stars.CONTEXT, stars.LOWER, stars.UPPER, stars.DERIVED_FROM),
    *(stars.GENERATED_AT, stars.ATTRIBUTED_TO, stars.PART, stars.AFFORDANCE, stars.ARGUMENT),
    *(ASSERTS, stars.RULE, stars.LABEL, stars.edge_of(USED_FOR), stars.edge_of(GRASP_OBJECT)),
    *(stars.TYPE, stars.STATUS, stars.FUNCTOR),
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
    dump_rows(store, _query(graph, keys), Sink(lines.feed))
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
