"""Geometric forms that the parts of objects are made of, read from `objects.yaml`.

A part is a list of solids. A solid is one form (box, cylinder, lathe, extrusion, sweep or mesh
file) placed in the frame of the object; the head of `objects.yaml` describes their fields. This
module contains only numbers, from which `hilt.sim.models.solids` makes surfaces. Lengths are in
[m], angles in [rad]; in the file, degrees.
"""

import re
from dataclasses import dataclass
from itertools import pairwise
from math import radians
from pathlib import Path

from .yaml_reader import YamlNode

Point2 = tuple[float, float]
Point3 = tuple[float, float, float]
Colour = tuple[float, float, float]  # red, green, blue in [0, 1]

MAX_LENGTH = 5.0  # [m]; a table is the largest thing that stands in a scene


@dataclass(frozen=True)
class Box:
    """A box centred at the origin of its frame, with edges cut back by `bevel` [m]."""

    size: Point3
    bevel: float


@dataclass(frozen=True)
class Lathe:
    """The solid of revolution of a profile (radius, height) about the z axis."""

    profile: tuple[Point2, ...]
    wall: float
    sides: int
    stretch: Point2
    smooth: bool


@dataclass(frozen=True)
class Extrusion:
    """A plate: an outline in the xy plane, with a thickness along z at each corner."""

    outline: tuple[Point2, ...]
    thickness: tuple[float, ...]
    bevel: float
    smooth: bool


@dataclass(frozen=True)
class Sweep:
    """A section (width, height) swept along a path; its size may vary along the path."""

    path: tuple[Point3, ...]
    sections: tuple[Point2, ...]
    side: Point3
    power: float
    rounded: bool
    smooth: bool


@dataclass(frozen=True)
class MeshFile:
    """A surface in a file (OBJ, STL, PLY), which collides as convex pieces."""

    path: Path
    scale: float
    #: convex regions to keep: each is where n x > d [m] for all of its planes (n, d)
    regions: tuple[tuple[tuple[float, ...], ...], ...] = ((),)


Form = Box | Lathe | Extrusion | Sweep | MeshFile


@dataclass(frozen=True)
class PlacedSolid:
    """One form placed in the frame of the object."""

    form: Form
    at: Point3  #: origin of its frame [m]
    turn: Point3  #: roll, pitch, yaw of its frame [rad], about the fixed x, y, z axes in this order
    colour: Colour | None  #: its own colour; None for that of the part
    visible: bool  #: whether cameras see it
    collides: bool  #: whether it can be touched, by fingers or the table


def read_solid(field: YamlNode) -> PlacedSolid:
    """Return a solid, read from its form, place and look; `DataError` where a value is wrong."""
    keys = field.entries(optional={*_READERS, "at", "turn_deg", "colour", "only"})
    if len(forms := [key for key in keys if key in _READERS]) != 1:
        raise field.fail(f"expected exactly one of {', '.join(_READERS)}; found {len(forms)}.")
    only = keys["only"].text(choices={"seen", "felt"}) if "only" in keys else None
    return PlacedSolid(
        _READERS[forms[0]](keys[forms[0]]),
        read_point(keys["at"]) if "at" in keys else (0.0, 0.0, 0.0),
        read_turn(keys["turn_deg"]) if "turn_deg" in keys else (0.0, 0.0, 0.0),
        read_colour(keys["colour"]) if "colour" in keys else None,
        visible=only != "felt",
        collides=only != "seen",
    )


def read_turn(field: YamlNode) -> Point3:
    """Return roll, pitch and yaw [rad] from degrees."""
    roll, pitch, yaw = field.numbers(count=3, low=-360, high=360)
    return radians(roll), radians(pitch), radians(yaw)


def read_colour(field: YamlNode) -> Colour:
    """Return a colour from "#rrggbb"."""
    if not re.fullmatch("#[0-9a-fA-F]{6}", field.text()):
        raise field.fail(f'expected a colour as "#rrggbb", found "{field.value}".')
    red, green, blue = (channel / 255 for channel in bytes.fromhex(field.value[1:]))
    return red, green, blue


def _read_box(field: YamlNode) -> Box:
    keys = field.entries(required={"size"}, optional={"bevel"})
    size = keys["size"].numbers(count=3, low=1e-4, high=MAX_LENGTH)
    bevel = _length(keys, "bevel")
    if 2 * bevel >= min(size):
        raise keys["bevel"].fail(f"the bevel must be less than half of {min(size):g} m.")
    return Box((size[0], size[1], size[2]), bevel)


def _read_cylinder(field: YamlNode) -> Lathe:
    keys = field.entries(required={"radius", "length"}, optional={"bevel"})
    radius, length = (keys[k].number(low=1e-4, high=MAX_LENGTH) for k in ("radius", "length"))
    bevel, half = _length(keys, "bevel"), length / 2
    if bevel >= min(radius, half):
        raise keys["bevel"].fail(f"the bevel must be less than {min(radius, half):g} m.")
    lower = [(radius - bevel, -half), (radius, -half + bevel)] if bevel else [(radius, -half)]
    return Lathe((*lower, *[(r, -z) for r, z in reversed(lower)]), 0.0, 0, (1.0, 1.0), smooth=False)


