"""Rules as texts, one for each of `COLUMNS`, and as a table of them, in CSV.

An atom is written with its kind, "property:red". The usual kind is left out: a bare feature is an
object, a bare context an action, and what something is used for is an affordance.

A table has one rule a row, for spreadsheets and for millions of rules. The columns may have any
order; `features`, `functor` and `lower` are required. A semicolon separates several atoms.
"""

import csv
from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from operator import itemgetter
from typing import Any, TextIO, TypeVar

from ...ontology.errors import DataError, HiltError, ValidationError
from ..interval import DIGITS, VACUOUS, Interval
from ..rdf.rule_mapping import ANY as ANY_OBJECT
from ..rdf.rule_mapping import STATUSES
from ..rdf.terms import read_time, write_time
from ..rule import ARGUMENT_KINDS, DEFAULT_SPEAKER, Atom, Rule

COLUMNS = (  # of a rule as texts
    *("features", "contexts", "functor", "argument", "lower", "upper"),
    *("speaker", "status", "time"),
)
REQUIRED = ("features", "functor", "lower")
ANY = "*"  # any object
BETWEEN = "; "  # two atoms
FEATURE_KIND, CONTEXT_KIND = "object", "action"
MAX_MISTAKES = 20  # of a file that are reported
Thing = TypeVar("Thing")
Read = TypeVar("Read")


def read_atom(text: str, kind: str | None) -> Atom:
    """Return the atom that a text names.

    >>> str(read_atom("knife", "object")), str(read_atom("property:red", "object"))
    ('object:knife', 'property:red')

    `kind` is that of a bare name; None where it must be written. ValidationError if it is no atom.
    """
    if ":" in (name := text.strip()):
        before, _, after = name.partition(":")
        return Atom(before.strip(), after.strip())
    if kind is None:
        raise ValidationError([f'"{name[:60]}" needs its kind, as "part:{name[:60]}".'])
    return Atom(kind, name)


def read_all(things: Iterable[Thing], read: Callable[[Thing], Read]) -> Iterator[Read]:
    """Iterate over the rules of a file; after a mistake only further mistakes are looked for.

    Both `read` and the iteration may fail; a DataError lists the first `MAX_MISTAKES` mistakes.
    """
    wrong: list[DataError] = []
    try:
        for thing in things:
            try:
                rule = read(thing)
            except DataError as error:
                wrong.append(error)
                if len(wrong) == MAX_MISTAKES:
                    break
                continue
            if not wrong:
                yield rule
    except DataError as error:
        wrong.append(error)
    if wrong:
        raise DataError.together(wrong)


def write_atom(atom: Atom, kind: str | None) -> str:
    """Return the text that `read_atom` reads."""
    return atom.name if atom.kind == kind else str(atom)


def read_atoms(texts: Iterable[str], kind: str) -> frozenset[Atom]:
    """Return the atoms of several texts; "*" stands for no atom."""
    return frozenset(read_atom(text, kind) for text in texts if text.strip() != ANY)


def read_source(speaker: str, status: str, time: str) -> dict[str, Any]:
    """Return who said a rule and when, and its status; empty texts are for the defaults.

    ValidationError if no status has that name, or the text is no time with its zone.
    """
    if status and status not in STATUSES:
        raise ValidationError([f'"{status[:60]}" is no status; expected {", ".join(STATUSES)}.'])
    try:
        moment = read_time(time.strip().replace(" ", "T")) if time else None
    except ValueError as error:
        problem = f'"{time[:60]}" is no time with its zone, as 2026-11-21T09:00:00Z.'
        raise ValidationError([problem]) from error
    return {"speaker": speaker or DEFAULT_SPEAKER, "status": status or "active", "time": moment}


