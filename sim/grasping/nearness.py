# SPDX-License-Identifier: Apache-2.0
"""Which points are so near to which hands that they matter, told in the frames of those hands.

Of all pairs of a hand and a point most are far from each other; what is asked of the rest costs a
fraction of asking it of all.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from ..poses import Array
from ..robot.models import Gripper
from .point_clouds import Label, Surroundings


@dataclass(frozen=True)
class HandPointPairs:
    """Pairs of a hand and a point so near to it that it matters; p of them.

    Attributes:
        hands: how many hands there are.
        hand: (p,), which hand, in ascending order.
        x, y, z: (p,) of the point in the grip frame of that hand [m].
        label: (p,) of the point.
    """

    hands: int
    hand: np.ndarray
    x: Array
    y: Array
    z: Array
    label: np.ndarray

    @classmethod
    def to(
        cls, world_from_grip: Array, surroundings: Surroundings, *, aside: float, ahead: float
    ) -> HandPointPairs:
        """The pairs of all hands and points.

        Args:
            world_from_grip: the hands (c, 4, 4).
            surroundings: the points.
            aside: how far from the middle of a hand, along x, points matter [m].
            ahead: how far before it, along z [m]; all behind that matters.
        """
        # A tenth of a micrometre is enough here, and numbers of half the size take half the time.
        middle = surroundings.points.mean(axis=0)
        points = (surroundings.points - middle).astype(np.float32).T
        axes = np.swapaxes(world_from_grip[:, :3, :3], 1, 2)
        origin = axes @ (world_from_grip[:, :3, 3] - middle)[..., None]
        found = [
            _near(turned, start, points, aside, ahead)
            for turned, start in zip(
                axes.astype(np.float32), origin.astype(np.float32), strict=True
            )
        ]
        point = np.concatenate([np.zeros(0, dtype=int), *(index for index, _ in found)])
        nothing = np.zeros((3, 0), dtype=np.float32)
        x, y, z = np.concatenate([nothing, *(local for _, local in found)], axis=1)
        hand = np.repeat(np.arange(len(found)), [len(index) for index, _ in found])
        return cls(len(found), hand, x, y, z, surroundings.labels[point])

    def moved(self, shift: Array) -> HandPointPairs:
        """The same for hands that have moved sideways by `shift` (c,) [m]."""
        return replace(self, y=self.y - shift[self.hand])

    def any(self, which: np.ndarray) -> np.ndarray:
        """Which hands (c,) have one of some pairs (p,)."""
        result = np.zeros(self.hands, dtype=bool)
        result[self.hand[which]] = True
        return result

    def in_band(self, gripper: Gripper) -> np.ndarray:
        """Which points (p,) of the wanted part lie between the pads."""
        band = (np.abs(self.x) <= gripper.pad_width / 2) & (
            np.abs(self.z) <= gripper.pad_length / 2
        )
        return band & (self.label == Label.WANTED)


def _near(
    axes: NDArray[np.float32],
    origin: NDArray[np.float32],
    points: NDArray[np.float32],
    aside: float,
    ahead: float,
) -> tuple[np.ndarray, NDArray[np.float32]]:
    """Which points (3, n) matter to one hand, and where they are in its frame (3, p) [m]."""
    local = axes @ points
    local -= origin
    x, _, z = local
    index = np.flatnonzero((np.abs(x) <= aside) & (z <= ahead))
    return index, local[:, index]
