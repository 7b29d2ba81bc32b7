"""Reader of the notation for categories, lambda terms, types and pragmatic rules.

The grammar is `notation.lark`. A mistake is a `DataError` with its place and what was expected.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from ...ontology.yaml_reader import YamlNode
from .categories import Type

if TYPE_CHECKING:
    from .notation_parser import Entry, Start, TermPair, UnaryRule, Value

MAX_CHARACTERS = 400  # a longer line is rejected, so that none can nest too deeply to be used


def read_entry(field: YamlNode) -> Entry:
    """Read the category of a word, its term and its cost: `NP/N : λx.x @1`."""
    return cast("Entry", _read(field, "entry"))


def read_unary(field: YamlNode) -> UnaryRule:
    """Read a unary rule, which changes a category: `R => S : λr.r(high)`."""
    return cast("UnaryRule", _read(field, "unary"))


def read_rule(field: YamlNode) -> TermPair:
    """Read both sides of a pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    return cast("TermPair", _read(field, "rule"))


def read_type(field: YamlNode) -> Type:
    """Read a type: `e -> e -> t`."""
    return cast("Type", _read(field, "type"))


def _read(field: YamlNode, start: Start) -> Value:
    from .notation_parser import parse  # here: lark takes 0.1 s to import and start

    if len(field.text()) > MAX_CHARACTERS:
        problem = f"expected at most {MAX_CHARACTERS} characters, found {len(field.text())}."
        raise field.fail(problem)
    return parse(field, start)