def read_rule(cells: Sequence[str]) -> Rule:
    """Return the rule of texts, one for each of `COLUMNS`; HiltError if one is malformed."""
    features, contexts, functor, argument, lower, upper, *source = map(str.strip, cells)
    seen, interval = split_atoms(features, FEATURE_KIND), read_interval(lower, upper)
    rule = _rule_about_any(contexts, functor, argument, *source)
    return rule.restated(seen, interval.rounded(), time=rule.time)


def write_texts(rule: Rule, *, bare: bool) -> tuple[str, ...]:
    """Return the texts that `read_rule` reads, `bare` without the usual kinds of atoms."""
    usual = (FEATURE_KIND, CONTEXT_KIND, ARGUMENT_KINDS.get(rule.functor))
    feature_kind, context_kind, argument_kind = usual if bare else (None, None, None)
    return (
        _join(rule.features, feature_kind) or (ANY if bare else ""),
        _join(rule.contexts, context_kind),
        rule.functor,
        write_atom(rule.argument, argument_kind) if rule.argument else "",
        write_bound(rule.interval.lower),
        write_bound(rule.interval.upper),
        rule.speaker,
        rule.status,
        write_time(rule.time) if rule.time else "",
    )


def read_interval(lower: str, upper: str) -> Interval:
    """Return an interval, up to 1 without an upper bound; HiltError if it is none."""
    return Interval(_number(lower, "lower"), _number(upper, "upper") if upper.strip() else 1.0)


def write_bound(bound: float) -> str:
    """Return a bound without trailing zeros, as "0.95" and "1"."""
    return f"{bound:.{DIGITS}f}".rstrip("0").rstrip(".")


@lru_cache(maxsize=2**16)
def split_atoms(text: str, kind: str) -> frozenset[Atom]:
    """Return the atoms of a text with semicolons between them; as `read_atoms`."""
    return read_atoms(filter(str.strip, text.split(";")), kind)


def read_table(lines: Iterable[str], *, source: str) -> Iterator[Rule]:
    """Iterate over the rules of a table, in its order.

    The first line names the columns. A DataError lists the first malformed rows with their lines.
    """
    rows = _rows(lines, source)
    _, first = next(rows, (1, []))
    names = _header(first, source)
    # A column that is missing is found behind the last one.
    in_order = itemgetter(*(names.index(name) if name in names else len(names) for name in COLUMNS))

    def read(numbered: tuple[int, list[str]]) -> Rule:
        line, row = numbered
        try:
            if len(row) != len(names):
                problem = f"expected {len(names)} cells, one for each column, found {len(row)}."
                raise ValidationError([problem])
            return read_rule(in_order((*row, "")))
        except HiltError as error:
            raise DataError(str(error), source=source, line=line) from error

    yield from read_all(rows, read)


def write_table(target: TextIO, rules: Iterable[Rule]) -> None:
    """Write a table with a row for each rule."""
    writer = csv.writer(target, lineterminator="\n")
    writer.writerow(COLUMNS)
    writer.writerows(write_texts(rule, bare=True) for rule in rules)


@lru_cache(maxsize=2**16)
def _rule_about_any(contexts: str, functor: str, argument: str, *source: str) -> Rule:
    return Rule(
        frozenset([ANY_OBJECT]),
        split_atoms(contexts, CONTEXT_KIND),
        functor,
        read_atom(argument, ARGUMENT_KINDS.get(functor)) if argument else None,
        VACUOUS,
        **read_source(*source),
    )


def _number(text: str, column: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise ValidationError([f'expected a number as {column}, found "{text[:60]}".']) from error


@lru_cache(maxsize=2**16)
def _join(atoms: frozenset[Atom], kind: str | None) -> str:
    return BETWEEN.join(write_atom(atom, kind) for atom in sorted(atoms))


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
        expected = f"{', '.join(COLUMNS)} ({', '.join(REQUIRED)} at least)"
        problem = f"expected {expected}, found {', '.join(found)[:200] or 'none'}."
        raise DataError(f"the first line names the columns; {problem}", source=source, line=1)
    return found
