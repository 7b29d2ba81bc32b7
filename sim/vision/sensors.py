# SPDX-License-Identifier: Apache-2.0
"""The sources of percepts there are, behind one protocol: `--vision mask|learned`.

`mask` takes the simulator's word for which pixel shows what, as a perfect detector would give it;
`learned` has only the pictures. Both look through the same cameras, with the same noise of depth,
and give percepts under the names by which the world knows its things.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

import numpy as np

from ...ontology.errors import UnknownNameError
from ..poses import Array
from ..scene.world import FLOOR, TABLE, World
from .camera import CameraImage
from .detector import Vision
from .noise import Noise
from .percept import Percept

SOURCES = ("mask", "learned")
SAME_PLACE = 0.04  # [m], between the middle of what is seen and that of a thing


class Eyes(Protocol):
    """What a body needs to see; `Vision` and `LearnedVision` are such eyes."""

    def look(self) -> tuple[CameraImage, ...]:
        """What all cameras see now."""
        ...

    def search(
        self, features: Sequence[str], *, views: Sequence[CameraImage] | None = None
    ) -> tuple[Percept, ...]:
        """The things in sight that have one of the features, the surest first."""
        ...

    def obstacles(
        self, besides: str | None, *, views: Sequence[CameraImage] | None = None
    ) -> Array:
        """Points on all other things in sight (n, 3), in the world [m]."""
        ...


def open_eyes(world: World, *, source: str = "mask", noise: Noise | None = None) -> Eyes:
    """The eyes round the table of a world.

    Args:
        world: what they look at.
        source: "mask", "learned", or "learned:FILE" with networks of one's own.
        noise: of which they have the depth noise; for the rest see `NoisyVision`.

    Raises:
        UnknownNameError: there is no such source.
        DataError: the file of networks cannot be read.
    """
    refuse_unknown(source)
    noise = noise or Noise()
    if source == "mask":
        room = (FLOOR, TABLE)  # below all that there is to see: they cannot hide anything
        return Vision(world.engine, world.kinds, world.models, noise=noise, room=room)
    from .learned_detector import (
        LearnedVision,
        Recogniser,
    )  # scipy and the networks only where they are used

    track = Tracker(world)
    networks = source.partition(":")[2]
    if not networks:
        return LearnedVision(world.engine, world.objects, noise=noise, track=track)
    learned = Recogniser.load(Path(networks))
    return LearnedVision(world.engine, world.objects, noise=noise, track=track, recogniser=learned)


def refuse_unknown(source: str) -> None:
    """Tell that there is no such source of percepts, before anything is made.

    Raises:
        UnknownNameError: there is none.
    """
    kind, _, networks = source.partition(":")
    if kind not in SOURCES or (networks and kind != "learned"):
        raise UnknownNameError("source of vision", source, (*SOURCES, "learned:FILE"))


@dataclass(frozen=True)
class Tracker:
    """Gives percepts the names by which the world knows its things, by where they are.

    A robot that has looked at a table keeps track of what stands where, whatever it takes it for;
    here the world does that for it.
    """

    world: World

    def __call__(self, percept: Percept) -> str:
        """The name of the nearest thing, one of the type that it is taken for if there is one."""
        world = self.world
        gaps = {
            name: float(np.linalg.norm((world.top(name) - percept.centre)[:2]))
            for name in world.kinds
        }
        alike = [name for name, kind in world.kinds.items() if kind.name == percept.object]
        near = [name for name in alike if gaps[name] < SAME_PLACE]
        return min(near or gaps, key=lambda name: gaps[name], default=percept.object)
