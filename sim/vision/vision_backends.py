"""The vision sensors that `--vision mask|learned` chooses from, used alike.

`mask` uses the simulator's segmentation mask, as a perfect detector; `learned` uses only colours
and depths. Both use the same cameras with the same depth noise, and name objects as the world does.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TypeAlias

import numpy as np

from ...ontology.errors import UnknownNameError
from ..poses import Array
from ..scene.world import FLOOR, TABLE, World
from .camera import CameraImage
from .learned_detector import LearnedDetector, Recogniser
from .mask_detector import MaskDetector
from .percept import Percept
from .perception_noise import NoiseLevels

SOURCES = ("mask", "learned")
SAME_PLACE = 0.04  # [m], between the centre of a percept and that of an object


VisionSensor: TypeAlias = MaskDetector | LearnedDetector


class CachedVision:
    """A vision sensor that takes new images only after time has passed in the world it sees."""

    def __init__(self, world: World, sensor: VisionSensor) -> None:
        self._world, self._sensor = world, sensor
        self._images: tuple[CameraImage, ...] = ()
        self._step = -1

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """Return the visible objects that have one of the features, most confident first."""
        return self._sensor.search(features, images=self._current())

    def find(self, name: str) -> Percept | None:
        """The percept of an object of the world; None when it is not visible."""
        kind = self._world.kinds.get(name)
        found = self.search([f"object:{kind.name}"]) if kind else ()
        return next((percept for percept in found if percept.name == name), None)

    def obstacles(self, exclude: str) -> Array:
        """Return points (n, 3) on all visible objects but `exclude`, in the world [m]."""
        return self._sensor.obstacles(exclude, images=self._current())

    def _current(self) -> tuple[CameraImage, ...]:
        now = self._world.engine.steps
        if now != self._step:
            self._images, self._step = self._sensor.capture(), now
        return self._images


def open_vision(
    world: World, *, source: str = "mask", noise: NoiseLevels | None = None
) -> VisionSensor:
    """Open the vision sensor of a world.

    The source is "mask", "learned", or "learned:FILE" with classifiers of one's own. Only the depth
    noise is used here; see `NoisyDetector` for the rest.

    Raises:
        UnknownNameError: there is no such source.
        DataError: the file of classifiers cannot be read.
    """
    check_source(source)
    noise = noise or NoiseLevels()
    if source == "mask":
        room = (FLOOR, TABLE)  # below everything else: they cannot hide anything
        return MaskDetector(world.engine, world.kinds, world.models, noise=noise, room=room)
    file = source.partition(":")[2]
    recogniser = Recogniser.load(Path(file)) if file else Recogniser.default()
    return LearnedDetector(
        world.engine,
        world.objects,
        noise=noise,
        track=partial(nearest_object, world),
        recogniser=recogniser,
    )


def check_source(source: str) -> None:
    """Check the name of a source of percepts before anything is made.

    Raises:
        UnknownNameError: there is no such source.
    """
    kind, _, file = source.partition(":")
    if kind not in SOURCES or (file and kind != "learned"):
        raise UnknownNameError("source of vision", source, (*SOURCES, "learned:FILE"))


def nearest_object(world: World, percept: Percept) -> str:
    """Return the name of the nearest object of the world, preferably of the detected type.

    It stands in for the tracking by which a robot would keep the names of objects.
    """
    gaps = {name: np.linalg.norm((world.top(name) - percept.centre)[:2]) for name in world.kinds}
    alike = [name for name, kind in world.kinds.items() if kind.name == percept.object]
    near = [name for name in alike if gaps[name] < SAME_PLACE]
    return min(near or gaps, key=lambda name: gaps[name], default=percept.object)
