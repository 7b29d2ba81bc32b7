# SPDX-License-Identifier: Apache-2.0
"""Reader of the notation for categories, lambda terms, types and pragmatic rules.

The language data is written in one small grammar, `notation.lark`. Each line is parsed once and
kept in a cache on disk, so that a language that was loaded before needs no parser. A mistake
becomes a `DataError` with file, line, column and what was expected.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from typing import TYPE_CHECKING, cast

from ...ontology.yaml_reader import Field
from .categories import Category
from .notation_cache import NotationCache
from .terms import Term
from .types import BASIC_TYPES, Basic, Type

if TYPE_CHECKING:
    from .notation_parser import Entry, Start, TermPair, UnaryRule, Value

MAX_CHARACTERS = 400
"""A longer line is rejected, so that none can nest too deeply to be used."""


def read_entry(field: Field) -> Entry:
    """Read the category of a word, its term and its cost: `NP/N : λx.x @1`."""
    return cast("Entry", _read(field, "entry"))


def read_unary(field: Field) -> UnaryRule:
    """Read a unary rule, which changes a category: `R => S : λr.r(high)`."""
    return cast("UnaryRule", _read(field, "unary"))


def read_rule(field: Field) -> TermPair:
    """Read both sides of a pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    return cast("TermPair", _read(field, "rule"))


def read_category(field: Field) -> Category:
    """Read a category: `(S/C)/C`."""
    return cast("Category", _read(field, "category"))


def read_type(field: Field) -> Type:
    """Read a type: `e -> e -> t`."""
    found = cast("Type", _read(field, "type"))
    for name in _basic_types(found):
        if name not in BASIC_TYPES:
            raise field.fail(f'expected one of {", ".join(BASIC_TYPES)}, found the type "{name}".')
    return found


def parse_term(text: str) -> Term:
    """Parse a lambda term that stands in no file; for tests and examples."""
    return cast("Term", _read(Field(text, "<text>", 1, 0), "term"))


def save_cache() -> None:
    """Save the lines that were parsed, so that the next program need not parse them again."""
    _cache().save()


def _read(field: Field, start: Start) -> Value:
    text = field.text()
    if len(text) > MAX_CHARACTERS:
        raise field.fail(f"expected at most {MAX_CHARACTERS} characters, found {len(text)}.")
    found = _cache().get(text, start)
    if found is None:
        from .notation_parser import parse  # here: lark takes 0.1 s to import and start

        found = parse(field, start)
        _cache().add(text, start, found)
    return found


@cache
def _cache() -> NotationCache:
    return NotationCache()


def _basic_types(found: Type) -> Iterator[str]:
    if isinstance(found, Basic):
        yield found.name
    else:
        yield from _basic_types(found.source)
        yield from _basic_types(found.target)
