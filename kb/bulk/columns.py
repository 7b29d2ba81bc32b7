# SPDX-License-Identifier: Apache-2.0
"""A large base as a table or a sheet, from one pass over it, without making a rule of each.

What a statement says of its rule is worked out once for all rules that have the same; a test holds
the cells to those that a `Rule` gives.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from functools import lru_cache

from ...ontology.errors import ValidationError
from ...ontology.vocabulary import PREFIXES, Iri, split
from ..formats.csv_table import COLUMNS, Writable, begin_table, write_atoms, write_bound
from ..formats.notation import ANY, CONTEXT_KIND, FEATURE_KIND, write_atom
from ..formats.streams import Progress
from ..rdf import rule_mapping
from ..rdf.rule_mapping import BELIEFS
from ..rdf.terms import read_time, write_time
from ..rule import ARGUMENT_KINDS, Atom
from ..stores.base import Store
from .scanning import TAILS, scan

Cells = Sequence[str]  # of one rule, as `tables.COLUMNS` names them

_RULES = f"<{PREFIXES['rule']}"
_MAX_KNOWN = 100_000  # statements that are remembered
_TOLD = 10_000  # rules after which the progress is told
_PLACES = {
    **{
        rule_mapping.FEATURE: "features",
        rule_mapping.CONTEXT: "contexts",
        rule_mapping.FUNCTOR: "functor",
    },
    **dict.fromkeys(
        (rule_mapping.PART, rule_mapping.AFFORDANCE, rule_mapping.ARGUMENT), "argument"
    ),
    **{
        rule_mapping.LOWER: "lower",
        rule_mapping.UPPER: "upper",
        rule_mapping.ATTRIBUTED_TO: "speaker",
    },
    **{rule_mapping.STATUS: "status", rule_mapping.GENERATED_AT: "time"},
}
_FEATURES, _CONTEXTS, _FUNCTOR, _ARGUMENT, _LOWER, _UPPER, _SPEAKER, _STATUS, _TIME = range(9)
_NEEDED = (_FUNCTOR, _LOWER, _UPPER, _SPEAKER, _STATUS)


def write_columns(store: Store, target: Writable, progress: Progress | None = None) -> int:
    """Write a table of every rule of a store, whatever its status; how many that are.

    Args:
        store: one that `dumping.is_large` says yes to.
        target: takes the text.
        progress: is told how many rules are written.

    Raises:
        OSError: `target` raised it.
        StoreError: the store cannot be read.
        ValidationError: a rule of it lacks something, or has it twice.
    """
    return scan_rules(store, begin_table(target).writerows, progress)


def scan_rules(
    store: Store, take: Callable[[Iterable[Cells]], object], progress: Progress | None = None
) -> int:
    """Give the cells of every rule of a store, some rules at a time; as `write_columns`."""
    rows = _Rows(take, progress)
    scan(store, BELIEFS, rows.feed, keys=_PLACES)
    rows.finish()
    return rows.count


class _Rows:
    """Makes rows of the statements about rules."""

    def __init__(self, take: Callable[[Iterable[Cells]], object], progress: Progress | None):
        self.count = 0
        self._take, self._progress = take, progress
        self._node, self._tails = "", list[str]()  # of the rule at hand
        self._known = _Known()
        self._told = 0

    def feed(self, lines: Sequence[str]) -> None:
        """Take some statements."""
        rows: list[Cells] = []
        for line in lines:
            node, tail = line.split("\t", 1)
            if node != self._node:
                self._end(rows)
                self._node = node
            self._tails.append(tail)
        self._give(rows)

    def finish(self) -> None:
        """There are no more."""
        rows: list[Cells] = []
        self._end(rows)
        self._give(rows)

    def _give(self, rows: Sequence[Cells]) -> None:
        self._take(rows)
        self.count += len(rows)
        if self._progress and self.count - self._told >= _TOLD:
            self._told = self.count
            self._progress(self.count)

    def _end(self, rows: list[Cells]) -> None:
        """What comes next is about another node."""
        if self._node.startswith(_RULES):
            try:
                rows.append(self._cells())
            except ValidationError as error:
                raise ValidationError([f"{self._node}: {one}" for one in error.findings]) from error
        self._tails.clear()

    def _cells(self) -> Cells:
        """As `tables.write_table` writes the rule."""
        cells = [""] * len(COLUMNS)
        known, several = self._known, False
        for tail in self._tails:
            place, cell = known[tail]
            if place is None:
                continue
            if cells[place]:
                several = several or place in {_FEATURES, _CONTEXTS}
                if not several:
                    raise ValidationError([f"a rule has something twice: {COLUMNS[place]}."])
            cells[place] = cell
        missing = [COLUMNS[place] for place in _NEEDED if not cells[place]]
        if missing:
            raise ValidationError([f"a rule is not whole; it has no {missing[0]}."])
        if several:
            cells[:2] = self._atoms(_FEATURES, FEATURE_KIND), self._atoms(_CONTEXTS, CONTEXT_KIND)
        if cells[_ARGUMENT]:
            cells[_ARGUMENT] = _argument(cells[_ARGUMENT], cells[_FUNCTOR])
        cells[_FEATURES] = cells[_FEATURES] or ANY
        return cells

    def _atoms(self, place: int, kind: str) -> str:
        """The cell of a rule with several features or contexts."""
        values = [tail.rpartition("\t")[2] for tail in self._tails if self._known[tail][0] == place]
        return write_atoms(frozenset(map(_atom, values)), kind)


class _Known(dict[str, tuple[int | None, str]]):
    """What statements mean for a row: the place of a cell, if they are in any, and the cell."""

    def __missing__(self, tail: str) -> tuple[int | None, str]:
        number, other, value = tail.split("\t")
        key, end = TAILS[int(number) - 1] if number != "0" else (Iri(other[1:-1]), None)
        name = _PLACES.get(key)
        place = None if name is None else COLUMNS.index(name)
        found = place, "" if place is None else _cell(place, f"<{end}>" if end else value)
        if len(self) >= _MAX_KNOWN:
            self.clear()
        self[tail] = found
        return found


def _cell(place: int, value: str) -> str:
    """What a value says in a cell; an argument is left as it is, until its functor is known."""
    if place == _FEATURES:
        return write_atom(_atom(value), FEATURE_KIND)
    if place == _CONTEXTS:
        return write_atom(_atom(value), CONTEXT_KIND)
    if place in {_FUNCTOR, _STATUS}:
        return rule_mapping.functor_from_iri(_node(value))
    if place == _SPEAKER:
        return split(_node(value))[1]
    if place == _ARGUMENT:
        return value
    text = value.split('"')[1] if value.startswith('"') else value
    return write_time(read_time(text)) if place == _TIME else write_bound(float(text))


@lru_cache(maxsize=2**16)
def _argument(value: str, functor: str) -> str:
    return write_atom(_atom(value), ARGUMENT_KINDS.get(functor))


def _atom(value: str) -> Atom:
    return rule_mapping.atom_from_iri(_node(value))


def _node(value: str) -> Iri:
    return Iri(value[1:-1])
