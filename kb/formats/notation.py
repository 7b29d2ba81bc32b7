# SPDX-License-Identifier: Apache-2.0
"""Rules in words that a person can type: what the rule sheet and the table have in common.

An atom is written with its kind, "property:red". Where the kind is plain it is left out: a bare
feature is an object, a bare context an action, and what something is used for is an affordance.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from datetime import datetime
from typing import TypeVar, cast, get_args

from ...ontology.errors import DataError, ValidationError
from ..interval import Interval
from ..rdf.terms import read_time
from ..rule import ARGUMENT_KINDS, DEFAULT_SPEAKER, Atom, Rule, Status

ANY = "*"  # any object
FEATURE_KIND, CONTEXT_KIND = "object", "action"
MAX_MISTAKES = 20  # of a file that are told
Thing = TypeVar("Thing")
Read = TypeVar("Read")
STATUSES: tuple[str, ...] = get_args(Status)


def read_atom(text: str, kind: str | None) -> Atom:
    """The atom that a text names.

    >>> str(read_atom("knife", "object")), str(read_atom("property:red", "object"))
    ('object:knife', 'property:red')

    Args:
        text: a name, or a kind and a name.
        kind: of a bare name; None where the kind must be written.

    Raises:
        ValidationError: it names none.
    """
    name = text.strip()
    if ":" in name:
        before, _, after = name.partition(":")
        return Atom(before.strip(), after.strip())
    if kind is None:
        raise ValidationError([f'"{name[:60]}" needs its kind, as "part:{name[:60]}".'])
    return Atom(kind, name)


def read_all(things: Iterable[Thing], read: Callable[[Thing], Read]) -> Iterator[Read]:
    """The rules that things of a file stand for; behind a mistake only others are looked for.

    Args:
        things: rows or entries; to go through them may fail, too.
        read: makes a rule of one.

    Raises:
        DataError: of the first mistakes, at most `MAX_MISTAKES`.
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
    """The text that `read_atom` reads."""
    return atom.name if atom.kind == kind else str(atom)


def read_atoms(texts: Iterable[str], kind: str) -> frozenset[Atom]:
    """The atoms of several texts; "*" stands for none."""
    return frozenset(read_atom(text, kind) for text in texts if text.strip() != ANY)


def read_argument(text: str, functor: str) -> Atom | None:
    """The argument of a functor, None for an empty text."""
    return read_atom(text, ARGUMENT_KINDS.get(functor)) if text.strip() else None


def read_interval(lower: float, upper: float | None) -> Interval:
    """An interval; it reaches up to 1 where no upper bound is given."""
    return Interval(lower, 1.0 if upper is None else upper)


def read_status(text: str) -> Status:
    """A status.

    Raises:
        ValidationError: there is none of that name.
    """
    if text not in STATUSES:
        raise ValidationError([f'"{text[:60]}" is no status; expected {", ".join(STATUSES)}.'])
    return cast(Status, text)


def read_moment(text: str) -> datetime:
    """A time with its zone.

    Raises:
        ValidationError: it is none.
    """
    try:
        return read_time(text.strip().replace(" ", "T"))
    except ValueError as error:
        raise ValidationError(
            [f'"{text[:60]}" is no time with its zone, as 2026-11-21T09:00:00Z.']
        ) from error


def make_rule(
    features: frozenset[Atom],
    contexts: frozenset[Atom],
    functor: str,
    argument: Atom | None,
    interval: Interval,
    *,
    speaker: str | None,
    status: str | None,
    time: str | None,
) -> Rule:
    """A rule of what was written; what is not given is as for a rule just told."""
    return Rule(
        features,
        contexts,
        functor,
        argument,
        interval,
        speaker or DEFAULT_SPEAKER,
        None,
        read_moment(time) if time else None,
        read_status(status) if status else "active",
    )
