"""Object detection in the images of cameras, and the percepts that it gives.

A detector sees a world through cameras. What it sees is searched by features ("object:knife",
"part:blade", "property:sharp"; others are not visible).
"""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Sequence
from dataclasses import replace

import numpy as np

from ..poses import Array
from ..scene.world import World
from .camera import CAMERAS_ROUND_TABLE, CameraImage
from .percept import Percept, visible_features
from .perception_noise import NoiseLevels, with_depth_noise
from .point_cloud_operations import voxel_downsample

OBSTACLE_SPACING = 0.004  # [m], voxel size of the cloud of obstacles


class ObjectDetector(ABC):
    """Detects the objects of a world; new images are taken only after time has passed in it.

    Of the noise only that of depths is used here; see `NoisyDetector` for the rest.
    """

    def __init__(self, world: World, *, noise: NoiseLevels | None = None) -> None:
        self.world, self.noise = world, noise or NoiseLevels()
        self._seen: tuple[int, tuple[Percept, ...]] = (-1, ())  # with the time step

    @abstractmethod
    def detect(self, images: Sequence[CameraImage]) -> Iterable[Percept]:
        """Return the objects that images of one moment show."""

    def capture(self) -> tuple[CameraImage, ...]:
        """Take one image with each camera, with its depth noise."""
        noise, step = self.noise, self.world.engine.steps
        return tuple(
            replace(image, depth=with_depth_noise(image.depth, noise, image.camera.name, step))
            for image in self._render()
        )

    def _render(self) -> Iterable[CameraImage]:
        return (camera.capture(self.world.engine) for camera in CAMERAS_ROUND_TABLE)

    @property
    def percepts(self) -> tuple[Percept, ...]:
        """All objects in view, most confident first."""
        step, seen = self._seen
        if step != self.world.engine.steps:
            found = self.detect(self.capture())
            seen = tuple(sorted(found, key=lambda percept: -percept.confidence))
            self._seen = self.world.engine.steps, seen
        return seen

    def search(self, features: Iterable[str]) -> tuple[Percept, ...]:
        """Return the objects in view that have one of the features, most confident first."""
        wanted, objects = frozenset(features), self.world.objects
        kinds = {name for name, kind in objects.items() if wanted & visible_features(kind)}
        return tuple(percept for percept in self.percepts if percept.object in kinds)

    def find(self, name: str) -> Percept | None:
        """The percept of an object of the world; None when it is not visible as what it is."""
        kind = self.world.kinds.get(name)
        alike = self.search([f"object:{kind.name}"]) if kind else ()
        return next((percept for percept in alike if percept.name == name), None)

    def obstacles(self, exclude: str) -> Array:
        """Return points (n, 3) on all objects in view but `exclude`, in the world [m]."""
        clouds = [percept.cloud for percept in self.percepts if percept.name != exclude]
        cloud = np.vstack([np.empty((0, 3)), *clouds])
        return cloud[voxel_downsample(cloud, OBSTACLE_SPACING)]
