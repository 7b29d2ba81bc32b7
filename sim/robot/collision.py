"""Collision checks of an arm: spheres on its links against seen points, the table and itself.

The robot knows its surroundings only from its cameras, so paths are checked against points, not
against the simulator's bodies. The spheres are a little larger than the links.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ..poses import Array, squared_distances
from .kinematics import KinematicChain
from .models import Gripper

FINGER_SPHERES = 4  # along each finger
MAX_GAP = 0.04  # [m], larger gaps are reported as this
CHUNK = 50_000  # pairs of a sphere and a point: small products, in the cache, on one core
FINGER_RADIUS = 0.45  # as a share of the finger's width


@dataclass(frozen=True)
class CollisionSpheres:
    """Spheres fixed to the links of an arm."""

    link: np.ndarray  #: index of the link of each in the chain (s,)
    centre: Array  #: in the frame of that link (s, 3) [m]
    radius: Array  #: (s,) [m]
    is_of_link: np.ndarray  #: whether it stands for a link, not for a finger or a held object (s,)

    def placed(self, base_from_link: Array) -> Array:
        """Centres (n, s, 3) for links at `base_from_link` (n, links, 4, 4)."""
        placed = np.empty((len(base_from_link), *self.centre.shape))
        for link in np.unique(self.link):
            own, at = self.link == link, base_from_link[:, link, :3]
            placed[:, own] = self.centre[own] @ np.swapaxes(at[..., :3], 1, 2) + at[:, None, :, 3]
        return placed


def arm_spheres(chain: KinematicChain, spheres: Mapping[str, Array]) -> CollisionSpheres:
    """Spheres (n, 4) by link, as in `RobotType.spheres`, on their links."""
    link = [chain.links.index(name) for name, each in spheres.items() for _ in each]
    stacked = np.concatenate([np.zeros((0, 4)), *spheres.values()])
    is_of_link = np.ones(len(link), dtype=bool)
    return CollisionSpheres(np.array(link, dtype=int), stacked[:, :3], stacked[:, 3], is_of_link)


def finger_spheres(chain: KinematicChain, gripper: Gripper, opening: float) -> CollisionSpheres:
    """The fingers of a gripper that is open by `opening` [m]."""
    radius = FINGER_RADIUS * gripper.finger_width
    heights = np.linspace(gripper.palm, gripper.tip - radius, FINGER_SPHERES) + gripper.grip
    aside = opening / 2 + gripper.finger_thickness / 2
    centre = [(0.0, side * aside, z) for side in (-1, 1) for z in heights]
    return hand_spheres(chain, np.array(centre), radius)


def hand_spheres(chain: KinematicChain, points: Array, radius: float) -> CollisionSpheres:
    """Equal spheres at points (n, 3) of the hand frame, such as those of a held object."""
    link = np.full(len(points), len(chain.links) - 1)
    return CollisionSpheres(link, points, np.full(len(points), radius), link < 0)


def clearances(
    chain: KinematicChain, spheres: CollisionSpheres, joints: Array, *, points: Array, table: float
) -> Array:
    """The smallest gaps (2,) [m] of spheres, over all postures `joints` (n, k) [rad].

    The first is that to obstacles: the points (p, 3) and the height `table` in the frame of the
    base [m]; gaps to points are at most `MAX_GAP`. The second is that between hand or held object
    and the arm; spheres on the link that carries the hand do not count, nor does how near the hand
    itself is to the link on which it turns.
    """
    centres = spheres.placed(chain.frames(joints))
    around = float(np.min(centres[..., 2] - spheres.radius)) - table
    if len(points):
        radius = np.tile(spheres.radius, len(joints))
        around = min(around, _gap_to_points(centres.reshape(-1, 3), radius, points))
    *_, before, last = (0, *np.flatnonzero(chain.moves))  # the joints before and at the hand
    ahead, behind = spheres.link > last, spheres.link < last
    between = np.sqrt(squared_distances(centres[:, ahead], centres[:, behind]))
    gaps = between - spheres.radius[ahead, None] - spheres.radius[behind]
    counts = ~spheres.is_of_link[ahead, None] | (spheres.link[behind] < before)
    return np.array([around, gaps.min(initial=np.inf, where=counts)])


def _gap_to_points(centres: Array, radius: Array, points: Array) -> float:
    """The smallest gap between spheres (n, 3), (n,) and points (p, 3), at most `MAX_GAP` [m]."""
    # There are few points, and few spheres near them: a k-d tree takes longer than all pairs.
    reach = radius[:, None] + MAX_GAP
    low, high = points.min(axis=0), points.max(axis=0)
    near = np.flatnonzero(((centres > low - reach) & (centres < high + reach)).all(axis=1))
    gap, count = MAX_GAP, max(1, CHUNK // len(points))
    for first in range(0, len(near), count):
        some = near[first : first + count]
        nearest = np.sqrt(squared_distances(centres[some], points).min(axis=1))
        gap = min(gap, float((nearest - radius[some]).min()))
    return gap
