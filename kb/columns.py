# SPDX-License-Identifier: Apache-2.0
"""A large table of rules straight from the engine's rows, without making a rule of each.

The engine finds the rules of a status one after the other in its own order, which is the same for
equal bases. What their cells say is worked out once for each name; a test holds the cells to those
that a `Rule` gives.
"""

from __future__ import annotations

import csv
from collections.abc import Iterator, Sequence
from functools import lru_cache
from typing import get_args

from ..ontology.errors import ValidationError
from ..ontology.vocabulary import Iri, split
from . import stars
from .dumping import Sink, count, dump_rows
from .files import Progress
from .notation import CONTEXT_KIND, FEATURE_KIND, write_atom
from .rule import ARGUMENT_KINDS, Status
from .stars import BELIEFS
from .store import Store
from .tables import Writable, Writer, begin_table, write_atoms, write_bound
from .terms import read_time, write_time
from .texts import whole_lines

# One row a rule, as long as it has one feature and one context; else one for each pair of them.
_ROWS = f"""SELECT ?rule ?feature ?context ?functor ?argument ?lower ?upper ?speaker ?time {{
  GRAPH <{BELIEFS}> {{
    ?rule <{stars.STATUS}> <%s> ; <{stars.FUNCTOR}> ?functor ; <{stars.ATTRIBUTED_TO}> ?speaker ;
          <{stars.LOWER}> ?lower ; <{stars.UPPER}> ?upper
    OPTIONAL {{ ?rule <{stars.FEATURE}> ?feature }}
    OPTIONAL {{ ?rule <{stars.CONTEXT}> ?context }}
    OPTIONAL {{ ?rule <{stars.GENERATED_AT}> ?time }}
    OPTIONAL {{
      {{ ?rule <{stars.PART}> ?argument }} UNION {{ ?rule <{stars.AFFORDANCE}> ?argument }}
      UNION {{ ?rule <{stars.ARGUMENT}> ?argument }}
    }}
  }}
}}"""
_COUNT = f"""SELECT (COUNT(*) AS ?count) {{
  GRAPH <{BELIEFS}> {{ VALUES ?class {{ {" ".join(f"<{one}>" for one in stars.CLASSES.values())} }}
    ?rule <{stars.TYPE}> ?class }}
}}"""
_TOLD = 10_000  # rules after which the progress is told


def write_columns(store: Store, target: Writable, progress: Progress | None = None) -> int:
    """Write a table of every rule of a store, whatever its status; how many that are.

    Args:
        store: one that `dumping.is_large` says yes to.
        target: takes the text.
        progress: is told how many rules are written.

    Raises:
        OSError: `target` raised it.
        StoreError: the store cannot be read.
        ValidationError: a rule of it lacks something.
    """
    table = _Table(begin_table(target), progress)
    with store.writing():  # so that all of it is of one moment
        for status in get_args(Status):
            table.begin(status)
            dump_rows(store, _ROWS % stars.status_iri(status), table.sink)
            table.finish()
        there = count(store, _COUNT)
    if table.count != there:
        raise ValidationError(
            [f"{abs(there - table.count)} rules of the base are not whole, or stand there twice."]
        )
    return table.count


class _Table:
    """Takes rows as CSV and writes those of one rule as a line."""

    def __init__(self, writer: Writer, progress: Progress | None) -> None:
        self.count = 0
        self.sink = Sink(self._feed)
        self._writer, self._progress = writer, progress
        self._status, self._is_head = "", False
        self._rest = b""
        self._rows: list[list[str]] = []  # of the rule at hand

    def begin(self, status: str) -> None:
        """What comes now are rules of a status, behind a line with the names of the columns."""
        self._status, self._is_head, self._rest = status, True, b""

    def _feed(self, chunk: bytes) -> None:
        lines, self._rest = whole_lines(self._rest, chunk)
        if not lines:
            return
        if self._is_head:
            self._is_head = False
            del lines[0]
        for row in csv.reader(lines):
            if self._rows and self._rows[0][0] != row[0]:
                self._write()
            self._rows.append(row)

    def finish(self) -> None:
        """Write the last rule."""
        if self._rows:
            self._write()

    def _write(self) -> None:
        rows = self._rows
        self._writer.writerow(_cells(rows, self._status))
        rows.clear()
        self.count += 1
        if self._progress and self.count % _TOLD == 0:
            self._progress(self.count)


def _cells(rows: Sequence[Sequence[str]], status: str) -> tuple[str, ...]:
    """As `tables.cells` of the rule that these rows are of."""
    _, feature, context, functor, argument, lower, upper, speaker, time = rows[0]
    features, contexts = (feature,), (context,)
    if len(rows) > 1:
        features, contexts = _only(rows, 1), _only(rows, 2)
        if len(rows) != len(features) * len(contexts):
            raise ValidationError([f"{rows[0][0]}: a rule has something twice."])
    return (
        *(_features(features), _contexts(contexts), _functor(functor)),
        _argument(argument, functor),
        *(write_bound(float(lower)), write_bound(float(upper))),
        *(_speaker(speaker), status, _time(time)),
    )


def _only(rows: Sequence[Sequence[str]], column: int) -> tuple[str, ...]:
    return tuple(sorted({row[column] for row in rows}))


@lru_cache(maxsize=2**16)
def _features(nodes: tuple[str, ...]) -> str:
    return write_atoms(frozenset(map(stars.atom_of, _named(nodes))), FEATURE_KIND)


@lru_cache(maxsize=2**16)
def _contexts(nodes: tuple[str, ...]) -> str:
    return write_atoms(frozenset(map(stars.atom_of, _named(nodes))), CONTEXT_KIND)


def _named(nodes: tuple[str, ...]) -> Iterator[Iri]:
    return (Iri(node) for node in nodes if node)


@lru_cache(maxsize=2**12)
def _functor(node: str) -> str:
    return stars.functor_of(Iri(node))


@lru_cache(maxsize=2**16)
def _argument(node: str, functor: str) -> str:
    return (
        write_atom(stars.atom_of(Iri(node)), ARGUMENT_KINDS.get(_functor(functor))) if node else ""
    )


@lru_cache(maxsize=2**16)
def _speaker(node: str) -> str:
    return split(Iri(node))[1]


@lru_cache(maxsize=2**16)
def _time(text: str) -> str:
    return write_time(read_time(text)) if text else ""
