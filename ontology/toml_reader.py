"""Reader for flat TOML files: keys and values, without tables.

What is read has the positions of `yaml_reader`, so that an error names file, line and column.
"""

import re
import sys
from pathlib import Path
from typing import Any

from .errors import DataError
from .yaml_reader import YamlNode, read_text

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib  # pyright: ignore[reportMissingImports]

_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")


def read_toml(path: Path) -> YamlNode:
    """Read a file: a mapping of the values, with their positions.

    DataError if it cannot be read, is not UTF-8 or TOML, or has a table.
    """
    text, source = read_text(path), str(path)
    keys: list[YamlNode] = []
    entries: dict[str, YamlNode] = {}
    for key, value in _parse(text, source).items():
        keys.append(_key(key, text, source))
        if isinstance(value, dict):
            raise keys[-1].fail(
                "expected KEY = VALUE; tables and keys with dots are not used here."
            )
        line = keys[-1].text_line
        column = line.find("=") + 1
        column += len(line[column:]) - len(line[column:].lstrip()) + 1
        entries[key] = _node(value, source, keys[-1].line, column, line)
    return YamlNode(entries, source, 1, 1, keys=tuple(keys))


def _key(key: str, text: str, source: str) -> YamlNode:
    beginning = re.compile(rf"^\s*\[*\s*[\"']?{re.escape(key)}\b")
    lines = enumerate(text.split("\n"), start=1)
    number, line = next(((n, line) for n, line in lines if beginning.match(line)), (1, ""))
    return YamlNode(key, source, number, len(line) - len(line.lstrip()) + 1, line)


def _parse(text: str, source: str) -> dict[str, Any]:
    try:
        return tomllib.loads(text)
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
