"""Kinds of things that somebody has shown: known by their views, with parts found by their shape.

A segment is of the kind whose views it is nearest to, if it is near at all. Its parts are the two
pieces that differ in width: the long one, as a handle, and the wide one, as a head.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ...ontology.objects import Material, ObjectType, PartType, RestingPose
from .. import poses
from ..poses import Array
from .segmentation import CELL, outline, segment_frame, slice_index

LONG, WIDE, WHOLE = "long", "wide", "whole"  # what a piece is called before it has a name
SLICES = 32  # along the longest extent, of which each is of one part
LEAST = 3  # slices of a part
RATIO = 2.0  # of the widths of two parts, at least
DENSITY = 400.0  # [kg/m^3], of wood that fills half of the box round a part
MATERIAL = Material("unknown", friction=0.6, shine=0.3)
LYING = RestingPose("as shown", (0.0, 0.0, 0.0), usual=True)


@dataclass(frozen=True, eq=False)
class ShownKind:
    """What is known of a kind that was shown; written as JSON, it can be kept."""

    name: str
    views: tuple[Array, ...]  #: the descriptors (d,) of some segments
    masses: Mapping[str, float]  #: of each piece, by its shape, as its size lets expect [kg]
    #: what the pieces are called, by their shapes; others have no name yet
    names: Mapping[str, str] = field(default_factory=dict[str, str])

    @classmethod
    def from_json(cls, name: str, text: str) -> "ShownKind":
        """Return what `as_json` wrote of the kind of this name."""
        known = json.loads(text)
        views = tuple(np.array(view) for view in known["views"])
        return cls(name, views, known["masses"], known["names"])

    def as_json(self) -> str:
        """Compact JSON of all but the name."""
        views = [view.round(4).tolist() for view in self.views]
        known = {"views": views, "masses": self.masses, "names": self.names}
        return json.dumps(known, separators=(",", ":"))

    def parts(self, points: Array) -> dict[str, Array]:
        """The points of each part, by its name, or by its shape where it has none."""
        pieces = split_by_width(points) if WHOLE not in self.masses else {WHOLE: points}
        return {self.names.get(shape, shape): piece for shape, piece in pieces.items()}

    @cached_property
    def kind(self) -> ObjectType:
        """It as a type of objects; what of it cannot be seen is guessed."""
        grey, nothing = (0.5, 0.5, 0.5), frozenset[str]()
        named = ((self.names.get(shape, shape), mass) for shape, mass in self.masses.items())
        parts = {n: PartType(n, "base", nothing, MATERIAL, grey, mass, ()) for n, mass in named}
        return ObjectType(self.name, None, nothing, graspable=True, parts=parts, rests=(LYING,))


def estimated_masses(points: Array) -> dict[str, float]:
    """The masses [kg] of the pieces of a thing (n, 3), by the boxes round them."""
    pieces = split_by_width(poses.transform(poses.inverse(segment_frame(points)), points))
    volumes = {shape: float(np.ptp(each, axis=0).prod()) for shape, each in pieces.items()}
    return {shape: round(DENSITY * max(each, CELL**3), 4) for shape, each in volumes.items()}


def split_by_width(points: Array) -> dict[str, Array]:
    """The points (n, 3) of the long and of the wide piece of a thing, or of the whole.

    It is cut across its longest extent where the widths of both pieces vary least (Fisher 1958).
    """
    own = poses.transform(poses.inverse(segment_frame(points)), points)
    index, widths = slice_index(own, SLICES), outline(own, SLICES)[0]
    cut = min(
        range(LEAST, SLICES - LEAST + 1),
        key=lambda at: at * widths[:at].var() + (SLICES - at) * widths[at:].var(),
    )
    sides = (widths[:cut].mean(), points[index < cut]), (widths[cut:].mean(), points[index >= cut])
    (narrow, long), (broad, wide) = sorted(sides, key=lambda side: side[0])
    return {LONG: long, WIDE: wide} if broad > RATIO * narrow else {WHOLE: points}
