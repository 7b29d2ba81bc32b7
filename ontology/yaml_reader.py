"""Reader for YAML and flat TOML that keeps positions: errors name file, line and column.

`read_yaml` and `read_toml` return a `YamlNode`: a value with its position. A loader requests the
expected type (`field.text()`, `field.number(low=0)`, `field.entries(required={...})`) and gets a
plain Python value or a `DataError` that states what was expected and what was found.

Rejected are tags, aliases (which could expand to gigabytes), duplicate keys, and large files.
"""

import dataclasses
import re
import sys
from collections.abc import Callable, Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from .errors import DataError

MAX_BYTES = 64 * 2**20
MAX_DEPTH = 64
_PLACE = re.compile(r" \(at (?:line (\d+), column (\d+)|end of document)\)$")  # in a TOML


@dataclass(frozen=True)
class YamlNode:
    """A value of a YAML file with its position."""

    #: the plain value: `str`, `int`, `float`, `bool`, `None`, or for a list and a mapping a tuple
    #: of `YamlNode` and a dict from key to `YamlNode`
    value: Any
    source: str  #: the file it was read from
    line: int  #: of its first character, 1-based
    column: int  #: the same
    text_line: str = dataclasses.field(default="", compare=False, repr=False)  #: for the caret
    #: the keys of a mapping, in the order of the file
    keys: "tuple[YamlNode, ...]" = dataclasses.field(default=(), compare=False, repr=False)

    def fail(self, problem: str) -> DataError:
        """Return an error about this value, with its position."""
        return DataError(
            problem, source=self.source, line=self.line, column=self.column, text=self.text_line
        )

    def text(self, *, choices: Collection[str] | None = None) -> str:
        """Return this value as a non-empty text; it must be one of `choices` if given."""
        if not isinstance(self.value, str) or not self.value:
            raise self.fail(f"expected a text, found {self.shown()}.")
        if choices is not None and self.value not in choices:
            raise self.fail(
                f'expected one of {", ".join(sorted(choices)) or "none"}, found "{self.value}"'
                f"{_suggestion(self.value, choices)}."
            )
        return self.value

    def number(self, *, low: float = -1e9, high: float = 1e9) -> float:
        """Return this value as a number in [low, high]."""
        if isinstance(self.value, bool) or not isinstance(self.value, (int, float)):
            raise self.fail(f"expected a number in [{low:g}, {high:g}], found {self.shown()}.")
        if not low <= self.value <= high:
            raise self.fail(f"expected a number in [{low:g}, {high:g}], found {self.value:g}.")
        return float(self.value)

    def numbers(
        self, *, count: int | None = None, low: float = -1e9, high: float = 1e9
    ) -> tuple[float, ...]:
        """Return this value as a list of (`count`) numbers in [low, high]."""
        values = tuple(item.number(low=low, high=high) for item in self.items())
        if count is not None and len(values) != count:
            raise self.fail(f"expected {count} numbers, found {len(values)}.")
        return values

    def integer(self, *, low: int = -(10**9), high: int = 10**9) -> int:
        """Return this value as an integer in [low, high]."""
        if isinstance(self.value, bool) or not isinstance(self.value, int):
            raise self.fail(f"expected a whole number, found {self.shown()}.")
        return int(self.number(low=low, high=high))

    def truth(self) -> bool:
        """Return this value as a Boolean."""
        if not isinstance(self.value, bool):
            raise self.fail(f"expected true or false, found {self.shown()}.")
        return self.value

    def items(self) -> "tuple[YamlNode, ...]":
        """Return the items of a list."""
        if not isinstance(self.value, tuple):
            raise self.fail(f"expected a list, found {self.shown()}.")
        return self.value

    def listed(self) -> "tuple[YamlNode, ...]":
        """Return the items of a list, or this value alone if it is none."""
        return self.value if isinstance(self.value, tuple) else (self,)

    def texts(
        self, *, count: int | None = None, choices: Collection[str] | None = None
    ) -> tuple[str, ...]:
        """Return this value as a list of (`count`) texts."""
        values = tuple(item.text(choices=choices) for item in self.items())
        if count is not None and len(values) != count:
            raise self.fail(f"expected {count} texts, found {len(values)}.")
        return values

    def entries(
        self, *, required: Collection[str] = (), optional: Collection[str] | None = None
    ) -> "dict[str, YamlNode]":
        """Return the entries of a mapping, in the order of the file.

        Keys in `required` must exist, those in `optional` may; None allows any other key.
        """
        if not isinstance(self.value, dict):
            raise self.fail(f"expected a mapping, found {self.shown()}.")
        found: dict[str, YamlNode] = self.value
        known = {*required, *(optional or ())}
        for key in self.keys if optional is not None else ():
            if key.value not in known:
                expected = ", ".join(sorted(known))
                close = _suggestion(key.value, known)
                raise key.fail(f'unknown key "{key.value}"{close}; expected {expected}.')
        for name in required:
            if name not in found:
                raise self.fail(f'the key "{name}" is missing; found {", ".join(found) or "none"}.')
        return found

    def shown(self) -> str:
        """Return the description of this value for an error message."""
        if isinstance(self.value, dict):
            return "a mapping"
        if isinstance(self.value, tuple):
            return "a list"
        if self.value is None:
            return "nothing"
        return f'"{self.value}"' if isinstance(self.value, str) else str(self.value)


