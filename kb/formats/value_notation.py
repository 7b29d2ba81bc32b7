"""Atoms, intervals, statuses and times as text: what the rule sheet and the table share.

An atom is written with its kind, "property:red". The usual kind is left out: a bare feature is an
object, a bare context an action, and what something is used for is an affordance.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from functools import lru_cache
from typing import Any, TypeVar, get_args

from ...ontology.errors import DataError, ValidationError
from ..interval import DIGITS, Interval
from ..rdf.terms import read_time
from ..rule import ARGUMENT_KINDS, DEFAULT_SPEAKER, Atom, Rule, Status

COLUMNS = (  # of a rule as texts
    *("features", "contexts", "functor", "argument", "lower", "upper"),
    *("speaker", "status", "time"),
)
ANY = "*"  # any object
BETWEEN = "; "  # two atoms
FEATURE_KIND, CONTEXT_KIND = "object", "action"
MAX_MISTAKES = 20  # of a file that are reported
Thing = TypeVar("Thing")
Read = TypeVar("Read")
STATUSES: tuple[str, ...] = get_args(Status)


def read_atom(text: str, kind: str | None) -> Atom:
    """Return the atom that a text names.

    >>> str(read_atom("knife", "object")), str(read_atom("property:red", "object"))
    ('object:knife', 'property:red')

    `kind` is that of a bare name; None where the kind must be written. ValidationError if it names
    no atom.
    """
    name = text.strip()
    if ":" in name:
        before, _, after = name.partition(":")
        return Atom(before.strip(), after.strip())
    if kind is None:
        raise ValidationError([f'"{name[:60]}" needs its kind, as "part:{name[:60]}".'])
    return Atom(kind, name)


def read_all(things: Iterable[Thing], read: Callable[[Thing], Read]) -> Iterator[Read]:
    """Iterate over the rules of a file; after a mistake only further mistakes are looked for.

    `read` returns the rule of a row or entry; to iterate over `things` may fail, too. DataError if
    lists the first mistakes, at most `MAX_MISTAKES`.
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


def read_argument(text: str, functor: str) -> Atom | None:
    """Return the argument of a functor, None for an empty text."""
    return read_atom(text, ARGUMENT_KINDS.get(functor)) if text.strip() else None


def read_source(speaker: str, status: str, time: str) -> dict[str, Any]:
    """Return who said a rule and when, and its status; empty texts are for the defaults.

    ValidationError if no status has that name, or the text is no time with its zone.
    """
    if status and status not in STATUSES:
        raise ValidationError([f'"{status[:60]}" is no status; expected {", ".join(STATUSES)}.'])
    try:
        moment = read_time(time.strip().replace(" ", "T")) if time else None
    except ValueError as error:
        raise ValidationError(
            [f'"{time[:60]}" is no time with its zone, as 2026-11-21T09:00:00Z.']
        ) from error
    source = {"speaker": speaker or DEFAULT_SPEAKER, "status": status or "active"}
    return {**source, "time": moment}


def read_rule(cells: Sequence[str]) -> Rule:
    """Return the rule of texts, one for each of `COLUMNS`; HiltError if one is malformed."""
    features, contexts, functor, argument, lower, upper, *source = map(str.strip, cells)
    return Rule(
        split_atoms(features, FEATURE_KIND),
        split_atoms(contexts, CONTEXT_KIND),
        functor,
        read_argument(argument, functor),
        read_interval(lower, upper),
        **read_source(*source),
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


def _number(text: str, column: str) -> float:
    try:
        return float(text)
    except ValueError as error:
        raise ValidationError([f'expected a number as {column}, found "{text[:60]}".']) from error
