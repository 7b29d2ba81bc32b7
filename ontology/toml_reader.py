"""Reader and writer for flat TOML files: lines `key = value`, without tables.

What is read has the positions of `yaml_reader`, so that an error names file, line and column. What
is written changes one value and keeps all else, comments included.
"""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import DataError
from .yaml_reader import YamlNode, read_text

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

_ASSIGNMENT = re.compile(r"\s*([\w-]+|\"[^\"]*\"|'[^']*')\s*=\s*")
_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


@dataclass(frozen=True)
class _Statement:
    key: str
    value: Any
    first: int  # index of its first line
    end: int  # index of the line after it
    column: int  # of the value


def read_toml(path: Path) -> YamlNode:
    """Read a file: a mapping of the values, with their positions.

    Raises:
        DataError: it cannot be read, is not UTF-8 or TOML, or has a table.
    """
    text, source = read_text(path), str(path)
    lines = text.split("\n")
    entries: dict[str, YamlNode] = {}
    keys: list[YamlNode] = []
    for each in _statements(text, source):
        place = (source, each.first + 1)
        entries[each.key] = _node(each.value, *place, each.column, lines[each.first])
        indent = len(lines[each.first]) - len(lines[each.first].lstrip())
        keys.append(YamlNode(each.key, *place, indent + 1, lines[each.first]))
    return YamlNode(entries, source, 1, 1, keys=tuple(keys))


def with_value(text: str, source: str, key: str, value: object) -> str:
    """Return the text of a file in which a key has this value; None removes the key.

    Raises:
        DataError: the text is not TOML, or has a table.
    """
    lines = text.splitlines()
    old = next((each for each in _statements(text, source) if each.key == key), None)
    first, end = (old.first, old.end) if old else (len(lines), len(lines))
    # The strings and lists of JSON are also those of TOML.
    new = [] if value is None else [f"{key} = {json.dumps(value, ensure_ascii=False)}"]
    lines[first:end] = new
    return "".join(f"{line}\n" for line in lines)


def _statements(text: str, source: str) -> Iterator[_Statement]:
    _parse(text, source)
    lines, at = text.split("\n"), 0
    while at < len(lines):
        found, end = _ASSIGNMENT.match(lines[at]), at + 1
        if found:
            while (values := _complete("\n".join(lines[at:end]))) is None:
                end += 1
            ((key, value),) = values.items()
            yield _Statement(key, value, at, end, found.end() + 1)
        elif lines[at].strip() and not lines[at].lstrip().startswith("#"):
            problem = "expected KEY = VALUE; tables and keys with dots are not used here."
            raise DataError(problem, source=source, line=at + 1, column=1, text=lines[at])
        at = end


def _complete(text: str) -> dict[str, Any] | None:
    try:
        return tomllib.loads(text)
    except tomllib.TOMLDecodeError:
        return None  # its last lines are missing


def _parse(text: str, source: str) -> None:
    try:
        tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        lines = text.splitlines() or [""]
        place = _PLACE.search(str(error))
        at_end = (len(lines), len(lines[-1]) + 1)
        line, column = map(int, place.groups()) if place and place[1] else at_end
        problem = f"is not TOML: {_PLACE.sub('', str(error))}."
        shown = lines[min(line, len(lines)) - 1]
        raise DataError(problem, source=source, line=line, column=column, text=shown) from error


def _node(value: Any, source: str, line: int, column: int, text: str) -> YamlNode:
    if isinstance(value, list):
        value = tuple(_node(each, source, line, column, text) for each in value)
    return YamlNode(value, source, line, column, text)
