"""Descriptions of scenes: which objects are on the table, and where, as far as it is given.

A scene is what `--scene` names: a YAML file, `objects:knife,mug`, `random:SEED` (with a number of
objects: `random:SEED:5`) or `all`. What it leaves open (position, turn, rest) is drawn later
from its seed, by `placement`. A file reads:

    seed: 7
    clutter: medium
    objects:
      - knife
      - {object: mug, name: my mug, at: [0.5, 0.1], yaw_deg: 30, rest: upright}
    unknown: mallet.yaml

All objects that the file of unknown ones defines stand on the table, too, each as a "thing".
Clutter adds other objects drawn from the seed; the more of them, the closer they stand.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import repeat
from math import radians
from pathlib import Path
from typing import TYPE_CHECKING

from ...ontology.errors import DataError, UnknownNameError
from ...ontology.objects import ObjectType, load_household
from ...ontology.yaml_reader import YamlNode, read_yaml

if TYPE_CHECKING:
    import numpy as np

ROOM = ("floor", "table")  # in every scene
RESERVED = (*ROOM, "robot")  # names that no object can have
MAX_OBJECTS = 40
MAX_SEED = 2**31 - 1
TABLE_REACH = 1.0  # [m], limit of x and y of a given position
GAP = 0.02  # [m], smallest distance between two objects
MAX_COUNT = 12  # objects of a random scene: there is no room for more


# How full a table is: the number of objects that are added to those that were named, and the
# smallest distance between two objects [m].
CLUTTER = {"low": (2, 0.06), "medium": (4, 0.035), "high": (7, GAP)}


@dataclass(frozen=True)
class Placement:
    """One object of a scene; the seed decides where its position, yaw or rest is None."""

    name: str  #: name of this object: "knife", "knife 2", ...
    object: str  #: name of its type
    at: tuple[float, float] | None = None  #: x and y of its frame on the table [m]
    yaw: float | None = None  #: rotation about the vertical [rad]
    rest: str | None = None  #: name of the orientation in which it lies or stands
    within: str | None = None  #: name of the object that it stands in, as a nail in its block


@dataclass(frozen=True)
class Scene:
    """A description of what is on the table."""

    placements: tuple[Placement, ...]  #: the objects, each with a name of its own
    seed: int  #: seed from which everything left open is drawn
    gap: float = GAP  #: smallest distance between two objects [m]
    unknown: str = ""  #: path of a file of objects on the table that the robot knows nothing of

    @property
    def types(self) -> tuple[str, ...]:
        """The types of its objects, each once, in order."""
        return tuple(dict.fromkeys(placement.object for placement in self.placements))


def parse_scene(spec: str, *, seed: int, objects: Mapping[str, ObjectType]) -> Scene:
    """Return the scene that `--scene` names; `UnknownNameError` or `DataError` if it is wrong."""
    if not 0 <= seed <= MAX_SEED:
        raise DataError(f"expected 0 to {MAX_SEED}, found {seed}.", source="--seed")
    kind, colon, rest = spec.partition(":")
    if spec == "all":
        return scene_with(graspable(objects), seed=seed, objects=objects)
    if kind == "objects" and colon:
        names = [name.strip().replace("_", " ") for name in rest.split(",")]
        return scene_with(names, seed=seed, objects=objects)
    if kind == "random" and colon:
        return _random_scene(rest, objects)
    return _read_scene(spec, seed, objects)


def graspable(objects: Mapping[str, ObjectType]) -> tuple[str, ...]:
    """Return the types that can be taken up, in the order of their file."""
    return tuple(name for name, kind in objects.items() if kind.graspable)


def scene_with(names: Sequence[str], *, seed: int, objects: Mapping[str, ObjectType]) -> Scene:
    """Return a scene of these types, each as often as named; `UnknownNameError` without one."""
    known = set(objects) - set(ROOM)
    for name in names:
        if name not in known:
            raise UnknownNameError("object", name, known)
    return Scene(_mounted([Placement(name, name) for name in names], objects), seed)


def _random_scene(text: str, objects: Mapping[str, ObjectType]) -> Scene:
    import numpy as np  # here: other scenes save its import time

    word, colon, number = text.partition(":")
    seed = _read_number(word, low=0, high=MAX_SEED, after="random:")
    rng = np.random.default_rng(seed)
    known = graspable(objects)
    count = int(rng.integers(1, len(known) + 1))
    if colon:
        count = _read_number(number, low=1, high=MAX_COUNT, after=f"random:{word}:")
    return scene_with(_drawn(known, count, rng), seed=seed, objects=objects)


def _read_number(text: str, *, low: int, high: int, after: str) -> int:
    if not (text.isascii() and text.isdecimal()) or not low <= int(text) <= high:
        problem = f'expected a whole number from {low} to {high} after "{after}", found "{text}".'
        raise DataError(problem, source="--scene")
    return int(text)


def _drawn(names: Sequence[str], count: int, rng: "np.random.Generator") -> list[str]:
    drawn: Counter[str] = Counter()
    while drawn.total() < count:
        share = min(count - drawn.total(), len(names))
        drawn.update([names[int(i)] for i in rng.choice(len(names), share, replace=False)])
    return [name for name in names for _ in range(drawn[name])]


def _read_scene(spec: str, seed: int, objects: Mapping[str, ObjectType]) -> Scene:
    if (path := Path(spec)).suffix not in {".yaml", ".yml"}:
        known = '"objects:knife,mug", "random:SEED" or "all"'
        raise DataError(f'expected a YAML file, {known}, found "{spec}".', source="--scene")
    keys = read_yaml(path).entries(required={"objects"}, optional={"seed", "clutter", "unknown"})
    if len(items := keys["objects"].items()) > MAX_OBJECTS:
        raise keys["objects"].fail(f"expected at most {MAX_OBJECTS} objects, found {len(items)}.")
    placements = [_read_placement(item, objects) for item in items]
    seen: set[str] = set(RESERVED)
    for placement, item in zip(placements, items, strict=True):
        if placement.name in seen and placement.name != placement.object:
            raise item.fail(f'the name "{placement.name}" is taken.')
        seen.add(placement.name)
    seed = keys["seed"].integer(low=0, high=MAX_SEED) if "seed" in keys else seed
    gap = GAP
    if "clutter" in keys:
        more, gap = CLUTTER[keys["clutter"].text(choices=CLUTTER)]
        placements += _clutter(placements, more, seed, objects)
    unknown = str((path.parent / keys["unknown"].text()).absolute()) if "unknown" in keys else ""
    strange = unknown_objects(unknown)
    placements += [Placement("thing", name) for name in strange]
    return Scene(_mounted(placements, {**objects, **strange}), seed, gap, unknown)


def unknown_objects(path: str) -> dict[str, ObjectType]:
    """Return the types of a file of objects that stand on the table as unknown; "" has none."""
    if not path:
        return {}
    known = load_household()
    objects = load_household(Path(path), added_to=known).objects
    return {name: kind for name, kind in objects.items() if name not in known.objects}


def _clutter(
    placements: Sequence[Placement], count: int, seed: int, objects: Mapping[str, ObjectType]
) -> list[Placement]:
    import numpy as np

    there = {placement.object for placement in placements}
    others = [name for name in graspable(objects) if name not in there]
    rng = np.random.default_rng([seed, count])
    names = _drawn(others, min(count, len(others)), rng)
    names += _drawn(graspable(objects), count - len(names), rng)
    return [Placement(name, name) for name in names]


def _read_placement(item: YamlNode, objects: Mapping[str, ObjectType]) -> Placement:
    known = set(objects) - set(ROOM)
    if isinstance(item.value, str):
        kind = item.text(choices=known)
        return Placement(kind, kind)
    keys = item.entries(required={"object"}, optional={"name", "at", "yaw_deg", "rest"})
    kind = keys["object"].text(choices=known)
    rests = {rest.name for rest in objects[kind].rests}
    at = keys["at"].numbers(count=2, low=-TABLE_REACH, high=TABLE_REACH) if "at" in keys else None
    return Placement(
        keys["name"].text() if "name" in keys else kind,
        kind,
        (at[0], at[1]) if at else None,
        radians(keys["yaw_deg"].number(low=-360, high=360)) if "yaw_deg" in keys else None,
        keys["rest"].text(choices=rests) if "rest" in keys else None,
    )


def numbered(names: Iterable[str], *, taken: Iterable[str] = ()) -> Iterator[str]:
    """Yield names with numbers where one comes again or is taken: knife, knife 2, ..."""
    times = Counter(taken)
    for name in names:
        times[name] += 1
        yield name if times[name] == 1 else f"{name} {times[name]}"


def _mounted(given: Sequence[Placement], kinds: Mapping[str, ObjectType]) -> tuple[Placement, ...]:
    """Return the placements with names of their own, and with what they stand in."""
    names = numbered((placement.name for placement in given), taken=RESERVED)
    result = [replace(each, name=name) for each, name in zip(given, names, strict=True)]
    for index, placement in enumerate(result.copy()):
        if (mount := kinds[placement.object].mount) is None or placement.rest is not None:
            continue
        taken = {each.within for each in result}
        free = (p for p in result if p.object == mount.support and p.name not in taken)
        if (support := next(free, None)) is None:
            taken = {each.name for each in result}
            name = next(n for n in numbered(repeat(mount.support)) if n not in taken)
            support = Placement(name, mount.support, placement.at, placement.yaw)
            result.append(support)
        elif placement.at is not None or placement.yaw is not None:
            problem = f'"{placement.name}" stands in "{support.name}". Give the position of that.'
            raise DataError(problem, source="--scene")
        result[index] = replace(placement, at=None, yaw=None, within=support.name)
    return tuple(result)
