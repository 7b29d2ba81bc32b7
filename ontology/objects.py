# SPDX-License-Identifier: Apache-2.0
"""The household domain: object types, their parts, and what they are made of.

`objects.yaml` holds the eight household objects of section 4.1 of the paper and the fixtures they
are used with (a table, a nail and its block). An object is a tree of two levels: the object and
its named parts, each of them solids of one material. Nothing here says what an object is for, nor
where it should be grasped: that is learned.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path

from .errors import UnknownNameError
from .geometry import MAX_LENGTH, Colour, Point3, Solid, read_colour, read_solid, read_turn
from .yaml_reader import Field, read_yaml

OBJECTS_FILE = Path(__file__).with_name("objects.yaml")
MAX_MASS = 500.0  # [kg]
MAX_FORCE = 10_000.0  # [N]
_WORDS = re.compile(r"[^\W_]+(?:[-' ][^\W_]+)*")


@dataclass(frozen=True)
class Material:
    """What a part is made of.

    Attributes:
        name: "steel", "wood", ...
        friction: lateral friction coefficient; between two bodies the product of both counts.
        shine: how bright its highlights are, in [0, 1].
    """

    name: str
    friction: float
    shine: float


@dataclass(frozen=True)
class PartType:
    """One named part of an object.

    Attributes:
        name: "handle", "blade", ...
        role: what the part is to the object: "grip", "edge", "container", ...
        properties: what can be perceived of it: "sharp", "long", ...
        material: what it is made of.
        colour: of all its solids that have none of their own.
        mass: [kg].
        shape: the solids it is made of, in the frame of the object.
    """

    name: str
    role: str
    properties: frozenset[str]
    material: Material
    colour: Colour
    mass: float
    shape: tuple[Solid, ...]


@dataclass(frozen=True)
class Rest:
    """A way in which an object can lie or stand on a table.

    Attributes:
        name: "upright", "flat", "upside down", ...
        turn: roll, pitch, yaw of the object's frame before any turn about the vertical [rad].
        usual: whether seeded scenes use it; the others are used only when asked for.
    """

    name: str
    turn: Point3
    usual: bool


@dataclass(frozen=True)
class Mount:
    """How an object stands in another one, as a nail stands in its block.

    Attributes:
        support: the type in which it stands.
        at: where it enters, in the frame of the support; it goes in along its own -z axis [m].
        depth: how deep it is in from the beginning [m].
        deepest: how deep it can be driven [m].
        resistance: with which the support holds it, in both directions [N].
    """

    support: str
    at: Point3
    depth: float
    deepest: float
    resistance: float


@dataclass(frozen=True)
class ObjectType:
    """A kind of object.

    Attributes:
        name: "knife", ...
        is_a: the class above it, itself an object or one of the file's classes; None for a root.
        properties: what can be perceived of it as a whole.
        graspable: whether it can be taken up; False for fixtures.
        parts: by name, in the order of the file.
        rests: how it can lie or stand; at least one is usual.
        mount: how it stands in another object unless it is laid loose; None for most.

    >>> knife = load_objects()["knife"]
    >>> list(knife.parts), knife.part("blade").role
    (['handle', 'blade'], 'edge')
    """

    name: str
    is_a: str | None
    properties: frozenset[str]
    graspable: bool
    parts: Mapping[str, PartType] = field(hash=False)
    rests: tuple[Rest, ...]
    mount: Mount | None = None

    @cached_property
    def mass(self) -> float:
        """The mass of all its parts together [kg]."""
        return sum(part.mass for part in self.parts.values())

    def part(self, name: str) -> PartType:
        """Return one of its parts.

        Raises:
            UnknownNameError: it has no such part.
        """
        if name not in self.parts:
            raise UnknownNameError(f"part of {self.name}", name, self.parts)
        return self.parts[name]

    def rest(self, name: str) -> Rest:
        """Return one of its ways to lie or stand.

        Raises:
            UnknownNameError: it has no such rest.
        """
        known = {rest.name: rest for rest in self.rests}
        if name not in known:
            raise UnknownNameError(f"rest of {self.name}", name, known)
        return known[name]


@dataclass(frozen=True)
class Household:
    """The contents of a file of objects.

    Attributes:
        objects: by name.
        classes: class -> the class above it, or None.
        roles: role of a part -> what it means.
        properties: property -> what it means.
        materials: by name.
    """

    objects: Mapping[str, ObjectType]
    classes: Mapping[str, str | None]
    roles: Mapping[str, str]
    properties: Mapping[str, str]
    materials: Mapping[str, Material]


def load_objects(path: Path | None = None) -> dict[str, ObjectType]:
    """Return the object types of a file; Hilt's own when `path` is None.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    return dict(load_household(path).objects)


