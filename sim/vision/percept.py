"""Percepts: detected objects with the point clouds of their parts.

They hold points and numbers, never a reference into the simulator.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import TYPE_CHECKING, cast

from ...ontology.objects import ObjectType

if TYPE_CHECKING:
    from ..poses import Array

UNMEASURED = cast("Array", ())  # no points of a visible part, without an import of numpy


@dataclass(frozen=True, eq=False)
class Percept:
    """One detected object."""

    name: str  #: name under which the object is tracked
    object: str  #: its detected type
    confidence: float  #: confidence in that type, in [0, 1]
    parts: "Mapping[str, Array]"  #: points on the visible ones (n, 3), in the world [m]; read-only
    #: properties of the object as a whole
    properties: frozenset[str] = field(default_factory=frozenset[str])

    def __post_init__(self) -> None:
        for cloud in filter(len, self.parts.values()):
            cloud.flags.writeable = False

    @cached_property
    def cloud(self) -> "Array":
        """The points of all its parts (n, 3), in the world [m]."""
        import numpy as np  # here: who decides without a simulator saves its import time

        return np.vstack(list(self.parts.values()))

    @cached_property
    def centre(self) -> "Array":
        """The centre of the bounding box of its points (3,), in the world [m]."""
        return (self.cloud.min(axis=0) + self.cloud.max(axis=0)) / 2

    def __repr__(self) -> str:
        return f"<Percept {self.name}, {self.object} {self.confidence:.2f}>"


def visible_features(kind: ObjectType) -> frozenset[str]:
    """The features by which objects of a type can be searched for."""
    properties = kind.properties.union(*(part.properties for part in kind.parts.values()))
    visible = (f"part:{name}" for name in kind.parts), (f"property:{word}" for word in properties)
    return frozenset([f"object:{kind.name}"]).union(*visible)
