"""The input of grasp planning: an object, the part to grasp it by, and the points round it."""

from dataclasses import dataclass, replace
from enum import IntEnum

import numpy as np

from ...ontology.objects import ObjectType
from ..poses import Array, voxel_downsample
from ..vision.percept import Percept

CHECK_CELL = 0.006  # [m], voxel size of the points that paths are checked against
MIN_GROWTH = 1.1  # of the voxels of a downsampled cloud, so that growing ends soon
FRAGILE_FORCE = 25.0  # [N], of each finger on what breaks easily
_EMPTY = np.zeros((0, 3))


class PointLabel(IntEnum):
    """What a point belongs to."""

    TARGET = 0
    OTHER_PART = 1
    NEIGHBOUR = 2


@dataclass(frozen=True)
class LabelledPointCloud:
    """The points that grasps of a part of an object are planned on."""

    points: Array  #: points (n, 3) in the world [m]
    labels: np.ndarray  #: `PointLabel` of each point (n,); the part to be grasped is `TARGET`
    table: float  #: height of the table [m]
    centre_of_mass: Array  #: estimated centre of mass of the object (3,), in the world [m]
    mass: float  #: mass of the object [kg]

    @property
    def target(self) -> Array:
        """The points of the part to be grasped (k, 3)."""
        return self.points[self.labels == PointLabel.TARGET]

    def downsampled(self, cell: float, *, reach: float, limit: int) -> "LabelledPointCloud":
        """At most `limit` points of each label within `reach` [m], in voxels of `cell` [m]."""
        low, high = self.target.min(axis=0) - reach, self.target.max(axis=0) + reach
        near = np.all((self.points >= low) & (self.points <= high), axis=1)
        kept: list[np.ndarray] = []
        for label in PointLabel:
            group, side = np.flatnonzero(near & (self.labels == label)), cell
            kept.append(group[voxel_downsample(self.points[group], side)])
            while len(kept[-1]) > limit:
                side *= max(MIN_GROWTH, float(np.sqrt(len(kept[-1]) / limit)))
                kept[-1] = group[voxel_downsample(self.points[group], side)]
        index = np.concatenate(kept)
        return replace(self, points=self.points[index], labels=self.labels[index])


@dataclass(frozen=True, eq=False)
class GraspContext:
    """An object that is to be grasped, and what surrounds it."""

    percept: Percept  #: the object as it is seen
    kind: ObjectType  #: type of the object, which gives the masses of its parts
    part: str | None  #: name of the part to grasp; None for any
    neighbours: Array  #: points (n, 3) on all other objects, in the world [m]

    @property
    def allowed_parts(self) -> tuple[str, ...]:
        """The parts that may be touched."""
        return tuple(self.kind.parts) if self.part is None else (self.part,)

    @property
    def force(self) -> float:
        """The force with which a finger may press on the allowed parts [N]."""
        parts = (self.kind.parts[name].properties for name in self.allowed_parts)
        return FRAGILE_FORCE if "fragile" in self.kind.properties.union(*parts) else np.inf

    @property
    def target(self) -> Array:
        """Points on the allowed parts (n, 3) [m]."""
        parts = self.percept.parts.items()
        return np.vstack([_EMPTY, *(each for name, each in parts if name in self.allowed_parts)])

    @property
    def other_parts(self) -> Array:
        """Points on the other parts of the object (n, 3) [m]."""
        parts, allowed = self.percept.parts.items(), self.allowed_parts
        return np.vstack([_EMPTY, *(each for name, each in parts if name not in allowed)])

    @property
    def scene(self) -> Array:
        """Points on all objects (n, 3), for path planning [m]."""
        points = np.vstack([self.percept.cloud, self.neighbours])
        return points[voxel_downsample(points, CHECK_CELL)]

    @property
    def obstacles(self) -> Array:
        """Points on all other objects (n, 3), for path planning [m]."""
        return self.neighbours[voxel_downsample(self.neighbours, CHECK_CELL)]

    @property
    def centre_of_mass(self) -> Array:
        """The centre of mass (3,) estimated from the visible parts and their masses [m]."""
        masses = {name: self.kind.parts[name].mass for name in self.percept.parts}
        moments = [masses[name] * cloud.mean(axis=0) for name, cloud in self.percept.parts.items()]
        return np.sum(moments, axis=0) / sum(masses.values())

    def labelled_cloud(self, table: float) -> LabelledPointCloud:
        """The points that grasps are planned on, over a table of this height [m]."""
        groups = [self.target, self.other_parts, self.neighbours]
        labels = np.repeat(np.array(list(PointLabel)), [len(group) for group in groups])
        mass = self.kind.mass
        return LabelledPointCloud(np.vstack(groups), labels, table, self.centre_of_mass, mass)
