# SPDX-License-Identifier: Apache-2.0
"""Reader of the notation in which the language data is written.

One small grammar (`notation.lark`) has the categories, lambda terms, types and pragmatic rules.
A mistake becomes a `DataError` with file, line, column and what was expected.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Literal, cast

from ..ontology.errors import DataError
from .categories import Atom, Category, Functor
from .predicates import Form, form_of_term
from .terms import Apply, Bound, Constant, Lambda, Term
from .typecheck import BASIC_TYPES, Arrow, Basic, Type

if TYPE_CHECKING:
    from lark import Lark, Token, Tree

    from ..ontology.source import Field

    Node = Tree[Token] | Token

Start = Literal["entry", "unary", "rule", "category", "term", "type"]

_SHOWN = {
    "NAME": "a name",
    "FORWARD": '"/"',
    "BACKWARD": '"\\"',
    "LAMBDA": '"λ"',
    "LPAR": '"("',
    "RPAR": '")"',
    "COLON": '":"',
    "COMMA": '","',
    "DOT": '"."',
    "COST": "a number",
    "AT": '"@"',
    "__ANON_0": '"=>"',
    "$END": "the end",
}


def read_entry(field: Field) -> tuple[Category, Term, float]:
    """A category, the term of a word that has it, and its cost: `NP/N : λx.x @1`."""
    category, term, *cost = _parse(field, "entry").children
    return _category(category), _term(term, ()), float(str(cost[0])) if cost else 0.0


def read_unary(field: Field) -> tuple[Category, Category, Term]:
    """A change of category: `R => S : λr.r(high)`."""
    source, target, term = _parse(field, "unary").children
    return _category(source), _category(target), _term(term, ())


def read_rule(field: Field) -> tuple[Form, Form]:
    """A pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    left, right = _parse(field, "rule").children
    try:
        return form_of_term(_term(left, ())), form_of_term(_term(right, ()))
    except ValueError as error:
        raise field.fail("expected predicate forms without functions.") from error


def read_category(field: Field) -> Category:
    """A category alone: `(S/C)/C`."""
    return _category(_parse(field, "category"))


def read_type(field: Field) -> Type:
    """A type: `e -> e -> t`."""
    return _type(_parse(field, "type"), field)


def parse_term(text: str) -> Term:
    """A lambda term from a text; for tests and examples."""
    from ..ontology.source import Field  # here: only for a text that stands in no file

    return _term(_parse(Field(text, "<text>", 1, 0), "term"), ())


@cache
def _lark() -> Lark:
    from lark import Lark  # here: a program that parses nothing should not pay for it

    grammar = (Path(__file__).parent / "notation.lark").read_text(encoding="utf-8")
    return Lark(
        grammar,
        parser="lalr",
        maybe_placeholders=False,
        start=["entry", "unary", "rule", "category", "term", "type"],
    )


def _parse(field: Field, start: Start) -> Tree[Token]:
    from lark import UnexpectedInput

    text = field.text()
    try:
        return _lark().parse(text, start=start)
    except UnexpectedInput as error:
        raise _syntax_error(field, text, error) from error


def _syntax_error(field: Field, text: str, error: object) -> DataError:
    found = getattr(error, "column", -1)
    at_end = getattr(getattr(error, "token", None), "type", "") == "$END"
    offset = len(text) if at_end or not isinstance(found, int) else found - 1
    accepted: Sequence[str] = sorted(
        getattr(error, "accepts", None)
        or getattr(error, "expected", None)
        or getattr(error, "allowed", None)
        or ()
    )
    expected = " or ".join(_SHOWN.get(name, name) for name in accepted) or "something else"
    rest = text[offset : offset + 12]
    seen = f'"{rest}"' if rest else "the end"
    return DataError(
        f"expected {expected}, found {seen} in {text!r}.",
        source=field.source,
        line=field.line,
        # Such texts stand in quotes, because they hold a colon or an arrow.
        column=field.column + 1 + offset,
    )


def _category(node: Node) -> Category:
    data, children = _split(node)
    if data == "atom":
        return Atom(str(children[0]))
    result, slash, argument = children
    return Functor(
        _category(result),
        _category(argument),
        forward=str(slash).startswith("/"),
        composes=str(slash).endswith("^"),
    )


def _term(node: Node, names: tuple[str, ...]) -> Term:
    data, children = _split(node)
    if data == "function":
        name = str(children[1])
        return Lambda(_term(children[2], (name, *names)), name)
    if data == "name":
        name = str(children[0])
        return Bound(names.index(name)) if name in names else Constant(name)
    parts = [part for group in children for part in _arguments(group, names)]
    term = parts[0]
    for part in parts[1:]:
        term = Apply(term, part)
    return term


def _arguments(group: Node, names: tuple[str, ...]) -> list[Term]:
    data, children = _split(group)
    if data == "name":
        return [_term(group, names)]
    return [_term(child, names) for child in children]


def _type(node: Node, field: Field) -> Type:
    data, children = _split(node)
    if data == "arrow":
        return Arrow(_type(children[0], field), _type(children[1], field))
    name = str(children[0])
    if name not in BASIC_TYPES:
        raise field.fail(f'expected one of {", ".join(BASIC_TYPES)}, found the type "{name}".')
    return Basic(name)


def _split(node: Node) -> tuple[str, list[Node]]:
    tree = cast("Tree[Token]", node)
    return str(tree.data), list(tree.children)
