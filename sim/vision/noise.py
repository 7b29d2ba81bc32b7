# SPDX-License-Identifier: Apache-2.0
"""Noise: how eyes fail, with a seed.

Section 4.1 of the paper measures without sensor noise and expects that whatever then goes wrong in
the world is due to it. `Noise` says how much of it there is; `NoisyVision` puts it between any
source of percepts and whoever searches. A thing is misperceived in the same way as long as the
scene stands, whoever looks for it first: the same seed gives the same run. Depth noise belongs to
the cameras and is new with every look.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Protocol
from zlib import crc32

import numpy as np
from numpy.typing import NDArray

from ...ontology.errors import DataError
from ...ontology.objects import ObjectType
from .percept import PartPercept, Percept, visible_features

MOST_DEPTH = 0.05  # [m], more is no camera any more


@dataclass(frozen=True)
class Noise:
    """How much eyes fail.

    Attributes:
        missed: how often a thing is not seen at all, in [0, 1].
        confused: how often a thing is taken for another type, in [0, 1].
        confidence: largest share of its confidence that a percept loses, in [0, 1].
        depth_m: standard deviation of each pixel's depth [m].
        seed: from which all of it is drawn.

    >>> Noise.parse("missed=0.1,confused=0.05", seed=7)
    Noise(missed=0.1, confused=0.05, confidence=0.0, depth_m=0.0, seed=7)
    """

    missed: float = 0.0
    confused: float = 0.0
    confidence: float = 0.0
    depth_m: float = 0.0
    seed: int = 0

    def __post_init__(self) -> None:
        for name, most in _MOST.items():
            value: float = getattr(self, name)
            if not 0 <= value <= most:
                raise DataError(
                    f"{name} must be in [0, {most:g}], found {value:g}.", source="noise"
                )

    @classmethod
    def parse(cls, text: str, *, seed: int = 0) -> Noise:
        """Read what `--noise` says: "missed=0.1,confused=0.05"; nothing is no noise.

        Raises:
            DataError: a word or a number in it is wrong.
        """
        values: dict[str, float] = {}
        for item in filter(None, (piece.strip() for piece in text.split(","))):
            name, _, number = item.partition("=")
            if name not in _MOST:
                raise DataError(
                    f'expected one of {", ".join(_MOST)}, found "{name}".', source="--noise"
                )
            try:
                values[name] = float(number)
            except ValueError:
                raise DataError(
                    f'expected a number after "{name}=", found "{number}".', source="--noise"
                ) from None
        return cls(**values, seed=seed)

    @property
    def is_none(self) -> bool:
        """Whether eyes see as if there were no noise."""
        return not any(getattr(self, name) for name in _MOST)

    def of(self, what: str, *numbers: int) -> np.random.Generator:
        """The source of randomness for one thing, independent of what else is looked at."""
        return np.random.default_rng([self.seed, crc32(what.encode()), *numbers])


_MOST = {
    each.name: MOST_DEPTH if each.name == "depth_m" else 1.0
    for each in fields(Noise)
    if each.name != "seed"
}


class PerceptSource(Protocol):
    """Anything that finds what has one of some features."""

    def search(self, features: Sequence[str]) -> Sequence[Percept]:
        """The things in view that have one of the features."""
        ...


@dataclass(frozen=True)
class NoisyVision:
    """Eyes that miss, confuse and doubt what better eyes see.

    What is confused appears as another type: it is found by the features of that type, and not by
    its own. So all that there is has to be looked at when things can be confused.

    Attributes:
        eyes: what sees without noise; its cameras may add their own to depths.
        noise: how much.
        objects: the types that there are, by name.
    """

    eyes: PerceptSource
    noise: Noise
    objects: Mapping[str, ObjectType]

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """The things that seem to have one of the features, the surest first."""
        looked_for = features
        if features and self.noise.confused:
            looked_for = [f"object:{name}" for name in self.objects]
        seen = (self._misperceived(percept) for percept in self.eyes.search(looked_for))
        wanted = frozenset(features)
        percepts = [
            percept
            for percept in seen
            if percept and wanted & visible_features(self.objects[percept.object])
        ]
        return tuple(sorted(percepts, key=lambda percept: -percept.confidence))

    def _misperceived(self, percept: Percept) -> Percept | None:
        """What a percept becomes; None when it is missed."""
        miss, confuse, doubt, which = self.noise.of(percept.name).random(4)
        if miss < self.noise.missed:
            return None
        others = [name for name, kind in self.objects.items() if kind.graspable]
        others = [name for name in others if name != percept.object]
        if confuse < self.noise.confused and others:
            percept = taken_for(percept, self.objects[others[int(which * len(others))]])
        return replace(percept, confidence=percept.confidence * (1 - doubt * self.noise.confidence))


def taken_for(percept: Percept, kind: ObjectType) -> Percept:
    """The same sight, taken for a thing of another type: its parts get the names of that one's."""
    parts = {
        name: PartPercept(name, part.cloud, part.pixels)
        for name, part in zip(kind.parts, percept.parts.values(), strict=False)
    }
    return replace(percept, object=kind.name, parts=parts, properties=kind.properties)


def with_depth_noise(
    depth: NDArray[np.float32], noise: Noise, camera: str, moment: int
) -> NDArray[np.float32]:
    """Depths (height, width) [m] as a camera with noise delivers them.

    Args:
        depth: without noise.
        noise: how much.
        camera: its name.
        moment: number of the look; each has noise of its own.
    """
    if not noise.depth_m:
        return depth
    errors = noise.of(camera, moment).normal(0.0, noise.depth_m, depth.shape)
    return (depth + errors).astype(np.float32)
