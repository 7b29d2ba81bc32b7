# SPDX-License-Identifier: Apache-2.0
"""Cache of parsed lines of the notation, in memory and in a JSON file.

Starting the parser and parsing a thousand lines takes half of the time of loading a language, and
the lines are nearly always the same. The file lies in the cache folder, under the digest of the
grammar and of the code that reads it. A damaged file, or one of another version, is ignored; and
what comes from the cache is checked against its category like what is parsed.
"""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...ontology.cache import cache_folder, content_key, write_atomically
from .categories import AtomicCategory, Category, Functor
from .terms import Apply, Bound, Constant, Lambda, Term
from .types import Basic, FunctionType, Type

if TYPE_CHECKING:
    from .notation_parser import Start, Value

    Plain = str | int | float | list["Plain"]

FILE = "notation.json"
_SOURCES = ("notation.lark", "notation_parser.py", "notation_cache.py")
_MALFORMED = (ValueError, TypeError, KeyError, IndexError, RecursionError)


class NotationCache:
    """The parsed lines that this program used; those of earlier programs are read when asked for.

    Args:
        path: the file; `notation.json` in the cache folder when None.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or cache_folder() / FILE
        self._used: dict[tuple[Start, str], Value] = {}
        self._is_new = False

    def get(self, text: str, start: Start) -> Value | None:
        """The value of a line, None when it was never parsed."""
        value = self._used.get((start, text))
        if value is None and (plain := self._saved.get(f"{start} {text}")) is not None:
            with suppress(*_MALFORMED):
                value = self._used[start, text] = _from_plain(plain, start)
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
    def _saved(self) -> dict[str, Plain]:
        try:
            head, _, body = self._path.read_text(encoding="utf-8").partition("\n")
            return json.loads(body) if head == self._head(body) else {}
        except (OSError, ValueError):
            return {}

    def _head(self, body: str) -> str:
        folder = Path(__file__).parent
        version = content_key(*((folder / name).read_bytes() for name in _SOURCES))
        return f"{version} {content_key(body.encode())}"


def _to_plain(value: Value | float) -> Plain:
    plain: Plain
    match value:
        case AtomicCategory(name) | Basic(name) | Constant(name):
            plain = name
        case Bound(index):
            plain = index
        case Functor(result, argument, forward, composes):
            slash = ("/" if forward else "\\") + ("^" if composes else "")
            plain = [_to_plain(result), slash, _to_plain(argument)]
        case Lambda(body, hint):
            plain = ["λ", hint, _to_plain(body)]
        case FunctionType(one, other) | Apply(one, other):
            plain = [_to_plain(one), _to_plain(other)]
        case tuple():
            plain = [_to_plain(each) for each in value]
        case _:
            plain = value
    return plain


def _from_plain(plain: Any, start: Start) -> Value:
    match start:
        case "entry":
            category, term, cost = plain
            return _category(category), _term(term), float(cost)
        case "unary":
            source, target, term = plain
            return _category(source), _category(target), _term(term)
        case "rule":
            left, right = plain
            return _term(left), _term(right)
        case "category":
            return _category(plain)
        case "term":
            return _term(plain)
        case "type":
            return _type(plain)


def _category(plain: Any) -> Category:
    if isinstance(plain, str):
        return AtomicCategory(plain)
    result, slash, argument = plain
    forward = {"/": True, "\\": False}[slash[0]]
    return Functor(_category(result), _category(argument), forward, slash[1:] == "^")


def _term(plain: Any, depth: int = 0) -> Term:
    if isinstance(plain, str):
        return Constant(plain)
    if isinstance(plain, int):
        return Bound(range(depth)[plain])
    if len(plain) == 2:
        return Apply(_term(plain[0], depth), _term(plain[1], depth))
    _, hint, body = plain
    return Lambda(_term(body, depth + 1), str(hint))


def _type(plain: Any) -> Type:
    if isinstance(plain, str):
        return Basic(plain)
    source, target = plain
    return FunctionType(_type(source), _type(target))
