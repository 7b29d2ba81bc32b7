"""Poses of the gripper: a grasp as a value, and the orientations in which grasps are sought."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace

import numpy as np

from .. import poses
from ..poses import Array

DOWN = poses.rotation_about((1.0, 0.0, 0.0), np.pi)  # the gripper looks straight down
LEVEL_ROLLS = 24  # of the gripper that looks straight down
TILTS_DEG = ((25.0, 8, 6), (50.0, 8, 6), (75.0, 12, 6))  # tilt, headings, rolls


@dataclass(frozen=True)
class Grasp:
    """A pose of the gripper from which it closes on a part.

    Attributes:
        world_from_grip: pose (4, 4) of the grip frame when the fingers close.
        width: width of the part between the pads [m].
        opening: opening of the gripper before it closes [m].
        score: score of the grasp, at most 1; higher is better.
    """

    world_from_grip: Array
    width: float
    opening: float
    score: float

    def half_turned(self) -> Grasp:
        """The same grasp with the fingers exchanged."""
        half = poses.pose(poses.rotation_about((0, 0, 1), np.pi), np.zeros(3))
        return replace(self, world_from_grip=self.world_from_grip @ half)


def grasp_orientations(heading: float) -> Array:
    """The orientations `world_from_grip` (d, 3, 3) that are tried, turned by `heading` [rad]."""
    rolls = poses.rotation_about((0, 0, 1), heading + np.arange(LEVEL_ROLLS) * np.pi / LEVEL_ROLLS)
    tilted = hand_orientations(TILTS_DEG, heading=heading, turn=np.pi)
    return np.concatenate([rolls @ DOWN, tilted])


def hand_orientations(
    tilts_deg: Iterable[tuple[float, int, int]], *, heading: float = 0.0, turn: float = 2 * np.pi
) -> Array:
    """Orientations `world_from_grip` (d, 3, 3) of a hand that looks down, but for some tilts.

    With each tilt stands in how many directions it leans, the first at `heading` [rad], and in how
    many rolls within `turn` [rad].
    """
    result: list[Array] = []
    for tilt_deg, headings, rolls in tilts_deg:
        lean = poses.rotation_about((0, 1, 0), np.radians(tilt_deg))
        directions = heading + np.arange(headings) * 2 * np.pi / headings
        around = poses.rotation_about((0, 0, 1), directions)
        roll = poses.rotation_about((0, 0, 1), np.arange(rolls) * turn / rolls)
        result.append((around[:, None] @ lean @ DOWN @ roll[None]).reshape(-1, 3, 3))
    return np.concatenate(result)
