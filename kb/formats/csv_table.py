"""Rules as a table: CSV with one rule a row, for spreadsheets and for millions of rules.

The columns may have any order; `features`, `functor` and `lower` are required. A semicolon
separates several atoms in one cell.
"""

import csv
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from operator import itemgetter
from typing import TextIO

from ...ontology.errors import DataError, HiltError, ValidationError
from ..bulk.nquads_reader import remember
from ..rdf.terms import write_time
from ..rule import ARGUMENT_KINDS, Atom, Rule
from . import value_notation
from .value_notation import COLUMNS

REQUIRED = ("features", "functor", "lower")


def read_table(lines: Iterable[str], *, source: str) -> Iterator[Rule]:
    """Iterate over the rules of a table, in its order.

    The first line has the names of the columns. DataError if rows are malformed; lists the first
    mistakes with their lines.
    """
    rows = _rows(lines, source)
    _, first = next(rows, (1, []))
    yield from value_notation.read_all(rows, _RowReader(_header(first, source), source).read)


def write_table(target: TextIO, rules: Iterable[Rule]) -> None:
    """Write a table with a row for each rule."""
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(map(_cells, rules))


def _cells(rule: Rule) -> tuple[str, ...]:
    argument_kind = ARGUMENT_KINDS.get(rule.functor)
    return (
        _write_atoms(rule.features, value_notation.FEATURE_KIND),
        _write_atoms(rule.contexts, value_notation.CONTEXT_KIND),
        rule.functor,
        value_notation.write_atom(rule.argument, argument_kind) if rule.argument else "",
        value_notation.write_bound(rule.interval.lower),
        value_notation.write_bound(rule.interval.upper),
        rule.speaker,
        rule.status,
        write_time(rule.time) if rule.time else "",
    )


@lru_cache(maxsize=2**16)
def _write_atoms(atoms: frozenset[Atom], kind: str) -> str:
    text = value_notation.BETWEEN.join(
        value_notation.write_atom(atom, kind) for atom in sorted(atoms)
    )
    return text or (value_notation.ANY if kind == value_notation.FEATURE_KIND else "")


def _rows(lines: Iterable[str], source: str) -> Iterator[tuple[int, list[str]]]:
    reader = csv.reader(lines, strict=True)
    try:
        for row in reader:
            if row:
                yield reader.line_num, row
    except csv.Error as error:
        raise DataError(f"is no CSV: {error}.", source=source, line=reader.line_num) from error


def _header(names: Sequence[str], source: str) -> list[str]:
    found = [name.strip().lower() for name in names]
    missing = [name for name in REQUIRED if name not in found]
    unknown = [name for name in found if name not in COLUMNS]
    if missing or unknown or len(set(found)) < len(found):
        raise DataError(
            f"the first line names the columns; expected {', '.join(COLUMNS)} "
            f"({', '.join(REQUIRED)} at least), found {', '.join(found)[:200] or 'none'}.",
            source=source,
            line=1,
        )
    return found


class _RowReader:
    """Makes rules of rows; what several rows share is read once."""

    def __init__(self, names: Sequence[str], source: str) -> None:
        self._count, self._source = len(names), source
        # A column that is missing is found behind the last one.
        places = (names.index(name) if name in names else len(names) for name in COLUMNS)
        self._in_order = itemgetter(*places)
        self._known: dict[tuple[str, ...], Rule] = {}

    def read(self, numbered: tuple[int, list[str]]) -> Rule:
        line, row = numbered
        try:
            if len(row) != self._count:
                raise ValidationError(
                    [f"expected {self._count} cells, one for each column, found {len(row)}."]
                )
            return self._read(self._in_order((*row, "")))
        except HiltError as error:
            raise DataError(str(error), source=self._source, line=line) from error

    def _read(self, cells: Sequence[str]) -> Rule:
        features, *shared, lower, upper, speaker, status, time = cells
        known = self._known.get(key := (*shared, speaker, status, time))
        if known is None:
            return remember(self._known, key, value_notation.read_rule(cells))
        seen = value_notation.split_atoms(features.strip(), value_notation.FEATURE_KIND)
        return known.restated(seen, value_notation.read_interval(lower, upper), time=known.time)
