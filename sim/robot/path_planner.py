# SPDX-License-Identifier: Apache-2.0
"""Ways of the arm to where the hand should be: inverse kinematics, then a path that hits nothing.

`Reacher` plans for one robot at one moment. A way to a grasp has three parts: a transit through
free space to a point before the grasp, a straight approach, and a straight lift; a grasp whose
lift is out of reach is no use. Paths are checked against what was seen (`clearance`).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from .. import poses
from ..grasping.planner import Grasp
from ..grasping.point_clouds import spread
from ..grasping.sampling import hand_directions
from ..physics.engine import TIME_STEP
from ..poses import Array
from .collision import Spheres, clearance, self_clearance
from .kinematics import Solution
from .paths import passed, timed
from .robot import Robot

RETREAT = 0.09  # [m] before the grasp, where the straight approach begins
APPROACH_STEP = 0.0225  # [m] between the poses of a straight way; between them it bends by 0.5 mm
CHECK_STEP = 0.03  # [rad] between the postures that are checked: a hand moves 2 cm from one to it
FASTEST = 0.9  # share of the joints' speed limits; the faster, the more its corners are rounded off
TRANSIT_GAP = 0.008  # [m] to everything on the way through free space
APPROACH_GAP = -0.003  # [m] to the rest; the spheres are a little larger than the hand
AT_ONCE = 4  # grasps whose ways are sought together: the first ones mostly do
ROUNDING = 1e-4  # [m], so that standing near something does not forbid to leave it
PLACES = 8  # points of a part that are tried before it is called out of reach
EVERY_DIRECTION = 6  # so many of the directions of the hand are left out of that, but for one
VIA_HEIGHT = 0.30  # [m] above the table, high enough to pass over things


@dataclass(frozen=True)
class Reach:
    """A way to take hold of something.

    Attributes:
        grasp: what for; its pose may be turned by half a turn about the approach.
        transit: postures (n, k) from here to the point before the grasp [rad].
        approach: postures (m, k) from there to the grasp [rad].
        lift: postures (l, k) from the grasp upwards [rad].
    """

    grasp: Grasp
    transit: Array
    approach: Array
    lift: Array


@dataclass(frozen=True)
class Reacher:
    """Plans ways for a robot.

    Attributes:
        robot: where it is now is where ways begin.
        table: height of the table [m].
        seen: points (n, 3) of everything on the table [m].
        others: the same without the thing that is to be grasped.
    """

    robot: Robot
    table: float
    seen: Array
    others: Array

    def ways_to(self, grasps: Sequence[Grasp], *, lift: float) -> Iterator[Reach]:
        """Ways to grasps, in the order given; those out of reach are left out.

        Args:
            grasps: best first.
            lift: how high the thing must be lifted afterwards [m].
        """
        for first in range(0, len(grasps), AT_ONCE):
            yield from self._ways(grasps[first : first + AT_ONCE], lift)

    def _ways(self, grasps: Sequence[Grasp], lift: float) -> Iterator[Reach]:
        both = [turned for grasp in grasps for turned in (grasp, _half_turned(grasp))]
        at = np.stack([grasp.world_from_grip for grasp in both])
        approach = self._approaches(at)
        up = self._straight(at, poses.translation(0, 0, lift) @ at, approach.joints[:, -1])
        found = approach.found & up.found
        # Of a grasp and its half turn, the one that is nearer comes first.
        pairs = self.travel(approach.joints[:, 0]).reshape(-1, 2).argsort(axis=1)
        order = (2 * np.arange(len(grasps))[:, None] + pairs).ravel()
        for index in order[found[order]]:
            way = self._free_way(both[index], approach.joints[index], up.joints[index])
            if way is not None:
                yield way

    def _approaches(self, at: Array) -> Solution:
        """Straight ways to poses of the grip (m, 4, 4), the posture before the grasp included."""
        back = at @ poses.translation(0, 0, -RETREAT)
        before = self.postures(back)
        on = self._straight(back, at, before.joints)
        joints = np.concatenate([before.joints[:, None], on.joints], axis=1)
        found = before.found & on.found
        lost = np.flatnonzero(~found)
        if len(lost):
            # Near the joints' limits a way may be found from its end and not from its beginning.
            there = self.postures(at[lost])
            off = self._straight(at[lost], back[lost], there.joints)
            joints[lost] = np.concatenate([there.joints[:, None], off.joints], axis=1)[:, ::-1]
            found[lost] = there.found & off.found
        return Solution(joints, found)

    def _free_way(self, grasp: Grasp, approach: Array, up: Array) -> Reach | None:
        spheres = self.robot.body_spheres(grasp.opening)
        if self._gap(spheres, approach, self.others) < APPROACH_GAP:
            return None
        transit = self.transit(approach[0], spheres, self.seen)
        if transit is None:
            return None
        return Reach(grasp, transit, approach, np.vstack([approach[-1:], up]))

    def transit(
        self,
        goal: Array,
        spheres: Spheres,
        seen: Array,
        *,
        gap: float = TRANSIT_GAP,
        held: Spheres | None = None,
    ) -> Array | None:
        """A way through free space.

        Args:
            goal: the posture it ends in (k,) [rad].
            spheres: what arm and hand fill.
            seen: points of what may be hit (n, 3) [m].
            gap: to keep from them [m].
            held: what the hand holds; it may not hit the arm either.

        Returns:
            Postures (n, k) from where the arm is; None when there is no such way.
        """
        start = self.robot.joints
        over_start, over_goal = self._raised(start), self._raised(goal)
        home = self.robot.kind.home
        for via in (
            [],
            [over_goal],
            [over_start, over_goal],
            [home],
            [over_start, home, over_goal],
        ):
            path = np.vstack([start, *via, goal])
            # The start is where it is: something may be nearer to it than a path should be.
            least = min(gap, self._gap(spheres, path[:1], seen, held))
            if self._gap(spheres, self._passed(path), seen, held) >= least - ROUNDING:
                return path
        return None

    def _passed(self, path: Array) -> Array:
        run, _ = timed(path, self.robot.chain.speed, step=TIME_STEP, pace=FASTEST)
        return passed(run, CHECK_STEP)

    def straight_up(self, height: float) -> Array | None:
        """Postures from where the arm is, straight up by `height` [m]; None when out of reach."""
        grip, start = self.robot.world_from_grip, self.robot.joints
        way = self._straight(
            grip[None], (poses.translation(0, 0, height) @ grip)[None], start[None]
        )
        return np.vstack([start[None], way.joints[0]]) if way.found[0] else None

    def straight_to(self, world_from_grip: Array) -> Array | None:
        """Postures from where the arm is, straight to a pose; None when out of reach."""
        start = self.robot.joints
        way = self._straight(self.robot.world_from_grip[None], world_from_grip[None], start[None])
        return np.vstack([start[None], way.joints[0]]) if way.found[0] else None

    def way_from(self, joints: Array, start: Array, end: Array) -> Array | None:
        """Postures from joints (k,), straight from one pose to another; None if out of reach."""
        way = self._straight(start[None], end[None], joints[None])
        return np.vstack([joints[None], way.joints[0]]) if way.found[0] else None

    def postures(self, world_from_grip: Array) -> Solution:
        """Joints for poses of the grip (m, 4, 4), near to where the arm is if that can be."""
        targets = self.robot.base_from_hand(world_from_grip)
        starts = np.vstack([self.robot.joints, self.robot.kind.starts])
        return self.robot.chain.solve(targets, starts)

    def reaches(self, part: Array) -> bool:
        """Whether the hand comes to any of the points (n, 3) of a part, from any side."""
        places = part[spread(part, PLACES, first=0)]
        at = poses.pose(hand_directions(0.0)[::EVERY_DIRECTION], places[:, None])
        return bool(self.postures(at.reshape(-1, 4, 4)).found.any())

    def travel(self, joints: Array) -> Array:
        """How long the arm needs at least from where it is to postures (m, k) [s]."""
        way = np.abs(joints - self.robot.joints) / self.robot.chain.speed
        return way.max(axis=1)

    def _straight(self, start: Array, end: Array, joints: Array) -> Solution:
        longest = np.linalg.norm(end[:, :3, 3] - start[:, :3, 3], axis=1).max(initial=0.0)
        count = max(1, int(np.ceil(longest / APPROACH_STEP - ROUNDING)))
        fractions = np.linspace(0.0, 1.0, count + 1)[1:]
        path = np.stack(
            [poses.interpolate(a, b, fractions) for a, b in zip(start, end, strict=True)]
        )
        return self.robot.chain.track(self.robot.base_from_hand(path), joints)

    def _raised(self, joints: Array) -> Array:
        """The posture with the hand as high as `VIA_HEIGHT` above the table, where it can be."""
        chain = self.robot.chain
        base_from_hand = chain.forward(joints[None])
        world_from_hand = self.robot.world_from_base @ base_from_hand
        grip = self.robot.hand_from_grip[2, 3]
        lack = self.table + VIA_HEIGHT + grip - world_from_hand[0, 2, 3]
        world_from_hand[0, 2, 3] += max(0.0, lack)
        target = poses.inverse(self.robot.world_from_base) @ world_from_hand
        answer = chain.solve(target, joints[None])
        return answer.joints[0] if answer.found[0] else joints

    def _gap(
        self, spheres: Spheres, path: Array, seen: Array, held: Spheres | None = None
    ) -> float:
        chain = self.robot.chain
        filled = spheres if held is None else spheres.joined(held)
        gap = clearance(
            chain,
            filled,
            path,
            world_from_base=self.robot.world_from_base,
            seen=seen,
            table=self.table,
        )
        return gap if held is None else min(gap, self_clearance(chain, held, spheres, path))


def _half_turned(grasp: Grasp) -> Grasp:
    half = poses.pose(poses.rotation_about((0, 0, 1), np.pi), np.zeros(3))
    return Grasp(grasp.world_from_grip @ half, grasp.width, grasp.opening, grasp.score)
