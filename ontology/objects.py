"""The household domain: object types, their parts and materials.

`objects.yaml` contains the eight household objects of section 4.1 of the paper and the fixtures
they are used with (a table, a nail and its block). An object is a tree of two levels: the object
and its named parts, each made of solids of one material. What an object is for and where to grasp
it is not defined here: that is learned.
"""

import re
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import TypeAlias

from . import part_shapes
from .errors import UnknownNameError
from .part_shapes import MAX_LENGTH, Colour, PlacedSolid, Point3
from .yaml_reader import YamlNode, read_yaml

OBJECTS_FILE = Path(__file__).with_name("objects.yaml")
MAX_MASS = 500.0  # [kg]
MAX_FORCE = 10_000.0  # [N]
_WORDS = re.compile(r"[^\W_]+(?:[-' ][^\W_]+)*")


@dataclass(frozen=True)
class Material:
    """The material of a part."""

    name: str
    friction: float  #: coefficient of sliding; that of a contact is the product of both
    shine: float  #: brightness of its highlights, in [0, 1]


@dataclass(frozen=True)
class PartType:
    """One named part ("handle", "blade") of an object."""

    name: str
    role: str  #: its function in the object: "grip", "edge", "container", ...
    properties: frozenset[str]  #: its perceptible properties: "sharp", "long", ...
    material: Material
    colour: Colour  #: the colour of its solids that have none of their own
    mass: float  #: its mass [kg]
    shape: tuple[PlacedSolid, ...]  #: its solids, in the frame of the object


@dataclass(frozen=True)
class RestingPose:
    """A way in which an object can lie or stand on a table ("upright", "flat", "upside down")."""

    name: str
    turn: Point3  #: roll, pitch, yaw of its frame, before any turn about the vertical [rad]
    usual: bool  #: whether random scenes use it; the others are used only when requested


@dataclass(frozen=True)
class Fixture:
    """How an object is fixed in another one, as a nail in its block."""

    support: str  #: the type of the object in which it is fixed
    at: Point3  #: where it enters the support, in the frame of that [m]; its direction is its -z
    depth: float  #: its initial depth in the support [m]
    deepest: float  #: the depth to which it can be driven [m]
    resistance: float  #: the force with which the support holds it, in both directions [N]


@dataclass(frozen=True)
class ObjectType:
    """A kind of object.

    >>> knife = load_objects()["knife"]
    >>> list(knife.parts), knife.part("blade").role
    (['handle', 'blade'], 'edge')
    """

    name: str
    is_a: str | None  #: its superclass, an object or one of the file's classes; None for a root
    properties: frozenset[str]  #: the perceptible properties of the whole object
    graspable: bool  #: whether it can be picked up; False for fixtures
    parts: Mapping[str, PartType] = field(hash=False)  #: in the order of the file
    rests: tuple[RestingPose, ...]  #: how it can lie or stand; at least one is usual
    mount: Fixture | None = None  #: how it is fixed in another object; None if it is loose

    @cached_property
    def mass(self) -> float:
        """The total mass of its parts [kg]."""
        return sum(part.mass for part in self.parts.values())

    def part(self, name: str) -> PartType:
        """Return the part of a name; `UnknownNameError` if it has none."""
        if name not in self.parts:
            raise UnknownNameError(f"part of {self.name}", name, self.parts)
        return self.parts[name]

    def rest(self, name: str) -> RestingPose:
        """Return the rest (the way to lie or stand) of a name; `UnknownNameError` without it."""
        if name not in (known := {rest.name: rest for rest in self.rests}):
            raise UnknownNameError(f"rest of {self.name}", name, known)
        return known[name]


ObjectTypes: TypeAlias = "Mapping[str, ObjectType]"  # by name


@dataclass(frozen=True)
class Household:
    """The contents of a file of objects."""

    objects: Mapping[str, ObjectType]
    classes: Mapping[str, str | None]  #: class -> its superclass
    roles: Mapping[str, str]  #: role -> its meaning
    properties: Mapping[str, str]  #: property -> its meaning
    materials: Mapping[str, Material]
    people: Mapping[str, str]  #: kind of people -> the kind above it


def load_objects(path: Path | None = None) -> dict[str, ObjectType]:
    """Return the object types of a file by name; see `load_household`."""
    return dict(load_household(path).objects)


def load_household(path: Path | None = None, *, added_to: Household | None = None) -> Household:
    """Return the contents of a file of objects, by default that of Hilt, and of `added_to`.

    The file may use those words. A `DataError` has the position of a mistake and what was expected.
    """
    return read_household(read_yaml(path or OBJECTS_FILE), added_to=added_to)