def _suggestion(name: str, known: Collection[str]) -> str:
    from difflib import get_close_matches  # imported only when an error is reported

    close = get_close_matches(name, list(known), n=1)
    return f' (did you mean "{close[0]}"?)' if close else ""


def read_yaml(path: Path) -> YamlNode:
    """Read a YAML file; `DataError` where it is none, or uses a rejected feature."""
    return parse_yaml(read_text(path, most_bytes=MAX_BYTES), source=str(path))


def read_text(path: Path, *, most_bytes: int | None = None) -> str:
    """Return the text of a file in UTF-8; `DataError` if it is larger or cannot be read."""
    try:
        if most_bytes is not None and path.stat().st_size > most_bytes:
            raise DataError(f"the file is larger than {most_bytes} bytes.", source=str(path))
        return path.read_text(encoding="utf-8-sig")
    except UnicodeDecodeError as error:
        problem = f"expected UTF-8 text; byte {error.start} is not."
        raise DataError(problem, source=str(path)) from error
    except OSError as error:
        raise DataError(f"cannot be read: {error.strerror}.", source=str(path)) from error


def parse_yaml(text: str, *, source: str = "<text>") -> YamlNode:
    """Read YAML from a text, as `read_yaml` does from a file."""
    import yaml  # imported here to save start-up time

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)
    reader = _NodeReader(source, text.splitlines(), yaml.SafeLoader("").construct_object)
    try:
        reader.check(yaml.parse(text, Loader=loader))
        document = yaml.compose(text, Loader=loader)
    except yaml.MarkedYAMLError as error:
        mark: Any = error.problem_mark or error.context_mark
        raise reader.node(mark, None).fail(f"is not YAML: {error.problem}.") from error
    except yaml.YAMLError as error:
        raise DataError(f"is not YAML: {error}.", source=source) from error
    if document is None:
        raise DataError("the file is empty.", source=source)
    return reader.read(document)


@dataclass(frozen=True)
class _NodeReader:
    source: str
    lines: Sequence[str]
    convert: Callable[[Any], Any]  # the value of a scalar that is no text

    def check(self, events: Iterable[Any]) -> None:
        depth = documents = 0
        for event in events:
            kind = type(event).__name__
            depth += kind.endswith("StartEvent") - kind.endswith("EndEvent")
            documents += kind == "DocumentStartEvent"
            if kind == "AliasEvent":
                raise self.node(event.start_mark, None).fail("aliases are not allowed.")
            if depth > MAX_DEPTH + 2:  # the stream and the document begin, too
                raise self.node(event.start_mark, None).fail("nested too deeply.")
            if documents > 1:
                problem = "expected one document, found a second one."
                raise self.node(event.start_mark, None).fail(problem)

    def read(self, found: Any) -> YamlNode:
        match found.id, found.tag.removeprefix("tag:yaml.org,2002:"):
            case "scalar", "str":
                return self.node(found.start_mark, found.value)
            case "scalar", "int" | "float" | "bool" | "null":
                return self.node(found.start_mark, self.convert(found))
            case "sequence", "seq":
                return self.node(found.start_mark, tuple(map(self.read, found.value)))
            case "mapping", "map":
                entries: dict[str, YamlNode] = {}
                keys: list[YamlNode] = []
                for name, value in found.value:
                    keys.append(key := self.read(name))
                    if key.text() in entries:
                        raise key.fail(f'the key "{key.value}" is given twice.')
                    entries[key.value] = self.read(value)
                return self.node(found.start_mark, entries, tuple(keys))
            case _:
                raise self.node(found.start_mark, None).fail(
                    f'the type "{found.tag}" is not allowed; write a text in quotes, a number, '
                    "true or false, a list or a mapping."
                )

    def node(self, mark: Any, value: object, keys: tuple[YamlNode, ...] = ()) -> YamlNode:
        line: int = mark.line
        text = self.lines[line] if line < len(self.lines) else ""
        return YamlNode(value, self.source, line + 1, mark.column + 1, text, keys)


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
    if sys.version_info >= (3, 11):
        import tomllib  # here: YAML does not need it
    else:
        import tomli as tomllib  # pyright: ignore[reportMissingImports]
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
