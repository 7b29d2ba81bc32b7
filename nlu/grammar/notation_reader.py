"""Reader of the notation for categories, lambda terms, types and pragmatic rules.

The language data is written in one small grammar, `notation.lark`. A mistake becomes a `DataError`
with file, line, column and what was expected. Starting the parser and parsing a thousand lines
takes half of the time of loading a language, and the lines are nearly always the same: parsed lines
are kept in a JSON file, under the digest of the grammar and of the code that reads it.
"""

from __future__ import annotations

import json
from contextlib import suppress
from dataclasses import fields
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from ...ontology.disk_cache import cache_folder, content_key, write_atomically
from ...ontology.yaml_reader import YamlNode
from .categories import AtomicCategory, BasicType, FunctionType, Functor, Type
from .terms import Application, BoundVariable, Constant, Lambda

if TYPE_CHECKING:
    from .notation_parser import Entry, Start, TermPair, UnaryRule, Value

MAX_CHARACTERS = 400  # a longer line is rejected, so that none can nest too deeply to be used

_MODULES = ("notation_reader", "notation_parser", "categories", "terms")
_CATEGORIES, _TERMS = (AtomicCategory, Functor), (Application, BoundVariable, Constant, Lambda)
_CLASSES: dict[str, Any] = {
    each.__name__: each for each in (*_CATEGORIES, *_TERMS, BasicType, FunctionType)
}


def read_entry(field: YamlNode) -> Entry:
    """Read the category of a word, its term and its cost: `NP/N : λx.x @1`."""
    return cast("Entry", _lines().read(field, "entry"))


def read_unary(field: YamlNode) -> UnaryRule:
    """Read a unary rule, which changes a category: `R => S : λr.r(high)`."""
    return cast("UnaryRule", _lines().read(field, "unary"))


def read_rule(field: YamlNode) -> TermPair:
    """Read both sides of a pragmatic rule: `STATEMENT(A,B,X) => wantBelieve(A,B,X)`."""
    return cast("TermPair", _lines().read(field, "rule"))


def read_type(field: YamlNode) -> Type:
    """Read a type: `e -> e -> t`."""
    return cast("Type", _lines().read(field, "type"))


def save_cache() -> None:
    """Save the lines that were parsed, so that the next program need not parse them again."""
    _lines().save()


@cache
def _lines() -> NotationCache:
    return NotationCache(cache_folder() / "notation.json")


class NotationCache:
    """The parsed lines of this program, and those that the last one saved in a file.

    A damaged file, or one of another version, is ignored.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        self._saved: dict[str, Any] = {}
        self._used: dict[str, Value] = {}
        with suppress(OSError, ValueError):
            head, _, body = path.read_text(encoding="utf-8").partition("\n")
            self._saved = json.loads(body) if head == _head(body) else {}

    def read(self, field: YamlNode, start: Start) -> Value:
        """Return what a line stands for; `DataError` says where it does not match its rule."""
        text = field.text()
        if len(text) > MAX_CHARACTERS:
            raise field.fail(f"expected at most {MAX_CHARACTERS} characters, found {len(text)}.")
        found = self.recall(text, start)
        if found is None:
            from .notation_parser import parse  # here: lark takes 0.1 s to import and start

            found = self._used[f"{start} {text}"] = parse(field, start)
        return found

    def recall(self, text: str, start: Start) -> Value | None:
        """Return what a line stands for that was parsed before; None if it was not."""
        key = f"{start} {text}"
        if key not in self._used and key in self._saved:
            self._used[key] = _from_plain(self._saved[key])
        return self._used.get(key)

    def save(self) -> None:
        """Write the lines that this program used, if any is new and the file is writable."""
        if self._used.keys() - self._saved.keys():
            self._saved = {key: _to_plain(value) for key, value in self._used.items()}
            body = json.dumps(self._saved, ensure_ascii=False)
            with suppress(OSError):
                write_atomically(self._path, f"{_head(body)}\n{body}")


def _head(body: str) -> str:
    folder = Path(__file__).parent
    sources = ("notation.lark", *(f"{name}.py" for name in _MODULES))
    version = content_key(*((folder / name).read_bytes() for name in sources))
    return f"{version} {content_key(body.encode())}"


def _to_plain(value: Any) -> Any:
    if isinstance(value, tuple):
        return ["", *map(_to_plain, cast("tuple[Any, ...]", value))]
    name = type(value).__name__
    if name not in _CLASSES:
        return value
    return [name, *(_to_plain(getattr(value, each.name)) for each in fields(value))]


def _from_plain(plain: Any) -> Any:
    if not isinstance(plain, list):
        return plain
    name, *parts = cast("list[Any]", plain)
    values = map(_from_plain, parts)
    return _CLASSES[name](*values) if name else tuple(values)
