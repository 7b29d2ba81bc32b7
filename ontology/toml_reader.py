"""Reader for flat TOML files: keys and values, without tables.

What is read has the positions of `yaml_reader`, so that an error names file, line and column.
"""

import re
import sys
from functools import partial
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
    """Read a mapping of values with their places; `DataError` if it is no TOML or has a table."""
    text, source = read_text(path), str(path)
    keys: list[YamlNode] = []
    entries: dict[str, YamlNode] = {}
    for key, value in _parse(text, source).items():
        beginning = re.compile(rf"^\s*\[*\s*[\"']?{re.escape(key)}\b")
        lines = enumerate(text.split("\n"), start=1)
        number, line = next(((n, line) for n, line in lines if beginning.match(line)), (1, ""))
        keys.append(YamlNode(key, source, number, len(line) - len(line.lstrip()) + 1, line))
        if isinstance(value, dict):
            problem = "expected KEY = VALUE; tables and keys with dots are not used here."
            raise keys[-1].fail(problem)
        column = len(line) - len(line.partition("=")[2].lstrip()) + 1
        node = partial(YamlNode, source=source, line=number, column=column, text_line=line)
        entries[key] = node(tuple(map(node, value)) if isinstance(value, list) else value)
    return YamlNode(entries, source, 1, 1, keys=tuple(keys))


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
