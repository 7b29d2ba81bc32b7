"""Shapes of meanings: the meaning schema with slots in place of the names.

The shape of "a knife is often used for cutting" is a functional rule with the slots `?object`,
`?affordance` and `?degree`. Shapes are taken from the meanings of utterances, and filled with what
another utterance names. A slot of a role that a shape has twice is numbered: `?object2`.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

from ..semantics.meaning import (
    Acknowledgement,
    Act,
    ActionCommand,
    ActionCondition,
    ActionDefinition,
    ActionRule,
    Command,
    FailureReaction,
    FunctionalRule,
    Json,
    Meaning,
    ObjectReference,
    Question,
    Retraction,
    Rule,
    Statement,
    ToolCommand,
)
from .mentions import Mentions

SLOT_ROLES = ("object", "material", "part", "property", "person", "affordance", "act")

_ROLES_OF_KEYS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("object", "before", "about", "topic"), ("object", "material")),
    "patient": ("object", "material"),
    "material": ("material", "object"),
    "part": ("part",),
    **dict.fromkeys(("affordance", "usedFor", "notUsedFor"), ("affordance",)),
    **dict.fromkeys(("goal", "context"), ("act",)),
    **dict.fromkeys(("recipient", "speaker"), ("person",)),
    "props": ("property",),
}


@dataclass(frozen=True)
class MeaningShape:
    """A meaning with slots, as compact JSON; a slot is a string that begins with `?`."""

    text: str

    @cached_property
    def template(self) -> Json:
        """The JSON object with slots."""
        return json.loads(self.text)

    @cached_property
    def slots(self) -> tuple[str, ...]:
        """The slots, each once, in the order of the meaning."""
        return tuple(dict.fromkeys(_slots(self.template)))

    @cached_property
    def constants(self) -> frozenset[str]:
        """The names that are no slots, without those of acts."""
        names = (
            value
            for key, value in _leaves(self.template)
            if key in _ROLES_OF_KEYS and _ROLES_OF_KEYS[key] != ("act",)
        )
        return frozenset(str(name) for name in names if not str(name).startswith("?"))

    @cached_property
    def roles(self) -> Mapping[str, tuple[str, ...]]:
        """The slots that a name fills, by its role."""
        found: dict[str, tuple[str, ...]] = {}
        for slot in self.slots:
            role = slot[1:].rstrip("23456789")
            if role in SLOT_ROLES:
                found[role] = (*found.get(role, ()), slot)
        return found

    @cached_property
    def traits(self) -> tuple[str, ...]:
        """What the shape has in common with others: the kind, the sign, the act, the degree."""
        return tuple(dict.fromkeys((self.text, *_traits(self.template))))

    def filled(self, values: Mapping[str, object]) -> Json:
        """The JSON object with the slots filled."""
        return {key: _filled(value, values) for key, value in self.template.items()}


def shape_of(meaning: Json, mentions: Mentions, tool_acts: Mapping[str, str]) -> MeaningShape:
    """Return the shape of a meaning; a name that the utterance does not have stays as it is."""
    taken: dict[tuple[str, str], str] = {}

    def change(key: str, value: object, within: Json) -> object:
        match value:
            case dict():
                return {k: change(k, v, value) for k, v in value.items()}
            case list() if key == "confidence":
                return degree(value, within)
            case list():
                return [change(key, each, within) for each in value]
            case str():
                return slot(key, value, within)
            case _:
                return value

    def degree(value: list[object], within: Json) -> object:
        if any(tuple(value) == interval for _, _, interval in mentions.degrees):
            return "?degree"
        last = mentions.last
        if last is not None and _is_last(last, within) and value == list(last.confidence):
            return "?last.confidence"
        return value

    def slot(key: str, value: str, within: Json) -> str:
        for role in _ROLES_OF_KEYS.get(key, ()):
            if value in mentions.by_role.get(role, {}):
                return taken.setdefault((role, value), _numbered(role, taken))
        if value == tool_acts.get(str(meaning.get("goal"))) and key == "usedFor":
            return "?tool"
        if _is_last(mentions.last, within) and value == getattr(mentions.last, key, None):
            return f"?last.{key}"
        return "?it" if key == "object" and value == mentions.it else value

    return shape_from({key: change(key, value, meaning) for key, value in meaning.items()})


def shape_from(template: Json) -> MeaningShape:
    """Return the shape that is this JSON object with slots."""
    return MeaningShape(json.dumps(template, separators=(",", ":")))


def _is_last(last: Rule | None, within: Json) -> bool:
    return last is not None and last.as_json()["rule"] == within.get("rule")


def _numbered(role: str, taken: Mapping[tuple[str, str], str]) -> str:
    number = sum(known == role for known, _ in taken)
    return f"?{role}{number + 1 if number else ''}"


def _slots(value: object) -> Iterator[str]:
    match value:
        case dict():
            for each in value.values():
                yield from _slots(each)
        case list():
            for each in value:
                yield from _slots(each)
        case str() if value.startswith("?"):
            yield value
        case _:
            pass


def _filled(value: object, values: Mapping[str, object]) -> object:
    match value:
        case dict():
            return {key: _filled(each, values) for key, each in value.items()}
        case list():
            return [_filled(each, values) for each in value]
        case str() if value.startswith("?"):
            return values[value]
        case _:
            return value


def _traits(template: Json) -> Iterator[str]:
    """The parts of a meaning that its words may express, as `key=value`."""
    rules = template.get("all")
    yield "kind=" + "+".join(sorted({"all"} & template.keys() | set(_kinds(template))))
    yield f"size={len(rules) if isinstance(rules, list) else 1}"
    yield from sorted({f"{key}={json.dumps(value)}" for key, value in _leaves(template)})


def _kinds(template: Json) -> Iterator[str]:
    for key in ("rule", "ask", "ack", "norm", "control"):
        if key in template:
            yield str(template[key])
    yield from (
        key
        for key in ("goal", "patient", "retract", "kind_of", "action", "plan")
        if key in template
    )


def _leaves(value: object, key: str = "") -> Iterator[tuple[str, object]]:
    match value:
        case dict():
            for name, each in value.items():
                yield from _leaves(each, name)
        case list() if key != "confidence":
            for each in value:
                yield from _leaves(each, key)
        case _:
            yield key, value


def meaning_from_json(json_object: Json) -> Meaning:  # noqa: PLR0911 - a case per kind
    """Return the meaning of a JSON object of the schema; `ValueError` for one without a shape."""
    match json_object:
        case {"all": list(rules)}:
            return Statement(tuple(map(_rule, rules)))
        case {"rule": str()}:
            return Statement((_rule(json_object),))
        case {"action": str(), "parameters": list()}:
            return _definition(json_object)
        case {"goal": str()}:
            return _act(json_object)
        case {"ask": str()}:
            return Question(**json_object)  # pyright: ignore
        case {"ack": str(ack)}:
            return Acknowledgement(ack)
        case {"retract": {"about": str(about)}}:
            return Retraction(about=about)
        case {"retract": rule}:
            return Retraction(_rule(rule) if isinstance(rule, dict) else None)
        case _:
            raise ValueError(f"There is no shape for {json_object}.")


def _act(json_object: Json) -> Act:
    """A command; one with neither target nor patient is that of a taught action."""
    if "target" not in json_object and "patient" not in json_object:
        objects = tuple(map(_reference, json_object.get("objects", ())))  # pyright: ignore
        return ActionCommand(str(json_object["goal"]), objects)
    kind = ToolCommand if "tool" in json_object else Command
    names = {"target": _reference, "tool": _reference}
    return kind(**{k: names.get(k, _tuple)(v) for k, v in json_object.items()})  # pyright: ignore


def _definition(json_object: Json) -> ActionDefinition:
    values: dict[str, Any] = json_object
    given: list[dict[str, Any]] = values.get("if_fails", [])
    reactions = (
        FailureReaction(
            tuple(each["after"]), each.get("again", 0), each.get("other", False), _acts(each)
        )
        for each in given
    )
    return ActionDefinition(
        values["action"],
        tuple(values["parameters"]),
        _acts(values),
        tuple(ActionCondition(**each) for each in values.get("only_if", ())),
        tuple(reactions),
        tuple(values.get("links", ())),
    )


def _acts(values: Mapping[str, Any]) -> tuple[Act, ...]:
    return tuple(map(_act, values.get("steps", ())))


def _rule(json_object: Json) -> Rule:
    values = {key: _tuple(value) for key, value in json_object.items() if key != "rule"}
    return (FunctionalRule if json_object["rule"] == "functional" else ActionRule)(**values)  # pyright: ignore


def _reference(json_object: Json) -> ObjectReference:
    names = {"usedFor": "used_for", "notUsedFor": "not_used_for"}
    return ObjectReference(**{names.get(k, k): _tuple(v) for k, v in json_object.items()})  # pyright: ignore


def _tuple(value: object) -> object:
    """A list as a tuple, with floats for all numbers."""
    if not isinstance(value, list):
        return value
    return tuple(float(each) if isinstance(each, int) else each for each in value)
