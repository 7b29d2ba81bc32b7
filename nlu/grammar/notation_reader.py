"""Reader of the notation for categories, lambda terms, types and pragmatic rules.

The language data is written in one small grammar, `notation.lark`. A mistake becomes a `DataError`
with file, line, column and what was expected. Starting the parser and parsing a thousand lines
takes half of the time of loading a language, and the lines are nearly always the same: parsed lines
are kept in a JSON file, under the digest of the grammar and of the code that reads it.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import fields
from functools import cache, cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from ...ontology.disk_cache import cache_folder, content_key, write_atomically
from ...ontology.yaml_reader import YamlNode
from .categories import AtomicCategory, Category, Functor
from .terms import Application, BoundVariable, Constant, Lambda, Term
from .types import BASIC_TYPES, BasicType, FunctionType, Type

if TYPE_CHECKING:
    from .notation_parser import Entry, Start, TermPair, UnaryRule, Value

MAX_CHARACTERS = 400
"""A longer line is rejected, so that none can nest too deeply to be used."""

_SOURCES = (
    *("notation.lark", "notation_reader.py", "notation_parser.py"),
    *("categories.py", "terms.py", "types.py"),
)
_MALFORMED = (ValueError, TypeError, KeyError, IndexError, RecursionError)
_CLASSES: dict[str, Any] = {
    each.__name__: each
    for each in (
        AtomicCategory,
        Functor,
        Application,
        BoundVariable,
        Constant,
        Lambda,
        BasicType,
        FunctionType,
    )
}


def read_entry(field: YamlNode) -> Entry:
    """Read the category of a word, its term and its cost: `NP/N : λx.x @1`."""
    return cast("Entry", _read(field, "entry"))


def read_unary(field: YamlNode) -> UnaryRule:
    """Read a unary rule, which changes a category: `R => S : λr.r(high)`."""
    return cast("UnaryRule", _read(field, "unary"))


def read_rule(field: YamlNode) -> TermPair:
    """Read both sides of a pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    return cast("TermPair", _read(field, "rule"))


def read_category(field: YamlNode) -> Category:
    """Read a category: `(S/C)/C`."""
    return cast("Category", _read(field, "category"))


def read_type(field: YamlNode) -> Type:
    """Read a type: `e -> e -> t`."""
    found = cast("Type", _read(field, "type"))
    for name in _basic_types(found):
        if name not in BASIC_TYPES:
            raise field.fail(f'expected one of {", ".join(BASIC_TYPES)}, found the type "{name}".')
    return found


def parse_term(text: str) -> Term:
    """Parse a lambda term that stands in no file; for tests and examples."""
    return cast("Term", _read(YamlNode(text, "<text>", 1, 0), "term"))


def save_cache() -> None:
    """Save the lines that were parsed, so that the next program need not parse them again."""
    _cache().save()


def _read(field: YamlNode, start: Start) -> Value:
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
    if isinstance(found, BasicType):
        yield found.name
    else:
        yield from _basic_types(found.source)
        yield from _basic_types(found.target)


class NotationCache:
    """The parsed lines of this program, and those in a file, by default in the cache folder.

    A damaged file, or one of another version, is ignored.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or cache_folder() / "notation.json"
        self._used: dict[tuple[Start, str], Value] = {}
        self._is_new = False

    def get(self, text: str, start: Start) -> Value | None:
        """The value of a line, None when it was never parsed."""
        value = self._used.get((start, text))
        if value is None and (plain := self._saved.get(f"{start} {text}")) is not None:
            with suppress(*_MALFORMED):
                value = self._used[start, text] = _from_plain(plain)
        return value

    def add(self, text: str, start: Start, value: Value) -> None:
        """Add the value of a line."""
        self._used[start, text] = value
        self._is_new = True

    def save(self) -> None:
        """Write the lines that this program used, if any is new and the file is writable."""
        if self._is_new:
            used = {f"{start} {text}": _to_plain(v) for (start, text), v in self._used.items()}
            body = json.dumps(used, ensure_ascii=False)
            with suppress(OSError):
                write_atomically(self._path, f"{self._head(body)}\n{body}")
            self._is_new = False

    @cached_property
    def _saved(self) -> dict[str, Any]:
        try:
            head, _, body = self._path.read_text(encoding="utf-8").partition("\n")
            return json.loads(body) if head == self._head(body) else {}
        except (OSError, ValueError):
            return {}

    def _head(self, body: str) -> str:
        folder = Path(__file__).parent
        version = content_key(*((folder / name).read_bytes() for name in _SOURCES))
        return f"{version} {content_key(body.encode())}"


def _to_plain(value: Any) -> Any:
    """A value for JSON: of a dataclass its name and its fields, of a tuple "" and its items."""
    if isinstance(value, tuple):
        return ["", *map(_to_plain, cast("tuple[Any, ...]", value))]
    name = type(value).__name__
    if name not in _CLASSES:
        return value
    return [name, *(_to_plain(getattr(value, each.name)) for each in fields(value))]


def _from_plain(plain: Any) -> Any:
    name, *parts = plain
    values = [_from_plain(part) if isinstance(part, list) else part for part in parts]
    return _CLASSES[name](*values) if name else tuple(values)
