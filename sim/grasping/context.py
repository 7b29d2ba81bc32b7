# SPDX-License-Identifier: Apache-2.0
"""One thing in its surroundings, as it was seen at one moment: what a grasp is planned on."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ...ontology.objects import ObjectType
from ..poses import Array
from ..vision.percept import Percept
from .point_clouds import Surroundings, surround, thin

CHECK_CELL = 0.006  # [m] between the points that paths are checked against
_NOTHING = np.zeros((0, 3))


@dataclass(frozen=True, eq=False)
class Sight:
    """A thing that is to be grasped, and what stands round it.

    Attributes:
        percept: the thing.
        kind: its type, for the masses of its parts.
        part: the part to grasp it by; None for any.
        neighbours: points on everything else (n, 3) [m].
    """

    percept: Percept
    kind: ObjectType
    part: str | None
    neighbours: Array

    @property
    def allowed(self) -> tuple[str, ...]:
        """The parts that may be touched."""
        return tuple(self.kind.parts) if self.part is None else (self.part,)

    @property
    def wanted(self) -> Array:
        """Points on what may be touched (n, 3) [m]."""
        return self._clouds(inside=True)

    @property
    def rest(self) -> Array:
        """Points on the thing's other parts (n, 3) [m]."""
        return self._clouds(inside=False)

    @property
    def everything(self) -> Array:
        """Points on all that was seen (n, 3), thinned [m]."""
        points = np.vstack([self.percept.cloud, self.neighbours])
        return points[thin(points, CHECK_CELL)]

    @property
    def others(self) -> Array:
        """Points on all but the thing itself (n, 3), thinned [m]."""
        return self.neighbours[thin(self.neighbours, CHECK_CELL)]

    @property
    def balance(self) -> Array:
        """Where the centre of mass is thought to be (3,): each seen part weighs what it does."""
        masses = {name: self.kind.parts[name].mass for name in self.percept.parts}
        moments = [
            masses[name] * part.cloud.mean(axis=0) for name, part in self.percept.parts.items()
        ]
        return np.sum(moments, axis=0) / sum(masses.values())

    def surroundings(self, table: float) -> Surroundings:
        """What a grasp reckons with, on a table of this height [m]."""
        return surround(
            self.wanted,
            [self.rest],
            [self.neighbours],
            table=table,
            balance=self.balance,
            mass=self.kind.mass,
        )

    def _clouds(self, *, inside: bool) -> Array:
        parts = self.percept.parts.items()
        clouds = [part.cloud for name, part in parts if (name in self.allowed) == inside]
        return np.vstack([_NOTHING, *clouds])
