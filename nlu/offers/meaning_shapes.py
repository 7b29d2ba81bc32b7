"""Shapes of meanings: the meaning schema with slots in place of the names.

The shape of "a knife is often used for cutting" is a functional rule with the slots `?object`,
`?affordance` and `?degree`. Shapes are composed of the parts of the schema, or taken from the
meanings of utterances, and filled with what another utterance names. A slot of a role that a shape
has twice is numbered: `?object2`.
"""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from itertools import product
from typing import Any, cast

from ..semantics import meaning as meanings
from ..semantics.meaning import Json
from .mentions import Mentions

SLOT_ROLES = ("object", "material", "part", "property", "person", "affordance", "act")

_ROLES_OF_KEYS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("object", "before", "about", "topic"), ("object", "material")),
    "patient": ("object", "material"),
    "material": ("material", "object"),
    "part": ("part",),
    **dict.fromkeys(("affordance", "usedFor", "notUsedFor"), ("affordance",)),
    **dict.fromkeys(("goal", "context"), ("act",)),
    **dict.fromkeys(("recipient", "speaker", "source"), ("person",)),
    "props": ("property",),
}
_NAMING = frozenset(key for key, roles in _ROLES_OF_KEYS.items() if roles != ("act",))


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
        said = (str(value) for _, value in leaves(self.template) if _is_slot(value))
        return tuple(dict.fromkeys(said))

    @cached_property
    def constants(self) -> frozenset[str]:
        """The names that are no slots, without those of acts."""
        said = (str(v) for key, v in leaves(self.template) if key in _NAMING and not _is_slot(v))
        return frozenset(said)

    @cached_property
    def roles(self) -> Mapping[str, tuple[str, ...]]:
        """The slots that a name fills, by its role."""
        found: dict[str, tuple[str, ...]] = {}
        for slot in self.slots:
            if role_of(slot) in SLOT_ROLES:
                found[role_of(slot)] = (*found.get(role_of(slot), ()), slot)
        return found

    @cached_property
    def traits(self) -> tuple[str, ...]:
        """What the shape has in common with others: the kind, the sign, the act, the degree."""
        template = self.template
        rules = template.get("all")
        kinds = {"all", "goal", "patient", "retract", "kind_of", "action", "plan"} & template.keys()
        named = template.keys() & {"rule", "ask", "ack", "norm", "control"}
        kind = "kind=" + "+".join(sorted(kinds | {str(template[key]) for key in named}))
        size = f"size={len(rules) if isinstance(rules, list) else 1}"
        said = sorted({f"{key}={json.dumps(value)}" for key, value in leaves(template)})
        return (kind, size, *said)

    def values_in(self, meaning: Json) -> dict[str, object]:
        """The values that the slots have in a meaning of this shape."""
        pairs = zip(leaves(self.template), leaves(meaning), strict=True)
        return {str(slot): value for (_, slot), (_, value) in pairs if _is_slot(slot)}

    def filled(self, values: Mapping[str, object]) -> Json:
        """The JSON object with the slots filled."""
        return _changed(self.template, lambda old, _: values.get(old) if _is_slot(old) else old)


def shape_of(meaning: Json, mentions: Mentions, tool_acts: Mapping[str, str]) -> MeaningShape:
    """Return the shape of a meaning; a name that the utterance does not have stays as it is."""
    taken: dict[tuple[str, str], str] = {}

    def slotted(value: Any, key: str) -> object:
        if isinstance(value, list):  # a degree
            interval = tuple(cast("list[float]", value))
            return "?degree" if interval in {said for _, _, said in mentions.degrees} else value
        if not isinstance(value, str):
            return value
        for role in _ROLES_OF_KEYS.get(key, ()):
            if value in mentions.by_role.get(role, {}):
                number = sum(known == role for known, _ in taken)
                return taken.setdefault((role, value), f"?{role}{number + 1 if number else ''}")
        if value == tool_acts.get(str(meaning.get("goal"))) and key == "usedFor":
            return "?tool"
        return value

    return shape_from(_changed(meaning, slotted))


def shape_from(template: Json) -> MeaningShape:
    """Return the shape that is this JSON object with slots."""
    return MeaningShape(json.dumps(template, separators=(",", ":")))


_GENERALLY, _NEVER = [0.95, 1.0], [0.0, 0.05]
_DEGREES = ("?degree", _GENERALLY, _NEVER, [0.75, 1.0], [0.5, 1.0], [0.0, 0.25])
_OF_TWO = (*product((_GENERALLY, _NEVER, "?degree"), repeat=2), ("?degree", "?degree2"))
_USE: Json = {"rule": "functional", "object": "?object", "affordance": "?affordance"}
_HOLDING: Json = {"rule": "action", "object": "?object", "context": "?act", "part": "?part"}
_TWO_RULES = (
    (_USE, _USE | {"affordance": "?affordance2"}),
    (_USE, _USE | {"object": "?object2"}),
    (_USE, _USE | {"object": "?object2", "affordance": "?affordance2"}),
    (_USE, _HOLDING),
    (_HOLDING, _HOLDING | {"part": "?part2"}),
    (_HOLDING, _HOLDING | {"context": "?act2", "part": "?part2"}),
)
_TARGETS: tuple[Json, ...] = (
    {"object": "?object"},
    {"object": "?object", "props": ["?property"]},
    {"object": "*", "props": ["?property"]},
    {"usedFor": "?affordance"},
    {"usedFor": "?affordance", "material": "?material"},
    {"notUsedFor": "?affordance"},
)
_ADDED: tuple[Json, ...] = ({}, {"part": "?part"}, {"recipient": "?person"}, {"negated": True})
_TOOLS: tuple[Json, ...] = (
    {"object": "?object2"},
    {"object": "?object2", "props": ["?property"]},
    {"usedFor": "?affordance"},
    {"usedFor": "?tool"},
)
_SLOTS = {k: f"?{k}" for k in ("object", "affordance", "part", "material")} | {"context": "?act"}
_ASKED: Mapping[str, Sequence[str]] = {
    "uses_of about see why why_not confidence source": ("object",),
    "how why why_not confidence source": ("object context",),
    "is_used_for why why_not": ("object affordance", "object affordance material"),
    "confidence source": ("object affordance",),
    "best_for objects_for": ("affordance", "affordance material"),
    "why why_not": ("", "object part", "object context part"),
}


