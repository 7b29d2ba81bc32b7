# SPDX-License-Identifier: Apache-2.0
"""Rules as a table: CSV with one rule a row, for spreadsheets and for millions of rules.

The columns may stand in any order; `features`, `functor` and `lower` must be there. Several atoms
in one cell are separated by a semicolon.
"""

from __future__ import annotations

import csv
import math
from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from operator import itemgetter
from typing import Protocol

from ...ontology.errors import DataError, HiltError, ValidationError
from ..bulk.rule_lines import RuleSerializer, RuleTemplate, SerializedRule, make_room
from ..interval import DIGITS
from ..rdf.terms import write_time
from ..rule import ARGUMENT_KINDS, Atom, Rule
from . import notation

COLUMNS = (
    *("features", "contexts", "functor", "argument", "lower", "upper"),
    *("speaker", "status", "time"),
)
REQUIRED = ("features", "functor", "lower")
_BETWEEN = "; "


class Writable(Protocol):
    """What a table is written to."""

    def write(self, text: str, /) -> object:
        """Take some text."""
        ...


class Writer(Protocol):
    """What writes the lines of a table."""

    def writerow(self, row: Sequence[str], /) -> object:
        """Write a line with these cells."""
        ...

    def writerows(self, rows: Iterable[Sequence[str]], /) -> object:
        """Write several lines."""
        ...


class _Reader(Protocol):
    @property
    def line_num(self) -> int: ...

    def __iter__(self) -> Iterator[list[str]]: ...


def read_table(lines: Iterable[str], *, source: str) -> Iterator[SerializedRule]:
    """The rules of a table, in its order.

    Args:
        lines: of the CSV, the first with the names of the columns.
        source: its name in messages.

    Raises:
        DataError: something is wrong; says in which line, of several mistakes each.
    """
    rows = _rows(csv.reader(lines, strict=True), source)
    _, first = next(rows, (1, []))
    yield from notation.read_all(rows, _Rows(_header(first, source), source).star)


def begin_table(target: Writable) -> Writer:
    """Begin a table; what is returned adds lines to it."""
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(COLUMNS)
    return writer


def write_table(rules: Iterable[Rule], target: Writable) -> None:
    """Write a table with these rules."""
    begin_table(target).writerows(map(_cells, rules))


@lru_cache(maxsize=2**16)
def write_atoms(atoms: frozenset[Atom], kind: str) -> str:
    """The cell of the features or contexts of a rule."""
    text = _BETWEEN.join(notation.write_atom(atom, kind) for atom in sorted(atoms))
    return text or (notation.ANY if kind == notation.FEATURE_KIND else "")


def write_bound(bound: float) -> str:
    """The cell of a bound."""
    return f"{bound:.{DIGITS}f}".rstrip("0").rstrip(".")


def _rows(reader: _Reader, source: str) -> Iterator[tuple[int, list[str]]]:
    """The rows that hold something, each with the line at which it ends."""
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


class _Rows:
    """Makes rules of rows; what comes again is read once."""

    def __init__(self, names: Sequence[str], source: str) -> None:
        self._count, self._source = len(names), source
        # A column that is not there is found behind the last one.
        places = (names.index(name) if name in names else len(names) for name in COLUMNS)
        self._in_order = itemgetter(*places)
        self._stamps = RuleSerializer()
        self._frames: dict[tuple[str, ...], RuleTemplate] = {}

    def star(self, numbered: tuple[int, list[str]]) -> SerializedRule:
        """The rule of a row, given with its line."""
        line, row = numbered
        try:
            if len(row) != self._count:
                raise ValidationError(
                    [f"expected {self._count} cells, one for each column, found {len(row)}."]
                )
            return self._star(self._in_order((*row, "")))
        except HiltError as error:
            raise DataError(str(error), source=self._source, line=line) from error

    def _star(self, cells: Sequence[str]) -> SerializedRule:
        features, contexts, functor, argument, lower, upper, speaker, status, time = cells
        key = (contexts, functor, argument, speaker, status)
        frame = self._frames.get(key)
        if frame and not time:
            belief, low = _bound(lower)
            plausibility, high = _bound(upper or "1")
            if 0.0 <= belief <= plausibility <= 1.0:
                seen = self._stamps.seen(_atoms(features, notation.FEATURE_KIND))
                return self._stamps.star(frame, seen, low, high)
        rule = read_row(cells)  # which also says what is wrong
        if not frame:
            make_room(self._frames)
            self._frames[key] = self._stamps.frame(rule)
        return self._stamps.of(rule)


def read_row(cells: Sequence[str]) -> Rule:
    """The rule of a row with all columns.

    Raises:
        HiltError: something is wrong with a cell.
    """
    features, contexts, functor, argument, lower, upper, *told = map(str.strip, cells)
    speaker, status, time = told
    return notation.make_rule(
        _atoms(features, notation.FEATURE_KIND),
        _atoms(contexts, notation.CONTEXT_KIND),
        functor,
        notation.read_argument(argument, functor),
        notation.read_interval(_number(lower, "lower"), _number(upper, "upper") if upper else None),
        speaker=speaker,
        status=status,
        time=time,
    )


@lru_cache(maxsize=2**16)
def _bound(cell: str) -> tuple[float, str]:
    """A bound and how it is written in full; no number where the cell has none."""
    try:
        bound = float(cell)
    except ValueError:
        return math.nan, ""
    return bound, f"{bound + 0.0:.{DIGITS}f}"  # -0.0 + 0.0 is 0.0


def _number(cell: str, column: str) -> float:
    try:
        return float(cell)
    except ValueError as error:
        raise ValidationError([f'expected a number as {column}, found "{cell[:60]}".']) from error


@lru_cache(maxsize=2**16)
def _atoms(cell: str, kind: str) -> frozenset[Atom]:
    return notation.read_atoms(filter(str.strip, cell.split(";")), kind)


def _cells(rule: Rule) -> tuple[str, ...]:
    argument_kind = ARGUMENT_KINDS.get(rule.functor)
    return (
        write_atoms(rule.features, notation.FEATURE_KIND),
        write_atoms(rule.contexts, notation.CONTEXT_KIND),
        rule.functor,
        notation.write_atom(rule.argument, argument_kind) if rule.argument else "",
        write_bound(rule.interval.lower),
        write_bound(rule.interval.upper),
        rule.speaker,
        rule.status,
        write_time(rule.time) if rule.time else "",
    )