def read_household(spec: YamlNode, *, added_to: Household | None = None) -> Household:
    """Return the household defined in a part of a file, as `load_household` does for a file."""
    words = {"classes", "roles", "properties", "materials"}
    known = added_to or Household({}, {}, {}, {}, {}, {})
    required = {"objects"} if added_to else {"objects", *words}
    top = spec.entries(required=required, optional=words | {"people"})
    given = {word: top[word].entries() if word in top else {} for word in (*words, "people")}
    materials = {name: _read_material(name, spec) for name, spec in given["materials"].items()}
    names = {*given["classes"], *known.classes}
    classes = {
        name: None if above.value is None else above.text(choices=names - {name})
        for name, above in given["classes"].items()
    }
    declared = Household(
        known.objects,
        {**known.classes, **classes},
        {**known.roles, **{word: meaning.text() for word, meaning in given["roles"].items()}},
        {**known.properties, **{word: each.text() for word, each in given["properties"].items()}},
        {**known.materials, **materials},
        {**known.people, **{name: above.text() for name, above in given["people"].items()}},
    )
    fields = top["objects"].entries()
    reader = _ObjectReader(declared, fields.keys())
    objects = {name: reader.object(name, spec) for name, spec in fields.items()}
    household = replace(declared, objects={**known.objects, **objects})
    above = {**household.classes, **{name: k.is_a for name, k in household.objects.items()}}
    _check_acyclic(above, {**given["classes"], **fields})
    people = household.people
    _check_acyclic({**dict.fromkeys(people.values()), **people}, given["people"])
    return household


@dataclass(frozen=True)
class _ObjectReader:
    declared: Household
    defined: Collection[str]

    def object(self, name: str, spec: YamlNode) -> ObjectType:
        if name in self.declared.objects:
            raise spec.fail(f'there already is an object "{name}".')
        _check_name(name, spec)
        keys = spec.entries(
            required={"is_a", "parts", "rests"}, optional={"properties", "graspable", "mount"}
        )
        others = {*self.declared.objects, *self.defined} - {name}
        if not (parts := keys["parts"].entries()):
            raise keys["parts"].fail("expected at least one part.")
        return ObjectType(
            name,
            keys["is_a"].text(choices={*self.declared.classes, *others}),
            self._words(keys),
            keys["graspable"].truth() if "graspable" in keys else True,
            {part: self._part(part, field) for part, field in parts.items()},
            _read_rests(keys["rests"]),
            _read_mount(keys["mount"], others) if "mount" in keys else None,
        )

    def _part(self, name: str, spec: YamlNode) -> PartType:
        _check_name(name, spec)
        keys = spec.entries(
            required={"role", "material", "colour", "mass", "shape"}, optional={"properties"}
        )
        shape = tuple(part_shapes.read_solid(item) for item in keys["shape"].items())
        if not any(solid.collides for solid in shape):
            problem = "expected at least one solid that can be touched (not `only: seen`)."
            raise keys["shape"].fail(problem)
        return PartType(
            name,
            keys["role"].text(choices=self.declared.roles),
            self._words(keys),
            self.declared.materials[keys["material"].text(choices=self.declared.materials)],
            part_shapes.read_colour(keys["colour"]),
            keys["mass"].number(low=1e-4, high=MAX_MASS),
            shape,
        )

    def _words(self, keys: Mapping[str, YamlNode]) -> frozenset[str]:
        if "properties" not in keys:
            return frozenset()
        return frozenset(keys["properties"].texts(choices=self.declared.properties))


def _check_name(name: str, spec: YamlNode) -> None:
    if not _WORDS.fullmatch(name) or name != name.lower():
        raise spec.fail(f'"{name}" is no name; expected lower-case words with single spaces.')


def _read_material(name: str, spec: YamlNode) -> Material:
    keys = spec.entries(required={"friction", "shine"}, optional=())
    friction = keys["friction"].number(low=0, high=2)
    return Material(name, friction, keys["shine"].number(low=0, high=1))


def _read_rests(spec: YamlNode) -> tuple[RestingPose, ...]:
    rests: list[RestingPose] = []
    for name, item in spec.entries().items():
        keys = item.entries(required={"turn_deg"}, optional={"usual"})
        usual = keys["usual"].truth() if "usual" in keys else True
        rests.append(RestingPose(name, part_shapes.read_turn(keys["turn_deg"]), usual))
    if not any(rest.usual for rest in rests):
        raise spec.fail("expected at least one rest that is usual.")
    return tuple(rests)


def _read_mount(spec: YamlNode, supports: set[str]) -> Fixture:
    keys = spec.entries(required={"support", "at", "depth", "deepest", "resistance_N"}, optional=())
    deepest = keys["deepest"].number(low=0, high=MAX_LENGTH)
    return Fixture(
        keys["support"].text(choices=supports),
        part_shapes.read_point(keys["at"]),
        keys["depth"].number(low=0, high=deepest),
        deepest,
        keys["resistance_N"].number(low=0, high=MAX_FORCE),
    )


def _check_acyclic(above: Mapping[str, str | None], fields: Mapping[str, YamlNode]) -> None:
    for name, spec in fields.items():
        seen, word = {name}, above[name]
        while word is not None:
            if word in seen:
                raise spec.fail(f'"{name}" is a kind of itself, through "{word}".')
            seen.add(word)
            word = above[word]
