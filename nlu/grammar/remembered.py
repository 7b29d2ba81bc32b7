# SPDX-License-Identifier: Apache-2.0
"""What lines of the notation stand for, kept from one run of a program to the next.

To start the parser and to read a thousand lines takes half of the time of loading a language, and
the lines are nearly always the same. They are kept as JSON in the cache folder, under the digest of
the grammar and of the code that reads it. A file that is not whole, or of another version, counts
for nothing; and what is recalled is checked against its category like what is read.
"""

from __future__ import annotations

import json
from contextlib import suppress
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ...ontology.cache import cache_folder, content_key, write_whole
from .categories import AtomicCategory, Category, Functor
from .terms import Apply, Bound, Constant, Lambda, Term
from .types import Basic, FunctionType, Type

if TYPE_CHECKING:
    from .reader import Start, Value

    Plain = str | int | float | list["Plain"]

FILE = "notation.json"
_SOURCES = ("notation.lark", "reader.py", "remembered.py")
_NOT_AS_WRITTEN = (ValueError, TypeError, KeyError, IndexError, RecursionError)


class NotationCache:
    """The lines that were read before.

    Args:
        path: the file that they are kept in; in the cache folder when None.
    """

    def __init__(self, path: Path | None = None) -> None:
        self._path = path or cache_folder() / FILE
        self._used: dict[str, Plain] = {}
        self._is_new = False

    def recall(self, text: str, start: Start) -> Value | None:
        """What a line stands for, None when it was never read."""
        name = f"{start} {text}"
        plain = self._kept.get(name)
        if plain is None:
            return None
        try:
            value = _value(plain, start)
        except _NOT_AS_WRITTEN:
            return None
        self._used[name] = plain
        return value

    def add(self, text: str, start: Start, value: Value) -> None:
        """Remember what a line stands for."""
        self._used[f"{start} {text}"] = _plain(value)
        self._is_new = True

    def keep(self) -> None:
        """Write the lines that this program used, if there is a new one and a place for it."""
        if self._is_new:
            body = json.dumps(self._used, ensure_ascii=False)
            with suppress(OSError):
                write_whole(self._path, f"{self._head(body)}\n{body}")
            self._is_new = False

    @cached_property
    def _kept(self) -> dict[str, Plain]:
        try:
            head, _, body = self._path.read_text(encoding="utf-8").partition("\n")
            return json.loads(body) if head == self._head(body) else {}
        except (OSError, ValueError):
            return {}

    @cached_property
    def _version(self) -> str:
        folder = Path(__file__).parent
        return content_key(*((folder / name).read_bytes() for name in _SOURCES))

    def _head(self, body: str) -> str:
        return f"{self._version} {content_key(body.encode())}"


def _plain(value: Value | float) -> Plain:
    plain: Plain
    match value:
        case AtomicCategory(name) | Basic(name) | Constant(name):
            plain = name
        case Bound(index):
            plain = index
        case Functor(result, argument, forward, composes):
            slash = ("/" if forward else "\\") + ("^" if composes else "")
            plain = [_plain(result), slash, _plain(argument)]
        case Lambda(body, hint):
            plain = ["λ", hint, _plain(body)]
        case FunctionType(one, other) | Apply(one, other):
            plain = [_plain(one), _plain(other)]
        case tuple():
            plain = [_plain(each) for each in value]
        case _:
            plain = value
    return plain


def _value(plain: Any, start: Start) -> Value:
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
