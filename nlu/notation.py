# SPDX-License-Identifier: Apache-2.0
r"""Reader of the notation in which the language data is written.

A mistake becomes a `DataError` with file, line, column and what was expected. The grammar, in which
`{}` may be repeated and `[]` left out:

    entry     category ":" term ["@" number]
    unary     category "=>" category ":" term
    rule      term "=>" term
    category  simple {slash simple}             slash   "/" | "/^" | "\" | "\^"
    simple    name | "(" category ")"
    term      "λ" name "." term | group {group}    a "\" is a "λ" too
    group     name | "(" term {"," term} ")"
    type      basic ["->" type]
    basic     name | "(" type ")"

It is read by recursive descent, a thousand lines in the time a general parser needs to start.
"""

from __future__ import annotations

import re
from collections.abc import Callable
from functools import lru_cache, reduce
from string import ascii_letters
from typing import TYPE_CHECKING, TypeVar

from ..ontology.errors import DataError
from .categories import Atom, Category, Functor
from .predicates import Form, form_of_term
from .terms import Apply, Bound, Constant, Lambda, Term
from .typecheck import BASIC_TYPES, Arrow, Basic, Type

if TYPE_CHECKING:
    from ..ontology.source import Field

    Entry = tuple[Category, Term, float]
    Change = tuple[Category, Category, Term]
    Pair = tuple[Term, Term]

MAX_TOKENS = 400
"""A longer line is refused, so that none can nest too deeply to be read."""

MAX_REMEMBERED = 4096
"""Many lines of a language are the same, and are read once."""

_Read = TypeVar("_Read")

_TOKEN = re.compile(r"\s*([A-Za-z_][A-Za-z0-9_]*|-?\d+(?:\.\d+)?|=>|->|[/\\]\^?|\S)")
_NAME_BEGINS = frozenset(f"{ascii_letters}_")
_NAME, _NUMBER, _END = "a name", "a number", "the end"


def read_entry(field: Field) -> Entry:
    """A category, the term of a word that has it, and its cost: `NP/N : λx.x @1`."""
    return _read(_entry, field)


def read_unary(field: Field) -> Change:
    """A change of category: `R => S : λr.r(high)`."""
    return _read(_unary, field)


