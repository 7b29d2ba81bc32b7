# SPDX-License-Identifier: Apache-2.0
"""Vision: percepts from camera images, for exactly the features asked for.

Cameras deliver colours, depths and a mask that says which part each pixel shows (a perfect
detector). An object is searched for only when one of the features names its type, one of its parts
or one of its properties: attention goes from the rules down to the eyes. How sure a percept is
follows from how much of the object is in sight, against what is to be expected of its kind.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ...ontology.objects import ObjectType
from ..models.object_models import ObjectModel
from ..physics.engine import PhysicsEngine
from ..poses import Array
from .camera import Camera, CameraImage, cameras_round_table
from .noise import Noise, with_depth_noise
from .percept import PartPercept, Percept, visible_features
from .region_of_interest import Attention
from .smoothing import smoothed

SURE = 0.95  # confidence in an object in full sight; even then it may be a good likeness
FULL_SIGHT = 0.75  # share of the expected silhouette that counts as all: views differ that much
LEAST_PIXELS = 40  # fewer are not taken for anything
CLOUD_SPACING = 0.0012  # [m], one point is kept of each cube of this size
OBSTACLE_SPACING = 0.004  # [m]
_HALF = 2**20  # more cubes than there are in any direction of a room


@dataclass(frozen=True)
class Vision:
    """The eyes round the table.

    Attributes:
        engine: where the world is.
        kinds: name of each object that may be in sight -> its type.
        models: type -> its model, for the silhouette to be expected.
        cameras: the eyes.
        noise: of which the cameras have the depth noise; the rest is `NoisyVision`'s.
        room: bodies that hide nothing. Where it is told, no more is drawn of an image than things
            and what may hide them (see `attention`).
    """

    engine: PhysicsEngine
    kinds: Mapping[str, ObjectType]
    models: Mapping[str, ObjectModel]
    cameras: tuple[Camera, ...] = field(default_factory=cameras_round_table)
    noise: Noise = field(default_factory=Noise)
    room: tuple[str, ...] = ()

    def look(self) -> tuple[CameraImage, ...]:
        """What all cameras see now."""
        if self.room:
            attention = Attention.on(self.kinds, self.engine, room=self.room)
            views = [attention.look(camera) for camera in self.cameras]
        else:
            views = [camera.look(self.engine) for camera in self.cameras]
        seen = with_noise(views, self.noise, self.engine.steps)
        return tuple(self._smooth(view) for view in seen) if self.noise.depth_m else seen

    def _smooth(self, view: CameraImage) -> CameraImage:
        """The same without most of the noise of its depths on things."""
        labels = [label for label, (name, _) in view.names.items() if name in self.kinds]
        return replace(
            view, depth=smoothed(view.depth, view.labels, labels, noise=self.noise.depth_m)
        )

    def search(
        self, features: Iterable[str], *, views: Sequence[CameraImage] | None = None
    ) -> tuple[Percept, ...]:
        """The objects in sight that have one of the features, the surest first.

        Args:
            features: "object:knife", "part:blade", "property:sharp", ...; others are not visible.
            views: what to search in; a new look when None.
        """
        wanted = frozenset(features)
        names = [name for name, kind in self.kinds.items() if wanted & visible_features(kind)]
        if not names:
            return ()
        seen = self.look() if views is None else views
        found = (
            perceive(seen, name, self.kinds[name], self.models[self.kinds[name].name].silhouette)
            for name in names
        )
        percepts = [percept for percept in found if percept is not None]
        return tuple(sorted(percepts, key=lambda percept: -percept.confidence))

    def obstacles(
        self, besides: str | None, *, views: Sequence[CameraImage] | None = None
    ) -> Array:
        """Points on all other objects in sight (n, 3), in the world [m].

        Args:
            besides: name of the object that is not in the way.
            views: what to search in; a new look when None.
        """
        others = [name for name in self.kinds if name != besides]
        seen = self.look() if views is None else views
        clouds = [view.points(view.mask(name)) for view in seen for name in others]
        return thinned(np.vstack([np.empty((0, 3)), *clouds]), OBSTACLE_SPACING)


def with_noise(views: Iterable[CameraImage], noise: Noise, moment: int) -> tuple[CameraImage, ...]:
    """Some views with the noise of the cameras' depths at the moment of a look."""
    return tuple(
        replace(view, depth=with_depth_noise(view.depth, noise, view.camera.name, moment))
        for view in views
    )


def perceive(
    views: Sequence[CameraImage], name: str, kind: ObjectType, silhouette: float
) -> Percept | None:
    """What some views show of one object; None when that is next to nothing.

    Args:
        views: of all cameras at one moment.
        name: of the object.
        kind: its type.
        silhouette: the area that it usually shows to a camera [m^2].
    """
    parts = [_perceive_part(views, name, part) for part in kind.parts]
    seen = {part.name: part for part in parts if part.pixels}
    if sum(part.pixels for part in parts) < LEAST_PIXELS:
        return None
    share = max(_shown_area(view, name) for view in views) / silhouette
    return Percept(name, kind.name, SURE * min(1.0, share / FULL_SIGHT), seen, kind.properties)


def _perceive_part(views: Sequence[CameraImage], name: str, part: str) -> PartPercept:
    clouds = [view.points(view.mask(name, part)) for view in views]
    cloud = np.vstack([np.empty((0, 3)), *clouds])
    return PartPercept(part, thinned(cloud, CLOUD_SPACING), len(cloud))


def _shown_area(view: CameraImage, name: str) -> float:
    """The area of an object's silhouette in a view, at the distance where it is [m^2]."""
    depths = view.depth[view.mask(name)].astype(np.float64)
    return float(((depths / view.camera.focal) ** 2).sum())


def thinned(cloud: Array, spacing: float) -> Array:
    """One point of a cloud (n, 3) in each cube of `spacing` [m], in a fixed order."""
    cubes = np.floor(cloud / spacing).astype(np.int64) + _HALF
    # One number a cube: sorting numbers is ten times faster than sorting rows.
    keys = (cubes[:, 0] * 2 * _HALF + cubes[:, 1]) * 2 * _HALF + cubes[:, 2]
    _, first = np.unique(keys, return_index=True)
    return cloud[np.sort(first)]
