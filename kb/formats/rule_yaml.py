"""The rule sheet: rules as a person writes them by hand, in YAML.

    speaker: sam
    rules:
      - {object: knife, affordance: cutting, interval: [0.95, 1]}
      - {object: knife, context: pass, part: blade, interval: 0.95}
      - {object: knife, forbidden: pass, contexts: "role:child", interval: 0.95}

`docs/files.md` lists all keys. A mistake is reported with its line and column.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import TextIO

from ...ontology.errors import DataError, HiltError
from ...ontology.yaml_reader import YamlNode, parse_yaml
from ..interval import Interval
from ..rule import GRASP_OBJECT, NORMS, USED_FOR, Atom, Rule
from . import value_notation
from .csv_table import Cells

_CONCLUSIONS = ("affordance", "part", "functor", *NORMS)
_KEYS = (
    *("object", "properties", "features", "context", "contexts", "material"),
    *(*_CONCLUSIONS, "argument", "interval", "speaker", "status", "time"),
)


def read_sheet(text: str, *, source: str) -> Iterator[Rule]:
    """Iterate over the rules of a sheet, in its order.

    Raises:
        DataError: entries are malformed; lists the first mistakes with their places.
    """
    sheet = parse_yaml(text, source=source).entries(required=["rules"], optional=["speaker"])
    speaker = sheet["speaker"].text() if "speaker" in sheet else None
    yield from value_notation.read_all(sheet["rules"].items(), lambda entry: _rule(entry, speaker))


def write_sheet(target: TextIO, rules: Iterable[Cells]) -> None:
    """Write a sheet with an entry for each rule."""
    target.write("# Rules of Hilt, one a line: features, contexts, conclusion, interval.\nrules:")
    end = " []\n"
    for cells in rules:
        target.write(_written_rule(cells))
        end = "\n"
    target.write(end)


def _rule(entry: YamlNode, speaker: str | None) -> Rule:
    found = entry.entries(required=["interval"], optional=_KEYS)
    try:
        functor, argument = _conclusion(entry, found)
        return value_notation.make_rule(
            _features(found),
            _contexts(found),
            functor,
            argument,
            _interval(found["interval"]),
            speaker=found["speaker"].text() if "speaker" in found else speaker,
            status=_optional(found, "status"),
            time=_optional(found, "time"),
        )
    except DataError:
        raise
    except HiltError as error:
        raise entry.fail(str(error)) from error


def _features(found: Mapping[str, YamlNode]) -> frozenset[Atom]:
    seen = _atoms(found.get("object"), "object") | _atoms(found.get("features"), "object")
    return seen | _atoms(found.get("properties"), "property")


def _contexts(found: Mapping[str, YamlNode]) -> frozenset[Atom]:
    keys = ("context", "contexts", *NORMS)
    acting = frozenset[Atom]().union(*(_atoms(found.get(key), "action") for key in keys))
    return acting | _atoms(found.get("material"), "material")


def _atoms(field: YamlNode | None, kind: str) -> frozenset[Atom]:
    """The atoms of one text or of a list of them."""
    if field is None:
        return frozenset()
    fields = field.items() if isinstance(field.value, tuple) else (field,)
    return frozenset().union(*(_placed(one, kind) for one in fields))


def _placed(field: YamlNode, kind: str) -> frozenset[Atom]:
    try:
        return value_notation.read_atoms([field.text()], kind)
    except DataError:
        raise
    except HiltError as error:
        raise field.fail(str(error)) from error


def _conclusion(entry: YamlNode, found: Mapping[str, YamlNode]) -> tuple[str, Atom | None]:
    given = [key for key in _CONCLUSIONS if key in found]
    if len(given) != 1:
        raise entry.fail(
            f"a rule concludes one thing: expected one of {', '.join(_CONCLUSIONS)}, "
            f"found {' and '.join(given) or 'none'}."
        )
    if given[0] in {"affordance", "part"} and "argument" in found:
        raise found["argument"].fail(f'"argument" goes with "functor", not with "{given[0]}".')
    name = given[0] if given[0] in NORMS else found[given[0]].text()
    if given == ["affordance"]:
        return USED_FOR, value_notation.read_atom(name, "affordance")
    if given == ["part"]:
        return GRASP_OBJECT, value_notation.read_atom(name, "part")
    return name, value_notation.read_argument(_optional(found, "argument") or "", name)


def _interval(field: YamlNode) -> Interval:
    """A list of two bounds, or the lower one alone."""
    if not isinstance(field.value, tuple):
        return Interval(field.number(low=0, high=1), 1.0)
    lower, upper = field.numbers(count=2, low=0, high=1)
    if lower > upper:
        raise field.fail(f"expected a lower bound and then an upper one, found {lower}, {upper}.")
    return Interval(lower, upper)


def _optional(found: Mapping[str, YamlNode], key: str) -> str | None:
    return found[key].text() if key in found else None


def _written_rule(cells: Cells) -> str:
    """The line of a rule; the status of an active one is left out."""
    features, contexts, functor, argument, lower, upper, speaker, status, time = cells
    seen, context = _written_atoms(features, "object"), _written_atoms(contexts, "context")
    rest = f", status: {status}" if status != "active" else ""
    if time:
        rest += f', time: "{time}"'
    return (
        f"\n  - {{{seen}{context}{_written_conclusion(functor, argument)}, "
        f"interval: [{lower}, {upper}], speaker: {_quoted(speaker)}{rest}}}"
    )


@lru_cache(maxsize=2**16)
def _written_atoms(cell: str, key: str) -> str:
    """The entry for the features or contexts in a cell, and what divides it from the next."""
    names = [_quoted(name) for name in cell.split(value_notation.BETWEEN)]
    if cell in {"", value_notation.ANY}:
        return ""
    if key == "context" and len(names) == 1 and cell.startswith("material:"):
        return f"material: {_quoted(cell.removeprefix('material:'))}, "
    if len(names) == 1 and ":" not in cell:
        return f"{key}: {names[0]}, "
    return f"{'features' if key == 'object' else 'contexts'}: [{', '.join(names)}], "


@lru_cache(maxsize=2**16)
def _written_conclusion(functor: str, argument: str) -> str:
    """The entries for the functor and the argument of a rule."""
    if functor in {USED_FOR, GRASP_OBJECT}:
        return f"{'affordance' if functor == USED_FOR else 'part'}: {_quoted(argument)}"
    return f"functor: {functor}" + (f", argument: {_quoted(argument)}" if argument else "")


@lru_cache(maxsize=2**16)
def _quoted(text: str) -> str:
    """A text as YAML reads it back as a text: bare when it is one plain word, else in quotes."""
    if text.isascii() and text.isalpha() and text.lower() not in _NO_TEXTS:
        return text
    return '"' + text.replace("\\", "\\\\").replace('"', '\\"') + '"'


_NO_TEXTS = frozenset({"true", "false", "yes", "no", "on", "off", "null", "y", "n", "inf", "nan"})
