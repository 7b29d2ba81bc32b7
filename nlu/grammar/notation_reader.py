r"""Reader of the notation for categories, lambda terms, types and pragmatic rules.

    entry     category ":" term ["@" number]
    unary     category "=>" category ":" term
    rule      term "=>" term
    category  simple (("/" | "/^" | "\" | "\^") simple)*        simple  name | "(" category ")"
    term      ("λ" | "\") name "." term | group+                group   name | "(" term, .. ")"
    type      name ["->" type] | "(" type ")" ["->" type]

One token decides how to go on (recursive descent), so values are built straight from the text. A
mistake becomes a `DataError` with file, line, column and what was expected.
"""

from __future__ import annotations

import re
from functools import reduce

from ...ontology.errors import DataError
from ...ontology.yaml_reader import YamlNode
from .categories import AtomicCategory, Category, Functor
from .terms import Application, BoundVariable, Constant, Lambda, Term
from .types import BASIC_TYPES, BasicType, FunctionType, Type

MAX_CHARACTERS = 400
"""A longer line is rejected, so that none can nest too deeply to be used."""

_TOKEN = re.compile(
    r"\s*(?:(?P<name>[A-Za-z_][A-Za-z0-9_]*)|(?P<number>-?\d+(?:\.\d+)?)"
    r"|(?P<sign>->|=>|[/\\]\^?|[λ().,:@])|(?P<end>$)|(?P<other>.))"
)
_SHOWN = {"name": "a name", "number": "a number", "end": "the end"}


def read_entry(field: YamlNode) -> tuple[Category, Term, float]:
    """Read the category of a word, its term and its cost: `NP/N : λx.x @1`."""
    line = _Line(field)
    category = line.category()
    line.take(":")
    term = line.term()
    cost = float(line.take("number")) if line.has("@") else 0.0
    line.take("end")
    return category, term, cost


def read_unary(field: YamlNode) -> tuple[Category, Category, Term]:
    """Read a unary rule, which changes a category: `R => S : λr.r(high)`."""
    line = _Line(field)
    source = line.category()
    line.take("=>")
    target = line.category()
    line.take(":")
    term = line.term()
    line.take("end")
    return source, target, term


def read_rule(field: YamlNode) -> tuple[Term, Term]:
    """Read both sides of a pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    line = _Line(field)
    left = line.term()
    line.take("=>")
    right = line.term()
    line.take("end")
    return left, right


def read_type(field: YamlNode) -> Type:
    """Read a type: `e -> e -> t`."""
    line = _Line(field)
    found = line.type()
    line.take("end")
    return found


def parse_term(text: str) -> Term:
    """Parse a lambda term that stands in no file; for tests and examples."""
    line = _Line(YamlNode(text, "<text>", 1, 0))
    term = line.term()
    line.take("end")
    return term


class _Line:
    """The tokens of a line, which are taken from left to right."""

    def __init__(self, field: YamlNode) -> None:
        self._field, self._text = field, field.text()
        if len(self._text) > MAX_CHARACTERS:
            problem = f"expected at most {MAX_CHARACTERS} characters, found {len(self._text)}."
            raise field.fail(problem)
        # The kind of a sign is the sign itself, of a slash that composes without its mark.
        self._tokens = [
            (said.rstrip("^") if kind == "sign" else kind, said, found.start(kind))
            for found in _TOKEN.finditer(self._text)
            if (kind := found.lastgroup) and isinstance(said := found[kind], str)
        ]
        self._place = 0
        self._expected: list[str] = []

    def has(self, *kinds: str) -> str:
        """Take the next token if it is of one of some kinds, and return it; empty if it is not."""
        kind, said, _ = self._tokens[self._place]
        if kind not in kinds:
            self._expected += kinds
            return ""
        self._place += 1
        self._expected.clear()
        return said

    def take(self, kind: str) -> str:
        """Take the next token, which must be of a kind, and return it."""
        if self._tokens[self._place][0] != kind:
            raise self._mistake(kind)
        return self.has(kind)

    def category(self) -> Category:
        """Take a category."""
        found = self._simple()
        while slash := self.has("/", "\\"):
            argument, composes = self._simple(), slash.endswith("^")
            found = Functor(found, argument, forward=slash[0] == "/", composes=composes)
        return found

    def term(self, scope: tuple[str, ...] = ()) -> Term:
        """Take a lambda term within functions with these variables, innermost first."""
        if self.has("λ", "\\"):
            name = self.take("name")
            self.take(".")
            return Lambda(self.term((name, *scope)), name)
        terms: list[Term] = []
        while True:
            if name := self.has("name"):
                is_bound = name in scope
                terms.append(BoundVariable(scope.index(name)) if is_bound else Constant(name))
            elif self.has("("):
                terms.append(self.term(scope))
                while self.has(","):
                    terms.append(self.term(scope))
                self.take(")")
            elif terms:
                return reduce(Application, terms)
            else:
                raise self._mistake()

    def type(self) -> Type:
        """Take a type."""
        source: Type
        if self.has("("):
            source = self.type()
            self.take(")")
        else:
            source = BasicType(self.take("name"))
            if source.name not in BASIC_TYPES:
                known = ", ".join(BASIC_TYPES)
                problem = f'expected one of {known}, found the type "{source.name}".'
                raise self._field.fail(problem)
        return FunctionType(source, self.type()) if self.has("->") else source

    def _simple(self) -> Category:
        if not self.has("("):
            return AtomicCategory(self.take("name"))
        found = self.category()
        self.take(")")
        return found

    def _mistake(self, *kinds: str) -> DataError:
        expected = sorted(_SHOWN.get(each) or f'"{each}"' for each in {*self._expected, *kinds})
        *_, start = self._tokens[self._place]
        rest = self._text[start : start + 12]
        found = f'"{rest}"' if rest else "the end"
        return DataError(
            f"expected {' or '.join(expected)}, found {found} in {self._text!r}.",
            source=self._field.source,
            line=self._field.line,
            # Such texts stand in quotes, because they hold a colon or an arrow.
            column=self._field.column + 1 + start,
        )