@cache
def composed_shapes() -> tuple[MeaningShape, ...]:
    """Return the shapes that the parts of the schema allow: rules, commands and questions."""
    found = (*_rules(), *_commands(), *_norms(), *_questions())
    return tuple(dict.fromkeys(map(shape_from, found)))


def _rules() -> Iterator[Json]:
    materials: tuple[Json, ...] = ({}, {"material": "?material"}, {"material": "?object2"})
    contexts: tuple[Json, ...] = ({}, *({"context": act} for act in ("grasp", "pass", "pickUp")))
    for degree in _DEGREES:
        yield from (_USE | {"confidence": degree} | material for material in materials)
        yield from (_HOLDING | context | {"confidence": degree} for context in contexts)
    for (one, other), degrees in product(_TWO_RULES, _OF_TWO):
        yield {"all": [one | {"confidence": degrees[0]}, other | {"confidence": degrees[1]}]}


def _commands() -> Iterator[Json]:
    for goal, target, added in product(("?act", "pass", "pointTo", "use"), _TARGETS, _ADDED):
        yield {"goal": goal, "target": target, **added}
    yield {"goal": "grasp", "target": _TARGETS[0], "part": "?part"}
    for tool, added in product(_TOOLS, ({}, {"negated": True})):
        yield {"goal": "?act", "patient": "?object", "tool": tool, **added}


def _norms() -> Iterator[Json]:
    targets = (_TARGETS[0], {"usedFor": "?affordance"})
    for norm, target, added in product(("forbidden", "permitted", "obliged"), targets, _ADDED[:3]):
        yield {"norm": norm, "goal": "?act", "target": target, **added, "confidence": _GENERALLY}


def _questions() -> Iterator[Json]:
    for kinds, said in _ASKED.items():
        for kind, names in product(kinds.split(), said):
            yield {"ask": kind, **{name: _SLOTS[name] for name in names.split()}}


def role_of(slot: str) -> str:
    """The role of a slot without its number: `object` of `?object2`."""
    return slot[1:].rstrip("23456789")


def _is_slot(value: object) -> bool:
    return isinstance(value, str) and value.startswith("?")


def _changed(value: Any, change: Callable[[Any, str], object], key: str = "") -> Any:
    match value:
        case dict():
            return {k: _changed(v, change, k) for k, v in value.items()}
        case list() if key != "confidence":
            return [_changed(each, change, key) for each in value]
        case _:
            return change(value, key)


def leaves(value: object, key: str = "") -> Iterator[tuple[str, object]]:
    """Yield the values in a meaning that have no parts, each with its key."""
    match value:
        case dict():
            for name, each in value.items():
                yield from leaves(each, name)
        case list() if key != "confidence":
            for each in value:
                yield from leaves(each, key)
        case _:
            yield key, value


def meaning_from_json(json_object: Json) -> meanings.Meaning:
    """Return the meaning of a JSON object of the schema; `ValueError` for one without a shape."""
    match json_object:
        case {"all": list(rules)}:
            return meanings.Statement(tuple(map(_record, rules)))
        case {"rule": str()}:
            return meanings.Statement((_record(json_object),))
        case {"retract": {"about": str(about)}}:
            return meanings.Retraction(about=about)
        case {"retract": rule}:
            return meanings.Retraction(_record(rule) if isinstance(rule, dict) else None)
        case {"norm": str(norm), "confidence": confidence, **act}:
            return meanings.NormStatement((meanings.Norm(norm, _record(act), _value(confidence)),))
        case {"parameters": _} | {"goal": _} | {"ask": _} | {"ack": _}:
            return _record(json_object)
        case _:
            raise ValueError(f"There is no shape for {json_object}.")


_RECORDS: Mapping[str, Callable[..., Any]] = {
    "parameters": meanings.ActionDefinition,
    "patient": meanings.ToolCommand,
    "target": meanings.Command,
    "goal": meanings.ActionCommand,
    "ask": meanings.Question,
    "ack": meanings.Acknowledgement,
    "state": meanings.ActionCondition,
    "after": meanings.FailureReaction,
    "part": meanings.ActionRule,
    "affordance": meanings.FunctionalRule,
    **dict.fromkeys(("object", "usedFor", "notUsedFor"), meanings.ObjectReference),
}
"""The values of the schema, each by a key that only it and later ones have."""

_NAMES = {"usedFor": "used_for", "notUsedFor": "not_used_for"}


def _record(values: Json) -> Any:
    kind = next(kind for key, kind in _RECORDS.items() if key in values)
    return kind(**{_NAMES.get(k, k): _value(v) for k, v in values.items() if k != "rule"})


def _value(value: Any, *, is_listed: bool = False) -> Any:
    match value:
        case dict():
            return _record(value)
        case list():
            return tuple(_value(each, is_listed=True) for each in value)
        case int() if is_listed:
            return float(value)
        case _:
            return value
