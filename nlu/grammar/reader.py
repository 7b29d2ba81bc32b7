# SPDX-License-Identifier: Apache-2.0
r"""The parser of the notation, and what each rule of its grammar stands for.

The grammar is `notation.lark`. What a text stands for is made while it is read, without a tree. It
is read by LALR(1), so its lexer knows at each place what may follow: `\` is a slash or a "λ".
"""

from __future__ import annotations

from functools import reduce
from pathlib import Path
from typing import Literal, cast

from lark import Lark, Transformer, UnexpectedInput, UnexpectedToken, v_args

from .categories import AtomicCategory, Category, Functor
from .notation import MistakeError
from .terms import Apply, Constant, Term, bind
from .types import Basic, FunctionType, Type

Entry = tuple[Category, Term, float]
Change = tuple[Category, Category, Term]
Pair = tuple[Term, Term]
Value = Entry | Change | Pair | Category | Term | Type
Start = Literal["entry", "unary", "rule", "category", "term", "type"]

_SHOWN = {
    "NAME": "a name",
    "FORWARD": '"/"',
    "BACKWARD": '"\\"',
    "LAMBDA": '"λ"',
    "COST": "a number",
    "$END": "the end",
}
"""How a message calls each terminal that is not one certain sign."""


def read(text: str, start: Start) -> Value:
    """What a text stands for.

    Raises:
        MistakeError: it is not written as the rule `start` of the grammar says.
    """
    try:
        # The parser says it gives a tree, but it gives what `_Values` makes.
        return cast("Value", _PARSER.parse(text, start=start))
    except UnexpectedInput as error:
        offset = _offset(text, error)
        rest = text[offset : offset + 12]
        found = f'"{rest}"' if rest else "the end"
        expected = _expected(text[:offset], start)
        raise MistakeError(f"expected {expected}, found {found} in {text!r}.", offset) from error


@v_args(inline=True)
class _Values(Transformer[object, Value]):
    """What each rule stands for, given what its parts do."""

    def entry(self, category: Category, term: Term, cost: str = "0") -> Entry:
        return category, term, float(cost)

    def unary(self, source: Category, target: Category, term: Term) -> Change:
        return source, target, term

    def rule(self, left: Term, right: Term) -> Pair:
        return left, right

    def atom(self, name: str) -> Category:
        return AtomicCategory(str(name))

    def functor(self, result: Category, slash: str, argument: Category) -> Category:
        return Functor(result, argument, forward=slash[0] == "/", composes=slash.endswith("^"))

    def function(self, _sign: str, name: str, body: Term) -> Term:
        # Until its function is read, a variable is a constant like any other name.
        return bind(body, str(name))

    def application(self, *groups: list[Term]) -> Term:
        return reduce(Apply, [term for group in groups for term in group])

    def name(self, name: str) -> list[Term]:
        return [Constant(str(name))]

    def arguments(self, *terms: Term) -> list[Term]:
        return list(terms)

    def arrow(self, source: Type, target: Type) -> Type:
        return FunctionType(source, target)

    def basic(self, name: str) -> Type:
        return Basic(str(name))


_PARSER = Lark(
    (Path(__file__).parent / "notation.lark").read_text(encoding="utf-8"),
    parser="lalr",
    transformer=_Values(),
    maybe_placeholders=False,
    start=["entry", "unary", "rule", "category", "term", "type"],
)


def _offset(text: str, error: UnexpectedInput) -> int:
    at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
    return len(text) if at_end else error.pos_in_stream or 0


def _expected(before: str, start: Start) -> str:
    """What may follow after the right part of a text."""
    parser = _PARSER.parse_interactive(before, start=start)
    parser.exhaust_lexer()
    return " or ".join(sorted(map(_shown, parser.accepts())))


def _shown(terminal: str) -> str:
    return _SHOWN.get(terminal) or f'"{_PARSER.get_terminal(terminal).pattern.value}"'
