# SPDX-License-Identifier: Apache-2.0
"""Pounding: which face of a held thing strikes, how the hand must be turned for it, and the blow.

A thing strikes best with a wide, level face that is the lowest of all that the hand and the thing
fill, and that is near below the hand: a blow far from the fingers turns the thing in them. Faces
are sought in the cloud that was seen, by trying directions of the hand. What drives the nail is the
contact of that face, and the speed with which it comes.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from .. import poses
from ..grasping.point_clouds import thin
from ..poses import Array
from ..robot.collision import Spheres
from ..robot.kinematics import Chain

POINT_CELL = 0.003  # [m] between the points in which faces are sought
LEVEL = 0.003  # [m], what is so little above the lowest point belongs to the face
LEAST_FACE = 4e-5  # [m^2], about 6 x 6 mm; less would slide off a nail
BEST_FACE = 4e-4  # [m^2], a larger one is no better
LEVER_COST = 6.0  # [1/m], what a metre between face and hand takes from the score
TILT_COST = 0.15  # what a hand that does not look down takes from it
HAND_ROOM = 0.012  # [m] that the hand stays above the face
TILTS_DEG = (0.0, 30.0, 60.0, 80.0, 90.0)
HEADINGS, ROLLS = 12, 12
INWARDS = 0.4  # share of the way from the rim of a face to its middle, where it may strike
PREPARED = 60  # postures that are tried


@dataclass(frozen=True)
class StrikePose:
    """One way to strike with what is held.

    Attributes:
        rotation: `world_from_grip` (3, 3) at the blow.
        point: where the face meets the nail (3,), in the grip frame [m].
        score: the higher the better.
    """

    rotation: Array
    point: Array
    score: float

    def world_from_grip(self, target: Array) -> Array:
        """The grip (4, 4) with the face at a point (3,) of the world [m]."""
        return poses.pose(self.rotation, target - self.rotation @ self.point)


def strikes(thing: Array, hand: Array) -> list[StrikePose]:
    """Ways to strike with a thing, best first.

    Args:
        thing: points of what is held (n, 3), in the grip frame [m].
        hand: points of the hand (m, 3), in the grip frame [m].
    """
    cloud = thing[thin(thing, POINT_CELL)]
    found = (_strike(rotation, cloud, hand) for rotation in _rotations())
    good = [strike for strike in found if strike is not None]
    return sorted(good, key=lambda strike: -strike.score)[:PREPARED]


def hand_points(spheres: Spheres, chain: Chain, hand_from_grip: Array) -> Array:
    """What a hand fills, as points (m, 3) round its spheres, in the grip frame [m]."""
    own = spheres.link == len(chain.links) - 1
    centres = poses.transform(poses.inverse(hand_from_grip), spheres.centre[own])
    around = np.vstack([np.eye(3), -np.eye(3)])
    return (centres[:, None] + spheres.radius[own, None, None] * around).reshape(-1, 3)


def _rotations() -> Iterator[Array]:
    """Directions of the hand, from looking down to level."""
    down = poses.rotation_about((1, 0, 0), np.pi)
    for tilt in np.radians(TILTS_DEG):
        lean = poses.rotation_about((0, 1, 0), tilt)
        for heading in np.arange(HEADINGS if tilt else 1) * 2 * np.pi / HEADINGS:
            for roll in np.arange(ROLLS) * 2 * np.pi / ROLLS:
                around, turn = (poses.rotation_about((0, 0, 1), each) for each in (heading, roll))
                yield around @ lean @ down @ turn


def _strike(rotation: Array, thing: Array, hand: Array) -> StrikePose | None:
    at = thing @ rotation.T
    lowest = float(np.partition(at[:, 2], 2)[2])  # one stray point is no face
    if lowest > float((hand @ rotation.T)[:, 2].min()) - HAND_ROOM:
        return None
    face = at[at[:, 2] < lowest + LEVEL]
    area = _area(face[:, :2])
    if area < LEAST_FACE:
        return None
    middle = face.mean(axis=0)
    inner = middle + (1 - INWARDS) * (face - middle)
    reach = np.linalg.norm(inner[:, :2], axis=1)
    point = np.array([*inner[np.argmin(reach), :2], lowest])
    score = np.sqrt(min(area / BEST_FACE, 1.0)) - LEVER_COST * float(reach.min())
    return StrikePose(rotation, rotation.T @ point, score - TILT_COST * (1 + float(rotation[2, 2])))


def _area(points: Array) -> float:
    """The area of the convex outline of points (n, 2) [m^2]."""
    order = points[np.lexsort((points[:, 1], points[:, 0]))]
    if len(order) < 3:
        return 0.0
    outline = [*_chain(order), *_chain(order[::-1])]
    x, y = np.array(outline).T
    return abs(float(x @ np.roll(y, -1) - y @ np.roll(x, -1))) / 2


def _chain(points: Array) -> list[Array]:
    """One side of the outline, without its last point (Andrew 1979)."""
    chain: list[Array] = []
    for point in points:
        while len(chain) > 1 and _turn(chain[-2], chain[-1], point) <= 0:
            chain.pop()
        chain.append(point)
    return chain[:-1]


def _turn(a: Array, b: Array, c: Array) -> float:
    return float((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
