# SPDX-License-Identifier: Apache-2.0
"""Geometric forms that the parts of objects are made of, read from `objects.yaml`.

A part is a list of placed solids. Each solid is one form (box, cylinder, lathe, extrusion, sweep
or mesh file), and where it stands in the object's frame. Only numbers are here;
`hilt.sim.models.solids` makes surfaces of them. Lengths are in [m]; angles in the file are in
degrees and become [rad].
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from math import radians
from pathlib import Path

from .yaml_reader import Field

Point2 = tuple[float, float]
Point3 = tuple[float, float, float]
Colour = tuple[float, float, float]  # red, green, blue in [0, 1]

MAX_LENGTH = 5.0  # [m]; a table is the largest thing that stands in a scene


@dataclass(frozen=True)
class Box:
    """A box round its frame's origin, with edges cut back by `bevel` [m]."""

    size: Point3
    bevel: float


@dataclass(frozen=True)
class Lathe:
    """What a profile sweeps when it turns round the z axis.

    Attributes:
        profile: (radius, height) of the outer side from bottom to top [m].
        wall: thickness of the wall of a vessel [m]; 0 for a solid body.
        sides: how many flat sides it has; 0 for a round one.
        stretch: factors of x and y, which make an oval of the circle.
        smooth: whether the profile is a curve through its points.
    """

    profile: tuple[Point2, ...]
    wall: float
    sides: int
    stretch: Point2
    smooth: bool


@dataclass(frozen=True)
class Extrusion:
    """A plate: an outline in the xy plane, with thickness along z.

    Attributes:
        outline: corners (x, y), counter-clockwise [m].
        thickness: at each corner, so that a blade may be thin at its edge [m].
        bevel: how far the rim is cut back on both faces [m].
        smooth: whether the outline is a curve through its corners.
    """

    outline: tuple[Point2, ...]
    thickness: tuple[float, ...]
    bevel: float
    smooth: bool


@dataclass(frozen=True)
class Sweep:
    """A section that moves along a path and may grow or shrink on its way.

    Attributes:
        path: points of the middle line [m].
        sections: (width, height) of the section at each point [m].
        side: the direction along which the width is measured, as nearly as the path allows.
        power: exponent of the superellipse |2x/w|^p + |2y/h|^p = 1: 2 is oval, 8 almost a box.
        rounded: whether both ends are domes.
        smooth: whether the path is a curve through its points.
    """

    path: tuple[Point3, ...]
    sections: tuple[Point2, ...]
    side: Point3
    power: float
    rounded: bool
    smooth: bool


@dataclass(frozen=True)
class MeshFile:
    """A surface in a file (OBJ, STL, PLY); each connected piece collides as its convex hull."""

    path: Path
    scale: float


Form = Box | Lathe | Extrusion | Sweep | MeshFile


@dataclass(frozen=True)
class Solid:
    """One form at its place in the frame of the object.

    Attributes:
        form: what it is.
        at: origin of its frame [m].
        turn: roll, pitch, yaw of its frame [rad] (turned about x, then y, then z, all fixed).
        colour: its own colour; None for that of the part.
        visible: whether cameras see it.
        collides: whether fingers and table touch it.
    """

    form: Form
    at: Point3
    turn: Point3
    colour: Colour | None
    visible: bool
    collides: bool


def read_solid(field: Field) -> Solid:
    """Return one placed solid: a form, and optionally at, turn_deg, colour and only.

    Raises:
        DataError: something is missing, unknown or out of range.
    """
    keys = field.entries(optional={*_READERS, "at", "turn_deg", "colour", "only"})
    forms = [key for key in keys if key in _READERS]
    if len(forms) != 1:
        raise field.fail(f"expected exactly one of {', '.join(_READERS)}; found {len(forms)}.")
    only = keys["only"].text(choices={"seen", "felt"}) if "only" in keys else None
    return Solid(
        _READERS[forms[0]](keys[forms[0]]),
        _point3(keys["at"]) if "at" in keys else (0.0, 0.0, 0.0),
        read_turn(keys["turn_deg"]) if "turn_deg" in keys else (0.0, 0.0, 0.0),
        read_colour(keys["colour"]) if "colour" in keys else None,
        visible=only != "felt",
        collides=only != "seen",
    )


def read_turn(field: Field) -> Point3:
    """Return roll, pitch and yaw [rad] from degrees."""
    roll, pitch, yaw = field.numbers(count=3, low=-360, high=360)
    return radians(roll), radians(pitch), radians(yaw)


def read_colour(field: Field) -> Colour:
    """Return a colour from "#rrggbb"."""
    text = field.text()
    digits = text.removeprefix("#")
    if len(text) != 7 or len(digits) != 6 or any(d not in "0123456789abcdefABCDEF" for d in digits):
        raise field.fail(f'expected a colour as "#rrggbb", found "{text}".')
    red, green, blue = (int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4))
    return red, green, blue


