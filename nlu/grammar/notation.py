r"""Reader of the notation for categories, lambda terms, types and pragmatic rules.

The grammar is `notation.lark`, read by LALR(1); values are built straight from the text, without a
tree in between. The lexer is contextual: it knows at each place what may follow, so that `\` is
read as a slash or as a "λ". A mistake is a `DataError` with its place and what was expected.
"""

from collections.abc import Callable
from functools import cache, reduce
from itertools import chain
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, Literal, TypeAlias, cast, get_args

from ...ontology.errors import DataError
from ...ontology.yaml_reader import YamlNode
from .categories import AtomicCategory, Category, FunctionType, Functor, Type
from .terms import Application, Constant, Term, bind

if TYPE_CHECKING:
    from lark import Lark

Start: TypeAlias = Literal["entry", "unary", "rule", "term", "type"]

MAX_CHARACTERS = 400  # a longer line is rejected, so that none can nest too deeply to be used

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


def read_entry(field: YamlNode) -> tuple[Category, Term, float]:
    """Read the category of a word, its term and its cost: `NP/N : λx.x @1`."""
    category, term, *cost = cast("tuple[Any, ...]", parse(field, "entry"))
    return category, term, float(*cost)


def read_unary(field: YamlNode) -> tuple[Category, Category, Term]:
    """Read a unary rule, which changes a category: `R => S : λr.r(high)`."""
    return cast("tuple[Category, Category, Term]", parse(field, "unary"))


def read_rule(field: YamlNode) -> tuple[Term, Term]:
    """Read both sides of a pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    return cast("tuple[Term, Term]", parse(field, "rule"))


def read_type(field: YamlNode) -> Type:
    """Read a type: `e -> e -> t`."""
    return cast("Type", parse(field, "type"))


def parse(field: YamlNode, start: Start) -> object:
    """Return what a line stands for; `DataError` says where it does not match the rule `start`."""
    from lark import UnexpectedInput, UnexpectedToken  # here: lark takes 0.1 s to import and start

    text = field.text()
    if len(text) > MAX_CHARACTERS:
        raise field.fail(f"expected at most {MAX_CHARACTERS} characters, found {len(text)}.")
    try:
        return _parser().parse(text, start=start)
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


def _of_text(make: Callable[[str], object]) -> Callable[[str], object]:
    return lambda token: make(str(token))  # what lark makes is a `str` with a place


def _of_parts(make: Callable[..., object]) -> Callable[[list[object]], object]:
    return lambda parts: make(*parts)


def _functor(result: Category, slash: str, argument: Category) -> Category:
    return Functor(result, argument, forward=slash[0] == "/", composes=slash.endswith("^"))


def _function(_sign: str, name: str, body: Term) -> Term:
    # Until its function is read, a variable is a constant like any other name.
    return bind(body, str(name))


def _application(*groups: list[Term]) -> Term:
    return reduce(Application, chain.from_iterable(groups))


_MAKERS: dict[str, Callable[..., object]] = {
    **dict.fromkeys(("entry", "unary", "rule"), lambda *parts: parts),
    "atom": _of_text(AtomicCategory),
    "functor": _functor,
    "function": _function,
    "application": _application,
    "name": _of_text(lambda name: [Constant(name)]),
    "arguments": lambda *terms: list(terms),
    "arrow": FunctionType,
    "basic": str,
}
"""What each rule of the grammar makes of its parts."""


@cache
def _parser() -> "Lark":
    from lark import Lark

    makers: Any = SimpleNamespace(**{rule: _of_parts(make) for rule, make in _MAKERS.items()})
    return Lark.open(
        "notation.lark",
        rel_to=__file__,
        parser="lalr",
        transformer=makers,
        maybe_placeholders=False,
        start=list(get_args(Start)),
    )


def _expected(before: str, start: Start) -> str:
    parser = _parser().parse_interactive(before, start=start)
    parser.exhaust_lexer()
    terminal, accepted = _parser().get_terminal, parser.accepts()
    shown = (_SHOWN.get(each) or f'"{terminal(each).pattern.value}"' for each in accepted)
    return " or ".join(sorted(shown))
