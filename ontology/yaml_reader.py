"""Reader for YAML that keeps positions, so that errors name file, line and column.

`read_yaml` returns a `YamlNode`: a value with its position. A loader requests the expected type
(`field.text()`, `field.number(low=0)`, `field.entries(required={...})`) and gets a plain Python
value or a `DataError` that states what was expected and what was found.

Rejected are tags, aliases (a small file could expand to gigabytes), duplicate keys, and files
larger than `MAX_BYTES`.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .errors import DataError

MAX_BYTES = 64 * 2**20
MAX_DEPTH = 64


@dataclass(frozen=True)
class YamlNode:
    """A value of a YAML file with its position.

    Attributes:
        value: the plain value: `str`, `int`, `float`, `bool`, `None`, or for a list and a mapping
            a tuple of `YamlNode` and a dict from key to `YamlNode`.
        source: the file it was read from.
        line: 1-based line of its first character.
        column: 1-based column of its first character.
        text_line: the line itself, for the caret below it.
        keys: the keys of a mapping, in the order of the file.
    """

    value: Any
    source: str
    line: int
    column: int
    text_line: str = dataclasses.field(default="", compare=False, repr=False)
    keys: tuple[YamlNode, ...] = dataclasses.field(default=(), compare=False, repr=False)

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

    def items(self) -> tuple[YamlNode, ...]:
        """Return the items of a list."""
        if not isinstance(self.value, tuple):
            raise self.fail(f"expected a list, found {self.shown()}.")
        return self.value

    def listed(self) -> tuple[YamlNode, ...]:
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
    ) -> dict[str, YamlNode]:
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

    def plain(self) -> Any:
        """Return this value as plain Python data, without positions."""
        if isinstance(self.value, tuple):
            return [item.plain() for item in self.value]
        if isinstance(self.value, dict):
            return {key: field.plain() for key, field in self.value.items()}
        return self.value

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
    """Return the text of a file in UTF-8, without a byte order mark.

    `DataError` where it cannot be read, is larger than `most_bytes`, or is not UTF-8.
    """
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

    loader = getattr(yaml, "CSafeLoader", yaml.SafeLoader)(text)
    try:
        return _FieldBuilder(loader, source, text.splitlines()).document()
    except yaml.MarkedYAMLError as error:
        raise _syntax_error(error, text, source) from error
    except yaml.YAMLError as error:
        raise DataError(f"is not YAML: {error}.", source=source) from error
    finally:
        loader.dispose()


def _syntax_error(error: Any, text: str, source: str) -> DataError:
    mark = error.problem_mark or error.context_mark
    lines = text.splitlines()
    shown = lines[mark.line] if mark.line < len(lines) else ""
    place = {"line": mark.line + 1, "column": mark.column + 1}
    return DataError(f"is not YAML: {error.problem}.", source=source, text=shown, **place)


_TAG = "tag:yaml.org,2002:"
_TEXT = f"{_TAG}str"
_PLAIN = frozenset({"str", "int", "float", "bool", "null", "seq", "map"})
_END = frozenset({"SequenceEndEvent", "MappingEndEvent"})


class _FieldBuilder:
    """Builds fields in one pass from the events of a YAML loader, which also converts scalars."""

    def __init__(self, loader: Any, source: str, lines: Sequence[str]) -> None:
        self._loader, self._source, self._lines = loader, source, lines
        self._next: Callable[[], Any] = loader.get_event
        self._tags: dict[str, str] = {}
        self._depth = 0

    def document(self) -> YamlNode:
        self._next()
        event = self._next()
        if type(event).__name__ == "StreamEndEvent":
            raise DataError("the file is empty.", source=self._source)
        field = self._field(self._next())
        self._next()
        event = self._next()
        if type(event).__name__ != "StreamEndEvent":
            raise self._at(event, None).fail("expected one document, found a second one.")
        return field

    def _field(self, event: Any) -> YamlNode:
        kind = type(event).__name__
        if kind == "ScalarEvent":
            return self._scalar(event)
        if kind == "AliasEvent":
            raise self._at(event, None).fail("aliases are not allowed.")
        self._depth += 1
        if self._depth > MAX_DEPTH:
            raise self._at(event, None).fail("nested too deeply.")
        is_list = kind == "SequenceStartEvent"
        if event.tag is not None and event.tag != f"{_TAG}{'seq' if is_list else 'map'}":
            raise self._tag_error(event, event.tag)
        field = self._at(event, self._items()) if is_list else self._mapping(event)
        self._depth -= 1
        return field

    def _items(self) -> tuple[YamlNode, ...]:
        items: list[YamlNode] = []
        while type(event := self._next()).__name__ not in _END:
            items.append(self._field(event))
        return tuple(items)

    def _mapping(self, start: Any) -> YamlNode:
        entries: dict[str, YamlNode] = {}
        keys: list[YamlNode] = []
        while type(event := self._next()).__name__ not in _END:
            key = self._field(event)
            if key.text() in entries:
                raise key.fail(f'the key "{key.value}" is given twice.')
            keys.append(key)
            entries[key.value] = self._field(self._next())
        return self._at(start, entries, tuple(keys))

    def _scalar(self, event: Any) -> YamlNode:
        # Fast path: most values are quoted texts.
        if event.tag in {None, "!"} and not event.implicit[0]:
            return self._at(event, event.value)
        tag = self._tag(event)
        if tag == _TEXT:
            return self._at(event, event.value)
        if tag.removeprefix(_TAG) not in _PLAIN:
            raise self._tag_error(event, tag)
        from yaml.nodes import ScalarNode

        node = ScalarNode(tag, event.value, event.start_mark, event.end_mark)
        return self._at(event, self._loader.construct_object(node))

    def _tag(self, event: Any) -> str:
        if event.tag is not None:
            return event.tag
        found = self._tags.get(event.value)
        if found is None:
            from yaml.nodes import ScalarNode

            found = self._loader.resolve(ScalarNode, event.value, (True, False))
            self._tags[event.value] = found
        return found

    def _at(self, event: Any, value: object, keys: tuple[YamlNode, ...] = ()) -> YamlNode:
        mark = event.start_mark
        line: int = mark.line
        text = self._lines[line] if line < len(self._lines) else ""
        return YamlNode(value, self._source, line + 1, mark.column + 1, text, keys)

    def _tag_error(self, event: Any, tag: str) -> DataError:
        return self._at(event, None).fail(
            f'the type "{tag}" is not allowed; write a text in quotes, a number, true or false, a '
            "list or a mapping."
        )
