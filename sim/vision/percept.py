# SPDX-License-Identifier: Apache-2.0
"""Percepts: what has been seen of an object, part by part.

These values pass from vision to everybody else; they hold points and numbers, never a reference
into the simulator.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from ...ontology.errors import UnknownNameError
from ...ontology.objects import ObjectType
from .. import poses
from ..grasping.point_clouds import level_direction
from ..poses import Array


@dataclass(frozen=True, eq=False)
class PartPercept:
    """What has been seen of one part.

    Attributes:
        name: of the part.
        cloud: points on its surface (n, 3), in the world [m]; read-only.
        pixels: how many pixels of all cameras show it.
    """

    name: str
    cloud: Array
    pixels: int

    def __post_init__(self) -> None:
        self.cloud.flags.writeable = False

    def __repr__(self) -> str:
        return f"<PartPercept {self.name}, {len(self.cloud)} points>"


@dataclass(frozen=True, eq=False)
class Percept:
    """What has been seen of one object.

    Attributes:
        name: by which the object is tracked.
        object: the type it is taken for.
        confidence: how sure that is, in [0, 1].
        parts: the parts that have been seen, by name.
        properties: what is perceived of the object as a whole.
    """

    name: str
    object: str
    confidence: float
    parts: Mapping[str, PartPercept]
    properties: frozenset[str] = field(default_factory=frozenset[str])

    def part(self, name: str) -> PartPercept:
        """One of the parts that have been seen.

        Raises:
            UnknownNameError: it has no such part, or the part was out of sight.
        """
        if name not in self.parts:
            raise UnknownNameError(f"visible part of {self.name}", name, self.parts)
        return self.parts[name]

    @cached_property
    def cloud(self) -> Array:
        """The points of all its parts (n, 3), in the world [m]."""
        return np.vstack([part.cloud for part in self.parts.values()])

    @cached_property
    def centre(self) -> Array:
        """The middle of the box round its points (3,), in the world [m]."""
        return (self.cloud.min(axis=0) + self.cloud.max(axis=0)) / 2

    @cached_property
    def world_from_box(self) -> Array:
        """Where the upright box round its points is (4, 4): a first estimate of its pose.

        The origin is the middle of the box, x runs along the longest level extent, z up.
        """
        turn = poses.rotation_about((0.0, 0.0, 1.0), level_direction(self.cloud))
        along = self.cloud @ turn
        return poses.pose(turn, turn @ (along.min(axis=0) + along.max(axis=0)) / 2)

    @cached_property
    def size(self) -> Array:
        """Length, width and height of that box (3,) [m]."""
        return np.ptp(self.cloud @ self.world_from_box[:3, :3], axis=0)

    def __repr__(self) -> str:
        return f"<Percept {self.name}, {self.object} {self.confidence:.2f}>"


def visible_features(kind: ObjectType) -> frozenset[str]:
    """The features by which a type can be searched for."""
    parts = kind.parts.values()
    properties = kind.properties.union(*(part.properties for part in parts))
    return frozenset(
        {f"object:{kind.name}"}
        | {f"part:{part.name}" for part in parts}
        | {f"property:{word}" for word in properties}
    )
