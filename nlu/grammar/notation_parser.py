r"""LALR(1) parser of the notation: builds categories, terms and types straight from the text.

The grammar is `notation.lark`. No tree is built in between. The lexer is contextual: it knows at
each place what may follow, so that `\` is read as a slash or as a "λ".
"""

from functools import reduce
from typing import Literal, TypeAlias, cast, get_args

from lark import Lark, Transformer, UnexpectedInput, UnexpectedToken, v_args

from ...ontology.errors import DataError
from ...ontology.yaml_reader import YamlNode
from .categories import AtomicCategory, BasicType, Category, FunctionType, Functor, Type
from .terms import Application, Constant, Term, bind

Entry: TypeAlias = tuple[Category, Term, float]
UnaryRule: TypeAlias = tuple[Category, Category, Term]
TermPair: TypeAlias = tuple[Term, Term]
Value: TypeAlias = Entry | UnaryRule | TermPair | Category | Term | Type | list[Term]
Start: TypeAlias = Literal["entry", "unary", "rule", "term", "type"]

_SHOWN = {
    "NAME": "a name",
    "FORWARD": '"/"',
    "BACKWARD": '"\\"',
    "LAMBDA": '"λ"',
    "COST": "a number",
    "BASIC": "e, t or d",
    "$END": "the end",
}
"""How messages name the terminals that are not one fixed sign."""


def parse(field: YamlNode, start: Start) -> Value:
    """Return what a line stands for; `DataError` says where it does not match the rule `start`."""
    text = field.text()
    try:
        # Lark declares that it returns a tree, but it returns what `_Builder` makes.
        return cast("Value", _PARSER.parse(text, start=start))
    except UnexpectedInput as error:
        at_end = isinstance(error, UnexpectedToken) and error.token.type == "$END"
        offset = len(text) if at_end else error.pos_in_stream or 0
        rest = text[offset : offset + 12]
        found = f'"{rest}"' if rest else "the end"
        raise DataError(
            f"expected {_expected(text[:offset], start)}, found {found} in {text!r}.",
            source=field.source,
            line=field.line,
            # Such texts stand in quotes, because they hold a colon or an arrow.
            column=field.column + 1 + offset,
            text=field.text_line,
        ) from error


@v_args(inline=True)
class _Builder(Transformer[object, Value]):
    def entry(self, category: Category, term: Term, cost: str = "0") -> Entry:
        return category, term, float(cost)

    def unary(self, source: Category, target: Category, term: Term) -> UnaryRule:
        return source, target, term

    def rule(self, left: Term, right: Term) -> TermPair:
        return left, right

    def atom(self, name: str) -> Category:
        return AtomicCategory(str(name))

    def functor(self, result: Category, slash: str, argument: Category) -> Category:
        return Functor(result, argument, forward=slash[0] == "/", composes=slash.endswith("^"))

    def function(self, _sign: str, name: str, body: Term) -> Term:
        # Until its function is read, a variable is a constant like any other name.
        return bind(body, str(name))

    def application(self, *groups: list[Term]) -> Term:
        return reduce(Application, [term for group in groups for term in group])

    def name(self, name: str) -> list[Term]:
        return [Constant(str(name))]

    def arguments(self, *terms: Term) -> list[Term]:
        return list(terms)

    def arrow(self, source: Type, target: Type) -> Type:
        return FunctionType(source, target)

    def basic(self, name: str) -> Type:
        return BasicType(str(name))


_PARSER = Lark.open(
    "notation.lark",
    rel_to=__file__,
    parser="lalr",
    transformer=_Builder(),
    maybe_placeholders=False,
    start=list(get_args(Start)),
)


def _expected(before: str, start: Start) -> str:
    parser = _PARSER.parse_interactive(before, start=start)
    parser.exhaust_lexer()
    following = parser.accepts()
    return " or ".join(
        sorted(_SHOWN.get(t) or f'"{_PARSER.get_terminal(t).pattern.value}"' for t in following)
    )
