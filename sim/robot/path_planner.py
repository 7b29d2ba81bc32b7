"""Grasps, and collision-free paths of an arm: to them, through free space, and straight.

A path to a grasp has three parts: a transit through free space to a pose before the grasp, a
straight approach, and a straight lift; a grasp that cannot be lifted is useless. Paths are checked
against the points that the cameras saw (`collision`).
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from .. import poses
from ..poses import Array, farthest_points
from .collision import CollisionSpheres, clearances, hand_spheres
from .kinematics import IkSolutions
from .robot import Robot, resample

RETREAT = 0.09  # [m] before the grasp, where the straight approach begins
LIFT_HEIGHT = 0.15  # [m], of the straight lift after the grasp
STRAIGHT_STEP = 0.0225  # [m] between the poses of a straight path; between them it bends by 0.5 mm
CHECK_STEP = 0.03  # [rad] between the postures that are checked: the hand moves 2 cm
MAX_PACE = 0.9  # share of the joints' speed limits; faster paths cut their corners more
TRANSIT_GAP = 0.008  # [m] to everything on the way through free space
APPROACH_GAP = 0.0005  # [m] to the rest; the tips come as near as 0.8 mm to the table
HELD_RADIUS = 0.008  # [m], of the spheres that stand for a held object
BATCH = 4  # grasps whose paths are sought together: the first ones mostly have one
ROUNDING = 1e-4  # [m], so that starting near something does not forbid to leave it
TRIED_POINTS = 8  # of a part, before it is called unreachable
TRIED_ORIENTATIONS = slice(None, None, 6)  # of the gripper there
VIA_HEIGHT = 0.30  # [m] above the table, high enough to pass over things
DOWN = poses.rotation_about((1.0, 0.0, 0.0), np.pi)  # the gripper looks straight down
FINGERS_EXCHANGED = np.stack([np.eye(4), np.diag([-1.0, -1.0, 1.0, 1.0])])  # as they are, or so
LEVEL_ROLLS = 24  # of the gripper that looks straight down
TILTS_DEG = ((25.0, 8, 6), (50.0, 8, 6), (75.0, 12, 6))  # tilt, headings, rolls


@dataclass(frozen=True)
class Grasp:
    """A pose of the gripper from which it closes on a part."""

    world_from_grip: Array  #: pose (4, 4) of the grip frame when the fingers close
    width: float  #: width of the part between the pads [m]
    opening: float  #: opening of the gripper before it closes [m]
    score: float  #: score of the grasp, at most 1; higher is better


@dataclass(frozen=True)
class GraspPath:
    """A path to a grasp, and the lift after it, as postures (n, k) [rad]."""

    grasp: Grasp  #: the grasp at the end; its pose may be turned by half a turn about the approach
    transit: Array  #: path from the current posture to the pose before the grasp
    approach: Array  #: path from there to the grasp
    lift: Array  #: path from the grasp upwards


@dataclass(frozen=True)
class PathPlanner:
    """Plans paths that start where a robot is now."""

    robot: Robot
    scene: Array  #: points (n, 3) on everything on the table, in the world [m]
    obstacles: Array  #: points (n, 3) of the scene without the object that is to be grasped [m]
    table: float = 0.0  #: height of the table [m]

    def grasp_paths(self, grasps: Sequence[Grasp]) -> Iterator[GraspPath]:
        """Paths to those grasps that can be reached and lifted by `LIFT_HEIGHT`, in order."""
        for first in range(0, len(grasps), BATCH):
            yield from self._grasp_paths(grasps[first : first + BATCH])

    def _grasp_paths(self, grasps: Sequence[Grasp]) -> Iterator[GraspPath]:
        pairs = np.stack([grasp.world_from_grip for grasp in grasps])[:, None]
        at = (pairs @ FINGERS_EXCHANGED).reshape(-1, 4, 4)
        approach = self._approaches(at)
        up = self._straight(at, poses.translation(0, 0, LIFT_HEIGHT) @ at, approach.joints[:, -1])
        found = approach.found & up.found
        # Of a grasp and its half turn, the one that is nearer comes first.
        nearer = self.travel_time(approach.joints[:, 0]).reshape(-1, 2).argsort(axis=1)
        order = (2 * np.arange(len(grasps))[:, None] + nearer).ravel()
        for index in order[found[order]]:
            grasp = replace(grasps[index // 2], world_from_grip=at[index])
            on, lifted = approach.joints[index], up.joints[index]
            if not self.is_clear(np.vstack([on, lifted]), grasp.opening):
                continue
            if (transit := self.plan_transit(on[0], grasp.opening)) is not None:
                yield GraspPath(grasp, transit, on, np.vstack([on[-1:], lifted]))

    def _approaches(self, at: Array) -> IkSolutions:
        back = at @ poses.translation(0, 0, -RETREAT)
        before = self.inverse_kinematics(back)
        on = self._straight(back, at, before.joints)
        joints = np.concatenate([before.joints[:, None], on.joints], axis=1)
        found = before.found & on.found
        if len(lost := np.flatnonzero(~found)):
            # Near joint limits a path may be found from its end and not from its beginning.
            there = self.inverse_kinematics(at[lost])
            off = self._straight(at[lost], back[lost], there.joints)
            joints[lost] = np.concatenate([there.joints[:, None], off.joints], axis=1)[:, ::-1]
            found[lost] = there.found & off.found
        return IkSolutions(joints, found)

    def plan_transit(
        self, goal: Array, opening: float, *, gap: float = TRANSIT_GAP, held: Array | None = None
    ) -> Array | None:
        """Plan a path through free space from where the arm is to a posture (k,) [rad].

        It keeps a gap [m] between arm and hand, open by `opening` [m], and the scene; with a `held`
        object, points (n, 3) in the hand frame [m], to the obstacles. It also keeps one between
        the hand with that object and the arm. Returns postures (n, k), or None without a path.
        """
        start = self.robot.joints
        over_start, over_goal = self._raised(start), self._raised(goal)
        home = self.robot.kind.home
        body, points = self.robot.body_spheres(opening), self.scene
        if held is not None:
            body = poses.joined(body, hand_spheres(self.robot.chain, held, HELD_RADIUS))
            points = self.obstacles
        detour = [over_start, home, over_goal]
        for via in ([], [over_goal], [over_start, over_goal], [home], detour):
            path = np.vstack([start, *via, goal])
            # The arm may already be nearer to something than a path should come.
            least = np.minimum(gap, self._gaps(body, path[:1], points))
            # Its corners are checked as the arm rounds them.
            executed, _ = self.robot.timed(path, pace=MAX_PACE)
            if (self._gaps(body, resample(executed, CHECK_STEP), points) >= least - ROUNDING).all():
                return path
        return None

    def is_clear(self, path: Array, opening: float, *, gap: float = APPROACH_GAP) -> bool:
        """Whether a path (n, k) keeps a gap [m] to obstacles, the hand open by `opening` [m]."""
        spheres, home = self.robot.body_spheres(opening), self.robot.kind.home[None]
        # Spheres of the arm may be so large that some always overlap.
        least = np.minimum(gap, self._gaps(spheres, home, self.obstacles))
        return bool((self._gaps(spheres, path, self.obstacles) >= least).all())

    def plan_straight(
        self, goal: Array, *, start: Array | None = None, joints: Array | None = None
    ) -> Array | None:
        """Plan a straight path of the grip to a pose (4, 4); obstacles are not checked.

        It begins at the grip pose `start` and the posture `joints` (k,) [rad]; by default at the
        present ones. Returns postures (n, k), or None when the goal is out of reach.
        """
        joints = self.robot.joints if joints is None else joints
        start = self.robot.world_from_grip if start is None else start
        path = self._straight(start[None], goal[None], joints[None])
        return np.vstack([joints[None], path.joints[0]]) if path.found[0] else None

    def inverse_kinematics(self, world_from_grip: Array) -> IkSolutions:
        """Postures for grip poses (m, 4, 4), near the present one where possible."""
        starts = np.vstack([self.robot.joints, self.robot.kind.starts])
        return self.robot.chain.solve(self.robot.base_from_hand(world_from_grip), starts)

    def can_reach(self, points: Array) -> bool:
        """Whether the grip can come to any of the points (n, 3) in any orientation."""
        places = points[farthest_points(points, TRIED_POINTS, first=0)]
        at = poses.pose(grasp_orientations(0.0)[TRIED_ORIENTATIONS], places[:, None])
        return bool(self.inverse_kinematics(at.reshape(-1, 4, 4)).found.any())

    def travel_time(self, joints: Array) -> Array:
        """The least time (m,) from the present posture to postures (m, k) [s]."""
        return (np.abs(joints - self.robot.joints) / self.robot.chain.speed).max(axis=1)

    def _straight(self, start: Array, end: Array, joints: Array) -> IkSolutions:
        longest = np.linalg.norm(end[:, :3, 3] - start[:, :3, 3], axis=1).max(initial=0.0)
        count = max(1, int(np.ceil(longest / STRAIGHT_STEP - ROUNDING)))
        fractions = np.linspace(0.0, 1.0, count + 1)[1:]
        pairs = zip(start, end, strict=True)
        path = np.stack([poses.interpolate(*pair, fractions) for pair in pairs])
        return self.robot.chain.track(self.robot.base_from_hand(path), joints)

    def _raised(self, joints: Array) -> Array:
        chain = self.robot.chain
        base_from_hand = chain.forward(joints[None])
        lack = self.table + VIA_HEIGHT + self.robot.hand_from_grip[2, 3] - base_from_hand[0, 2, 3]
        base_from_hand[0, 2, 3] += max(0.0, lack)
        answer = chain.solve(base_from_hand, joints[None])
        return answer.joints[0] if answer.found[0] else joints

    def _gaps(self, body: CollisionSpheres, path: Array, points: Array) -> Array:
        """The smallest gaps (2,) [m] along a path: to what is around, and to the arm itself."""
        return clearances(self.robot.chain, body, path, points=points, table=self.table)


def grasp_orientations(heading: float) -> Array:
    """The orientations `world_from_grip` (d, 3, 3) that are tried, turned by `heading` [rad]."""
    rolls = poses.rotation_about((0, 0, 1), heading + np.arange(LEVEL_ROLLS) * np.pi / LEVEL_ROLLS)
    return np.concatenate([rolls @ DOWN, hand_orientations(TILTS_DEG, heading=heading, turn=np.pi)])


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