def _read_box(field: Field) -> Box:
    keys = field.entries(required={"size"}, optional={"bevel"})
    size = keys["size"].numbers(count=3, low=1e-4, high=MAX_LENGTH)
    bevel = _length(keys, "bevel", 0.0)
    if 2 * bevel >= min(size):
        raise keys["bevel"].fail(f"the bevel must be less than half of {min(size):g} m.")
    return Box((size[0], size[1], size[2]), bevel)


def _read_cylinder(field: Field) -> Lathe:
    keys = field.entries(required={"radius", "length"}, optional={"bevel"})
    radius, length = (keys[k].number(low=1e-4, high=MAX_LENGTH) for k in ("radius", "length"))
    bevel, half = _length(keys, "bevel", 0.0), length / 2
    if bevel >= min(radius, half):
        raise keys["bevel"].fail(f"the bevel must be less than {min(radius, half):g} m.")
    rims = [(radius - bevel, -half), (radius, -half + bevel)]
    profile = (
        (*rims, *((r, -z) for r, z in reversed(rims)))
        if bevel
        else ((radius, -half), (radius, half))
    )
    return Lathe(profile, 0.0, 0, (1.0, 1.0), smooth=False)


def _read_lathe(field: Field) -> Lathe:
    keys = field.entries(required={"profile"}, optional={"wall", "sides", "stretch", "smooth"})
    profile = _points2(keys["profile"], least=2)
    for (radius, _), item in zip(profile, keys["profile"].items(), strict=True):
        if radius < 0:
            raise item.fail(f"expected a radius of 0 or more, found {radius:g}.")
    if any(high <= low for (_, low), (_, high) in pairwise(profile)):
        raise keys["profile"].fail("expected heights that grow from point to point.")
    stretch = keys["stretch"].numbers(count=2, low=0.01, high=100) if "stretch" in keys else (1, 1)
    return Lathe(
        profile,
        _length(keys, "wall", 0.0),
        keys["sides"].integer(low=3, high=64) if "sides" in keys else 0,
        (float(stretch[0]), float(stretch[1])),
        _flag(keys, "smooth"),
    )


def _read_extrusion(field: Field) -> Extrusion:
    keys = field.entries(required={"outline", "thickness"}, optional={"bevel", "smooth"})
    outline = _points2(keys["outline"], least=3)
    twice_area = sum(
        x0 * y1 - x1 * y0
        for (x0, y0), (x1, y1) in zip(outline, (*outline[1:], outline[0]), strict=True)
    )
    if twice_area <= 0:
        raise keys["outline"].fail("expected the corners in counter-clockwise order.")
    thick = keys["thickness"]
    each = isinstance(thick.value, tuple)
    thickness = (
        thick.numbers(count=len(outline), low=1e-4, high=MAX_LENGTH)
        if each
        else (thick.number(low=1e-4, high=MAX_LENGTH),) * len(outline)
    )
    return Extrusion(outline, thickness, _length(keys, "bevel", 0.0), _flag(keys, "smooth"))


def _read_sweep(field: Field) -> Sweep:
    keys = field.entries(
        required={"path", "sections"}, optional={"side", "power", "rounded", "smooth"}
    )
    path = tuple(_point3(item) for item in keys["path"].items())
    sections = _points2(keys["sections"], least=1, low=1e-4)
    if len(path) < 2:
        raise keys["path"].fail(f"expected at least 2 points, found {len(path)}.")
    if len(sections) not in {1, len(path)}:
        raise keys["sections"].fail(
            f"expected 1 section or one for each of {len(path)} points, found {len(sections)}."
        )
    return Sweep(
        path,
        sections if len(sections) > 1 else sections * len(path),
        _point3(keys["side"]) if "side" in keys else (0.0, 1.0, 0.0),
        keys["power"].number(low=1, high=20) if "power" in keys else 2.0,
        _flag(keys, "rounded"),
        _flag(keys, "smooth"),
    )


def _read_mesh(field: Field) -> MeshFile:
    keys = field.entries(required={"file"}, optional={"scale"})
    path = Path(field.source).parent / keys["file"].text()
    if not path.is_file():
        raise keys["file"].fail(f'there is no file "{path}".')
    return MeshFile(path, keys["scale"].number(low=1e-6, high=1e6) if "scale" in keys else 1.0)


_READERS = {
    "box": _read_box,
    "cylinder": _read_cylinder,
    "lathe": _read_lathe,
    "extrusion": _read_extrusion,
    "sweep": _read_sweep,
    "mesh": _read_mesh,
}


def _length(keys: dict[str, Field], key: str, default: float) -> float:
    return keys[key].number(low=0, high=MAX_LENGTH) if key in keys else default


def _flag(keys: dict[str, Field], key: str) -> bool:
    return keys[key].truth() if key in keys else False


def _point3(field: Field) -> Point3:
    x, y, z = field.numbers(count=3, low=-MAX_LENGTH, high=MAX_LENGTH)
    return x, y, z


def _points2(field: Field, *, least: int, low: float = -MAX_LENGTH) -> tuple[Point2, ...]:
    items = field.items()
    if len(items) < least:
        raise field.fail(f"expected at least {least} points, found {len(items)}.")
    pairs = (item.numbers(count=2, low=low, high=MAX_LENGTH) for item in items)
    return tuple((first, second) for first, second in pairs)
