# SPDX-License-Identifier: Apache-2.0
"""Reader of the notation in which the language data is written.

One small grammar (`notation.lark`) has the categories, lambda terms, types and pragmatic rules.
A mistake becomes a `DataError` with file, line, column and what was expected.
"""

from __future__ import annotations

from functools import cache, lru_cache
from typing import TYPE_CHECKING, cast

from ...ontology.errors import DataError
from ..semantics.predicates import Form, form_of_term
from .remembered import NotationCache
from .types import BASIC_TYPES, Basic

if TYPE_CHECKING:
    from collections.abc import Iterator

    from ...ontology.yaml_reader import Field
    from .categories import Category
    from .reader import Change, Entry, Pair, Start, Value
    from .terms import Term
    from .types import Type

MAX_CHARACTERS = 400
"""A longer line is refused, so that none can nest too deeply to be used."""

MAX_REMEMBERED = 4096
"""Many lines of a language are the same, and are read once."""


class MistakeError(Exception):
    """A text is not written as the grammar says.

    Attributes:
        problem: what was expected, and what is there.
        offset: at which of its characters.
    """

    def __init__(self, problem: str, offset: int) -> None:
        super().__init__(problem, offset)
        self.problem, self.offset = problem, offset


def read_entry(field: Field) -> Entry:
    """A category, the term of a word that has it, and its cost: `NP/N : λx.x @1`."""
    return cast("Entry", _read(field, "entry"))


def read_unary(field: Field) -> Change:
    """A change of category: `R => S : λr.r(high)`."""
    return cast("Change", _read(field, "unary"))


def read_rule(field: Field) -> tuple[Form, Form]:
    """A pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    left, right = cast("Pair", _read(field, "rule"))
    try:
        return form_of_term(left), form_of_term(right)
    except ValueError as error:
        raise field.fail("expected predicate forms without functions.") from error


def read_category(field: Field) -> Category:
    """A category alone: `(S/C)/C`."""
    return cast("Category", _read(field, "category"))


def read_type(field: Field) -> Type:
    """A type: `e -> e -> t`."""
    found = cast("Type", _read(field, "type"))
    for name in _names(found):
        if name not in BASIC_TYPES:
            raise field.fail(f'expected one of {", ".join(BASIC_TYPES)}, found the type "{name}".')
    return found


def parse_term(text: str) -> Term:
    """A lambda term from a text; for tests and examples."""
    from ...ontology.yaml_reader import Field  # here: only for a text that stands in no file

    return cast("Term", _read(Field(text, "<text>", 1, 0), "term"))


def _read(field: Field, start: Start) -> Value:
    text = field.text()
    if len(text) > MAX_CHARACTERS:
        raise field.fail(f"expected at most {MAX_CHARACTERS} characters, found {len(text)}.")
    try:
        return _value(text, start)
    except MistakeError as error:
        raise DataError(
            error.problem,
            source=field.source,
            line=field.line,
            # Such texts stand in quotes, because they hold a colon or an arrow.
            column=field.column + 1 + error.offset,
        ) from error


@cache
def _lines() -> NotationCache:
    return NotationCache()


def keep_lines() -> None:
    """Keep what was read, so that the next program need not read it again."""
    _lines().keep()


@lru_cache(MAX_REMEMBERED)
def _value(text: str, start: Start) -> Value:
    found = _lines().recall(text, start)
    if found is None:
        from .reader import read  # here, with lark: who reads nothing new should not pay for it

        found = read(text, start)
        _lines().add(text, start, found)
    return found


def _names(found: Type) -> Iterator[str]:
    if isinstance(found, Basic):
        yield found.name
    else:
        yield from _names(found.source)
        yield from _names(found.target)
