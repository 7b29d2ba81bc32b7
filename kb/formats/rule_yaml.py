"""The rule sheet: rules as a person writes them by hand, in YAML.

    speaker: sam
    rules:
      - {object: knife, affordance: cutting, interval: [0.95, 1]}
      - {object: knife, context: pass, part: blade, interval: 0.95}
      - {object: knife, forbidden: pass, contexts: "role:child", interval: 0.95}

`docs/files.md` lists all keys. A mistake is reported with its line and column.
"""

from collections.abc import Iterable, Iterator, Mapping
from functools import lru_cache
from typing import Any, TextIO

from ...ontology.errors import IntervalError, ValidationError
from ...ontology.yaml_reader import YamlNode, parse_yaml
from ..interval import Interval
from ..rdf.terms import write_time
from ..rule import ARGUMENT_KINDS, GRASP_OBJECT, KIND_OF, NORMS, USED_FOR, Atom, Rule
from . import value_notation

_MAX_LINE = 2**20  # characters of an entry
_ARGUMENTS = {USED_FOR: "affordance", GRASP_OBJECT: "part", KIND_OF: "kind_of"}  # functor -> key
_CONCLUSIONS = (*_ARGUMENTS.values(), "functor", *NORMS)
# Key of atoms -> the kind of those that are written without one.
_FEATURES = {"object": "object", "features": "object", "properties": "property"}
_CONTEXTS = {**dict.fromkeys(("context", "contexts", *NORMS), "action"), "material": "material"}
_SOURCE = ("speaker", "status", "time")
_KEYS = (*_FEATURES, *_CONTEXTS, *_CONCLUSIONS, "argument", "interval", *_SOURCE)


def read_sheet(text: str, *, source: str) -> Iterator[Rule]:
    """Iterate over the rules of a sheet, in its order; a DataError lists the first mistakes."""
    sheet = parse_yaml(text, source=source).entries(required=["rules"], optional=["speaker"])
    speaker = _optional(sheet, "speaker")
    yield from value_notation.read_all(sheet["rules"].items(), lambda entry: _rule(entry, speaker))


def write_sheet(target: TextIO, rules: Iterable[Rule]) -> None:
    """Write a sheet with an entry for each rule."""
    target.write("# Rules of Hilt, one a line: features, contexts, conclusion, interval.\nrules:")
    end = " []\n"
    for rule in rules:
        entry = ", ".join(f"{key}: {_written(value)}" for key, value in _entry(rule).items())
        target.write(f"\n  - {{{entry}}}")
        end = "\n"
    target.write(end)


def _rule(entry: YamlNode, speaker: str) -> Rule:
    found = entry.entries(required=["interval"], optional=_KEYS)
    try:
        functor, argument = _conclusion(entry, found)
        said = [_optional(found, key) for key in _SOURCE]
        source = value_notation.read_source(said[0] or speaker, *said[1:])
        features, contexts = _atoms(found, _FEATURES), _atoms(found, _CONTEXTS)
        return Rule(features, contexts, functor, argument, _interval(found["interval"]), **source)
    except (IntervalError, ValidationError) as error:
        raise entry.fail(str(error)) from error


def _atoms(found: Mapping[str, YamlNode], kinds: Mapping[str, str]) -> frozenset[Atom]:
    atoms = set[Atom]()
    for key, kind in kinds.items():
        for field in found[key].listed() if key in found else ():
            try:
                atoms |= value_notation.read_atoms([field.text()], kind)
            except ValidationError as error:
                raise field.fail(str(error)) from error
    return frozenset(atoms)


def _conclusion(entry: YamlNode, found: Mapping[str, YamlNode]) -> tuple[str, Atom | None]:
    given = [key for key in _CONCLUSIONS if key in found]
    if len(given) != 1:
        raise entry.fail(
            f"a rule concludes one thing: expected one of {', '.join(_CONCLUSIONS)}, "
            f"found {' and '.join(given) or 'none'}."
        )
    if given[0] in _ARGUMENTS.values() and "argument" in found:
        raise found["argument"].fail(f'"argument" goes with "functor", not with "{given[0]}".')
    name = given[0] if given[0] in NORMS else found[given[0]].text()
    for functor, key in _ARGUMENTS.items():
        if given == [key]:
            return functor, value_notation.read_atom(name, ARGUMENT_KINDS[functor])
    argument = _optional(found, "argument").strip()
    return name, value_notation.read_atom(argument, ARGUMENT_KINDS.get(name)) if argument else None


def _interval(field: YamlNode) -> Interval:
    if not isinstance(field.value, tuple):
        return Interval(field.number(low=0, high=1), 1.0)
    lower, upper = field.numbers(count=2, low=0, high=1)
    if lower > upper:
        raise field.fail(f"expected a lower bound and then an upper one, found {lower}, {upper}.")
    return Interval(lower, upper)


def _optional(found: Mapping[str, YamlNode], key: str) -> str:
    return found[key].text() if key in found else ""


@lru_cache(maxsize=2**16)
def _written(value: str | tuple[str, ...] | Interval) -> str:
    if isinstance(value, Interval):
        return f"[{', '.join(map(value_notation.write_bound, (value.lower, value.upper)))}]"
    import yaml  # imported here to save start-up time

    dumper = getattr(yaml, "CSafeDumper", yaml.SafeDumper)
    style: Any = {"default_flow_style": True, "allow_unicode": True, "width": _MAX_LINE}
    return yaml.dump([value], Dumper=dumper, **style).rstrip()[1:-1]


def _entry(rule: Rule) -> dict[str, str | tuple[str, ...] | Interval]:
    entry: dict[str, str | tuple[str, ...] | Interval] = {}
    for atoms, kind, one in (
        (rule.features, value_notation.FEATURE_KIND, "object"),
        (rule.contexts, value_notation.CONTEXT_KIND, "context"),
    ):
        names = tuple(value_notation.write_atom(atom, kind) for atom in sorted(atoms))
        if len(names) == 1 and ":" not in names[0]:
            entry[one] = names[0]
        elif names:
            entry["contexts" if one == "context" else "features"] = names
    if rule.functor not in _ARGUMENTS:
        entry["functor"] = rule.functor
    if rule.argument:
        said = value_notation.write_atom(rule.argument, ARGUMENT_KINDS.get(rule.functor))
        entry[_ARGUMENTS.get(rule.functor, "argument")] = said
    entry |= {"interval": rule.interval, "speaker": rule.speaker}
    if rule.status != "active":
        entry["status"] = rule.status
    if rule.time:
        entry["time"] = write_time(rule.time)
    return entry