def load_household(path: Path | None = None, *, added_to: Household | None = None) -> Household:
    """Return the contents of a file of objects: types, classes, roles and properties.

    Args:
        path: the file; Hilt's own when None.
        added_to: the file may use its words, and need only define further objects; the result
            contains both.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    return read_household(read_yaml(path or OBJECTS_FILE), added_to=added_to)


def read_household(spec: Field, *, added_to: Household | None = None) -> Household:
    """Return the same as `load_household`, from a part of a file."""
    words = {"classes", "roles", "properties", "materials"}
    known = added_to or Household({}, {}, {}, {}, {})
    top = spec.entries(required={"objects"} if added_to else {"objects", *words}, optional=words)
    given = {word: top[word].entries() if word in top else {} for word in words}
    reader = _Reader(
        objects=known.objects,
        classes={**known.classes, **_read_classes(given["classes"], known.classes)},
        roles={**known.roles, **_read_glossary(given["roles"])},
        properties={**known.properties, **_read_glossary(given["properties"])},
        materials={
            **known.materials,
            **{name: _read_material(name, spec) for name, spec in given["materials"].items()},
        },
    )
    fields = top["objects"].entries()
    objects = {name: reader.object(name, spec, fields) for name, spec in fields.items()}
    objects = {**known.objects, **objects}
    above = reader.classes | {name: kind.is_a for name, kind in objects.items()}
    _check_acyclic(above, {**given["classes"], **fields})
    return Household(objects, reader.classes, reader.roles, reader.properties, reader.materials)


@dataclass(frozen=True)
class _Reader:
    """Reads objects against the words that are declared."""

    objects: Mapping[str, ObjectType]
    classes: dict[str, str | None]
    roles: Mapping[str, str]
    properties: Mapping[str, str]
    materials: Mapping[str, Material]

    def object(self, name: str, spec: Field, fields: Mapping[str, Field]) -> ObjectType:
        if name in self.objects:
            raise spec.fail(f'there already is an object "{name}".')
        _check_name(name, spec)
        keys = spec.entries(
            required={"is_a", "parts", "rests"}, optional={"properties", "graspable", "mount"}
        )
        others = {*self.objects, *fields} - {name}
        parts = keys["parts"].entries()
        if not parts:
            raise keys["parts"].fail("expected at least one part.")
        return ObjectType(
            name,
            keys["is_a"].text(choices={*self.classes, *others}),
            self._words(keys),
            keys["graspable"].truth() if "graspable" in keys else True,
            {part: self._part(part, field) for part, field in parts.items()},
            _read_rests(keys["rests"]),
            _read_mount(keys["mount"], others) if "mount" in keys else None,
        )

    def _part(self, name: str, spec: Field) -> PartType:
        _check_name(name, spec)
        keys = spec.entries(
            required={"role", "material", "colour", "mass", "shape"}, optional={"properties"}
        )
        shape = tuple(read_solid(item) for item in keys["shape"].items())
        if not any(solid.collides for solid in shape):
            raise keys["shape"].fail(
                "expected at least one solid that can be touched (not `only: seen`)."
            )
        return PartType(
            name,
            keys["role"].text(choices=self.roles),
            self._words(keys),
            self.materials[keys["material"].text(choices=self.materials)],
            read_colour(keys["colour"]),
            keys["mass"].number(low=1e-4, high=MAX_MASS),
            shape,
        )

    def _words(self, keys: Mapping[str, Field]) -> frozenset[str]:
        if "properties" not in keys:
            return frozenset()
        return frozenset(keys["properties"].texts(choices=self.properties))


def _check_name(name: str, spec: Field) -> None:
    if not _WORDS.fullmatch(name) or name != name.lower():
        raise spec.fail(f'"{name}" is no name; expected lower-case words with single spaces.')


def _read_glossary(fields: Mapping[str, Field]) -> dict[str, str]:
    return {word: meaning.text() for word, meaning in fields.items()}


def _read_classes(fields: Mapping[str, Field], known: Iterable[str]) -> dict[str, str | None]:
    words = {*fields, *known}
    return {
        name: None if above.value is None else above.text(choices=words - {name})
        for name, above in fields.items()
    }


def _read_material(name: str, spec: Field) -> Material:
    keys = spec.entries(required={"friction", "shine"}, optional=())
    return Material(
        name, keys["friction"].number(low=0, high=2), keys["shine"].number(low=0, high=1)
    )


def _read_rests(spec: Field) -> tuple[Rest, ...]:
    rests = tuple(_read_rest(name, item) for name, item in spec.entries().items())
    if not any(rest.usual for rest in rests):
        raise spec.fail("expected at least one rest that is usual.")
    return rests


def _read_rest(name: str, spec: Field) -> Rest:
    keys = spec.entries(required={"turn_deg"}, optional={"usual"})
    usual = keys["usual"].truth() if "usual" in keys else True
    return Rest(name, read_turn(keys["turn_deg"]), usual)


def _read_mount(spec: Field, supports: set[str]) -> Mount:
    keys = spec.entries(required={"support", "at", "depth", "deepest", "resistance_N"}, optional=())
    x, y, z = keys["at"].numbers(count=3, low=-MAX_LENGTH, high=MAX_LENGTH)
    deepest = keys["deepest"].number(low=0, high=MAX_LENGTH)
    return Mount(
        keys["support"].text(choices=supports),
        (x, y, z),
        keys["depth"].number(low=0, high=deepest),
        deepest,
        keys["resistance_N"].number(low=0, high=MAX_FORCE),
    )


def _check_acyclic(above: Mapping[str, str | None], fields: Mapping[str, Field]) -> None:
    for name, spec in fields.items():
        seen, word = {name}, above[name]
        while word is not None:
            if word in seen:
                raise spec.fail(f'"{name}" is a kind of itself, through "{word}".')
            seen.add(word)
            word = above[word]