def read_rule(field: Field) -> tuple[Form, Form]:
    """A pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    left, right = _read(_rule, field)
    try:
        return form_of_term(left), form_of_term(right)
    except ValueError as error:
        raise field.fail("expected predicate forms without functions.") from error


def read_category(field: Field) -> Category:
    """A category alone: `(S/C)/C`."""
    return _read(_category, field)


def read_type(field: Field) -> Type:
    """A type: `e -> e -> t`."""
    return _read(_type, field)


def parse_term(text: str) -> Term:
    """A lambda term from a text; for tests and examples."""
    from ..ontology.source import Field  # here: only for a text that stands in no file

    return _read(_term, Field(text, "<text>", 1, 0))


class _MistakeError(Exception):
    """What is wrong with a text, and at which of its characters."""

    def __init__(self, problem: str, offset: int) -> None:
        super().__init__(problem, offset)
        self.problem, self.offset = problem, offset


class _Tokens:
    """The tokens of one text, with a place that moves on."""

    def __init__(self, text: str) -> None:
        self.text = text
        self.items = _TOKEN.findall(text)
        self.place = 0
        # All that was asked for at this place in vain: what a message says was expected.
        self._wanted: list[str] = []
        if len(self.items) > MAX_TOKENS:
            raise _MistakeError(f"expected at most {MAX_TOKENS} names and signs.", 0)
        self.items.append("")

    def take(self, *signs: str) -> str:
        """The sign that stands here, and on to the next; empty where none of them does."""
        found = self.items[self.place]
        if found in signs:
            return self._taken(found)
        self._wanted += signs
        return ""

    def name(self) -> str:
        """The name that stands here, and on to the next; empty where there is none."""
        found = self.items[self.place]
        if found[:1] in _NAME_BEGINS:
            return self._taken(found)
        self._wanted.append(_NAME)
        return ""

    def need(self, sign: str) -> None:
        """Go on past a sign that must stand here."""
        if not self.take(sign):
            raise self.mistake()

    def need_name(self) -> str:
        """The name that must stand here."""
        return self.name() or self._fail()

    def number(self) -> float:
        """The number that must stand here."""
        found = self.items[self.place]
        if not found.lstrip("-")[:1].isdigit():
            self._wanted.append(_NUMBER)
            raise self.mistake()
        return float(self._taken(found))

    def end(self) -> None:
        """Nothing may be left."""
        if self.items[self.place]:
            self._wanted.append(_END)
            raise self.mistake()

    def mistake(self) -> _MistakeError:
        """The error that says what was expected here."""
        offset = self._offset()
        rest = self.text[offset : offset + 12]
        kinds = {_NAME, _NUMBER, _END}
        wanted = {each if each in kinds else f'"{each}"' for each in self._wanted}
        expected = " or ".join(sorted(wanted))
        found = f'"{rest}"' if rest else _END
        return _MistakeError(f"expected {expected}, found {found} in {self.text!r}.", offset)

    def _taken(self, found: str) -> str:
        self.place += 1
        self._wanted.clear()
        return found

    def _fail(self) -> str:
        raise self.mistake()

    def _offset(self) -> int:
        starts = [found.start(1) for found in _TOKEN.finditer(self.text)]
        return starts[self.place] if self.place < len(starts) else len(self.text)


def _read(read: Callable[[_Tokens], _Read], field: Field) -> _Read:
    try:
        return _whole(read, field.text())
    except _MistakeError as error:
        raise DataError(
            error.problem,
            source=field.source,
            line=field.line,
            # Such texts stand in quotes, because they hold a colon or an arrow.
            column=field.column + 1 + error.offset,
        ) from error


@lru_cache(MAX_REMEMBERED)
def _whole(read: Callable[[_Tokens], _Read], text: str) -> _Read:
    tokens = _Tokens(text)
    found = read(tokens)
    tokens.end()
    return found


def _entry(tokens: _Tokens) -> Entry:
    category = _category(tokens)
    tokens.need(":")
    return category, _term(tokens), tokens.number() if tokens.take("@") else 0.0


def _unary(tokens: _Tokens) -> Change:
    source = _category(tokens)
    tokens.need("=>")
    target = _category(tokens)
    tokens.need(":")
    return source, target, _term(tokens)


def _rule(tokens: _Tokens) -> Pair:
    left = _term(tokens)
    tokens.need("=>")
    return left, _term(tokens)


def _category(tokens: _Tokens) -> Category:
    category = _simple(tokens)
    while slash := tokens.take("/", "\\", "/^", "\\^"):
        composes = slash.endswith("^")
        category = Functor(category, _simple(tokens), forward=slash[0] == "/", composes=composes)
    return category


def _simple(tokens: _Tokens) -> Category:
    if not tokens.take("("):
        return Atom(tokens.need_name())
    category = _category(tokens)
    tokens.need(")")
    return category


def _term(tokens: _Tokens, names: tuple[str, ...] = ()) -> Term:
    if tokens.take("λ", "\\"):
        name = tokens.need_name()
        tokens.need(".")
        return Lambda(_term(tokens, (name, *names)), name)
    parts = _group(tokens, names)
    if not parts:
        raise tokens.mistake()
    while further := _group(tokens, names):
        parts += further
    return reduce(Apply, parts)


def _group(tokens: _Tokens, names: tuple[str, ...]) -> list[Term]:
    """A name, or the terms in a bracket; none where neither stands."""
    if name := tokens.name():
        return [Bound(names.index(name)) if name in names else Constant(name)]
    if not tokens.take("("):
        return []
    terms = [_term(tokens, names)]
    while tokens.take(","):
        terms.append(_term(tokens, names))
    tokens.need(")")
    return terms


def _type(tokens: _Tokens) -> Type:
    source = _basic(tokens)
    return Arrow(source, _type(tokens)) if tokens.take("->") else source


def _basic(tokens: _Tokens) -> Type:
    if tokens.take("("):
        found = _type(tokens)
        tokens.need(")")
        return found
    name = tokens.need_name()
    if name not in BASIC_TYPES:
        raise _MistakeError(
            f'expected one of {", ".join(BASIC_TYPES)}, found the type "{name}".', 0
        )
    return Basic(name)