def _read_lathe(field: YamlNode) -> Lathe:
    keys = field.entries(required={"profile"}, optional={"wall", "sides", "stretch", "smooth"})
    profile = _points2(keys["profile"], least=2)
    for (radius, _), item in zip(profile, keys["profile"].items(), strict=True):
        if radius < 0:
            raise item.fail(f"expected a radius of 0 or more, found {radius:g}.")
    if any(high <= low for (_, low), (_, high) in pairwise(profile)):
        raise keys["profile"].fail("expected heights that grow from point to point.")
    x, y = keys["stretch"].numbers(count=2, low=0.01, high=100) if "stretch" in keys else (1.0, 1.0)
    return Lathe(
        profile,
        _length(keys, "wall"),
        keys["sides"].integer(low=3, high=64) if "sides" in keys else 0,
        (x, y),
        _flag(keys, "smooth"),
    )


def _read_extrusion(field: YamlNode) -> Extrusion:
    keys = field.entries(required={"outline", "thickness"}, optional={"bevel", "smooth"})
    outline = _points2(keys["outline"], least=3)
    edges = pairwise((*outline, outline[0]))
    if sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in edges) <= 0:  # twice the area
        raise keys["outline"].fail("expected the corners in counter-clockwise order.")
    thick, count = keys["thickness"], len(outline)
    if isinstance(thick.value, tuple):
        thickness = thick.numbers(count=count, low=1e-4, high=MAX_LENGTH)
    else:
        thickness = (thick.number(low=1e-4, high=MAX_LENGTH),) * count
    return Extrusion(outline, thickness, _length(keys, "bevel"), _flag(keys, "smooth"))


def _read_sweep(field: YamlNode) -> Sweep:
    keys = field.entries(
        required={"path", "sections"}, optional={"side", "power", "rounded", "smooth"}
    )
    path = tuple(read_point(item) for item in keys["path"].items())
    sections = _points2(keys["sections"], least=1, low=1e-4)
    if len(path) < 2:
        raise keys["path"].fail(f"expected at least 2 points, found {len(path)}.")
    if len(sections) not in {1, len(path)}:
        expected = f"expected 1 section or one for each of {len(path)} points"
        raise keys["sections"].fail(f"{expected}, found {len(sections)}.")
    return Sweep(
        path,
        sections if len(sections) > 1 else sections * len(path),
        read_point(keys["side"]) if "side" in keys else (0.0, 1.0, 0.0),
        keys["power"].number(low=1, high=20) if "power" in keys else 2.0,
        _flag(keys, "rounded"),
        _flag(keys, "smooth"),
    )


def _read_mesh(field: YamlNode) -> MeshFile:
    keys = field.entries(required={"file"}, optional={"scale", "cut", "points", "other_points"})
    if not (path := Path(field.source).parent / keys["file"].text()).is_file():
        raise keys["file"].fail(f'there is no file "{path}".')
    scale = keys["scale"].number(low=1e-6, high=1e6) if "scale" in keys else 1.0
    planes = keys["cut"].items() if "cut" in keys else ()
    cuts = tuple(plane.numbers(count=4, low=-MAX_LENGTH, high=MAX_LENGTH) for plane in planes)
    for plane, (*normal, _) in zip(planes, cuts, strict=True):
        if not any(normal):
            raise plane.fail("expected a normal that is not 0.")
    own, others = (
        [read_point(item) for item in keys[key].items()] if key in keys else []
        for key in ("points", "other_points")
    )
    cells = [[_between(q, p) for q in (*own, *others) if q != p] for p in own] or [[]]
    return MeshFile(path, scale, tuple((*cuts, *cell) for cell in cells))


def _between(start: Point3, end: Point3) -> tuple[float, ...]:
    """The plane (n, d) with n x > d where x is nearer to the end than to the start."""
    normal = tuple(b - a for a, b in zip(start, end, strict=True))
    return *normal, sum(b * b - a * a for a, b in zip(start, end, strict=True)) / 2


_READERS = {
    "box": _read_box,
    "cylinder": _read_cylinder,
    "lathe": _read_lathe,
    "extrusion": _read_extrusion,
    "sweep": _read_sweep,
    "mesh": _read_mesh,
}


def _length(keys: dict[str, YamlNode], key: str) -> float:
    return keys[key].number(low=0, high=MAX_LENGTH) if key in keys else 0.0


def _flag(keys: dict[str, YamlNode], key: str) -> bool:
    return keys[key].truth() if key in keys else False


def read_point(field: YamlNode) -> Point3:
    """Return a point (x, y, z) [m]."""
    x, y, z = field.numbers(count=3, low=-MAX_LENGTH, high=MAX_LENGTH)
    return x, y, z


def _points2(field: YamlNode, *, least: int, low: float = -MAX_LENGTH) -> tuple[Point2, ...]:
    items = field.items()
    if len(items) < least:
        raise field.fail(f"expected at least {least} points, found {len(items)}.")
    pairs = (item.numbers(count=2, low=low, high=MAX_LENGTH) for item in items)
    return tuple((first, second) for first, second in pairs)
