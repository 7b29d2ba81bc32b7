"""Striking: drive an object such as a nail into another one with a face of the held object.

A good face is wide, level, the lowest of hand and object, and near below the hand: a blow far from
the fingers turns the object in them. Faces are sought in the point cloud, over many orientations of
the hand. The blow is straight down and aims below the target, so that the face is fast at contact.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
import shapely

from .. import poses
from ..physics.engine import TIME_STEP
from ..poses import Array, voxel_downsample
from ..robot.path_planner import hand_orientations
from ..robot.robot import NAME
from ..vision.percept import Percept
from .hand_motions import HeldObject
from .motion_report import MotionReport
from .pick_and_place import LOST, PickAndPlace

POINT_CELL = 0.003  # [m], voxel size of the points in which faces are sought
LEVEL = 0.003  # [m] above the lowest point, up to which points belong to the face
MIN_FACE = 4e-5  # [m^2], about 6 x 6 mm; a smaller face would slide off a nail
BEST_FACE = 4e-4  # [m^2], a larger one is no better
LEVER_COST = 6.0  # [1/m] of score for the distance between face and hand
TILT_COST = 0.15  # of score for a hand that does not look down
HAND_CLEARANCE = 0.012  # [m] of the hand above the face
TILTS_DEG = ((0, 1, 12), (30, 12, 12), (60, 12, 12), (80, 12, 12), (90, 12, 12))  # headings, rolls
INWARDS = 0.4  # share of the way from the rim of a face to its middle, where it may strike
MAX_POSES = 60  # that are tried

START_HEIGHT = 0.10  # [m] above the target, where a blow starts
THROUGH = (0.12, 0.05, 0.02, 0.005)  # [m] below the target, where a blow aims
BLOW_PACE, RAISE_PACE = 0.9, 0.4
BLOW_FORCE = 2.0  # [N], contacts with more are a hit
FOLLOW_STEPS = 5  # for which the hand moves on after a hit
AFTER_BLOW = 0.15  # [s], until everything is at rest
SAME_FACE = 0.6  # [rad]
MAX_DETOURS = 8  # poses to which a detour is sought

DRIVEN = 0.003  # [m], an object that lacks less is driven in
TOP = 0.0015  # [m] below the highest point, down to which points belong to the top


class Striking(PickAndPlace):
    """Also strikes with the object in the hand."""

    # The name of what is to be driven in, and where its top would be at a depth of zero (3,) [m].
    _target: tuple[str, Array] | None = None

    def move_above(self, percept: Percept) -> MotionReport:
        """Bring the held object above one that is to be driven in, a face of it downwards."""
        return self._act("move_above", lambda held: self._move_above(held, percept))

    def raise_(self) -> MotionReport:
        """Bring the held object back above what it strikes, ready for a blow."""
        return self._act("raise", lambda held: self._struck("raise", held, self._raise))

    def lower(self) -> MotionReport:
        """Strike once; driving the target in completely is a success even if the grip is lost."""
        return self._act("lower", self._lower)

    def _move_above(self, held: HeldObject, percept: Percept) -> MotionReport:
        if percept.name not in self.world.supports:
            return self._report("move_above", "nothing_to_strike")
        height = float(percept.cloud[:, 2].max())
        face = percept.cloud[percept.cloud[:, 2] > height - TOP]
        x, y, _ = (face.min(axis=0) + face.max(axis=0)) / 2
        self._target = percept.name, np.array([x, y, height + self.world.depth(percept.name)])
        return self._struck("move_above", held, self._carry_above)

    def _lower(self, held: HeldObject) -> MotionReport:
        report = self._struck("lower", held, self._blow)
        if report.reason not in LOST:
            return report
        self._drop(held)
        return replace(report, ok=True, reason="") if report.driven else report

    def _struck(
        self, action: str, held: HeldObject, act: Callable[[HeldObject, Array], str]
    ) -> MotionReport:
        if self._target is None:
            return MotionReport(action, ok=False, reason="nothing_held")
        name, top = self._target
        start = np.add(top, (0, 0, START_HEIGHT - self.world.depth(name)))
        report = self._report(action, act(held, start))
        depth, mount = self.world.depth(name), self.world.kinds[name].mount
        driven = mount is not None and depth > mount.deepest - DRIVEN
        return replace(report, depth_m=depth, driven=driven)

    def _carry_above(self, held: HeldObject, start: Array) -> str:
        goals = (strike.world_from_grip(start) for strike in self._strike_poses(held))
        paths = (self._plan_strike(held, goal) for goal in goals)
        path = next((path for path in paths if path is not None), None)
        return "unreachable" if path is None else self._motion.carry(held, path)

    def _raise(self, held: HeldObject, start: Array) -> str:
        self.in_hand = held = self._motion.seen(held)  # a blow may have turned it
        now = self.robot.world_from_grip[:3, :3]
        found = self._strike_poses(held)
        same_face = [s for s in found if poses.angle_between(s.rotation, now) < SAME_FACE]
        points = self._points_in_grip(held)
        as_now = StrikePose(now, points[np.argmin((points @ now.T)[:, 2])], 0.0)
        goals = [strike.world_from_grip(start) for strike in [*same_face, as_now]]
        paths = ((goal, held.planner.plan_straight(goal)) for goal in goals)
        straight = [(goal, path) for goal, path in paths if path is not None]
        best = (path for goal, path in straight if self._can_strike(held, path[-1], goal))
        # Where joint limits bar the straight path, a detour through free space is taken.
        detours = (self._plan_strike(held, goal) for goal in goals[:MAX_DETOURS])
        for path in chain(best, detours, (path for _, path in straight)):
            if path is not None:
                free = self.robot.follow(path, pace=RAISE_PACE, stop=self._motion.loss_check())
                return "" if free else "dropped"
        return "unreachable"

    def _blow(self, held: HeldObject, _: Array) -> str:
        grip = self.robot.world_from_grip
        ends = (poses.translation(0, 0, -START_HEIGHT - through) @ grip for through in THROUGH)
        paths = map(held.planner.plan_straight, ends)
        path = next((path for path in paths if path is not None), None)
        if path is None:
            return "unreachable"
        after = 0

        def is_done() -> bool:
            nonlocal after
            contacts = self.robot.engine.bodies.contacts(held.name)
            hit = any(c.force > BLOW_FORCE and c.other != NAME for c in contacts)
            after += bool(after) or hit
            return after > FOLLOW_STEPS

        self.robot.follow(path, pace=BLOW_PACE, stop=is_done)
        reason = "" if self.robot.is_holding else "dropped"
        self.robot.advance(round(AFTER_BLOW / TIME_STEP))
        return reason

    def _strike_poses(self, held: HeldObject) -> "list[StrikePose]":
        spheres = self.robot.body_spheres(self.robot.opening)
        own = spheres.link == len(self.robot.chain.links) - 1
        around = np.vstack([np.eye(3), -np.eye(3)]) * spheres.radius[own, None, None]
        points = (spheres.centre[own, None] + around).reshape(-1, 3)
        hand = poses.transform(poses.inverse(self.robot.hand_from_grip), points)
        return find_strike_poses(self._points_in_grip(held), hand)

    def _points_in_grip(self, held: HeldObject) -> Array:
        """The points (n, 3) of the object as it was seen, in the grip frame now [m]."""
        grip_from_seen = poses.inverse(held.hand_from_grip) @ held.hand_from_seen
        return poses.transform(grip_from_seen, held.context.percept.cloud)

    def _plan_strike(self, held: HeldObject, goal: Array) -> Array | None:
        answer = held.planner.inverse_kinematics(goal[None])
        if not answer.found[0] or not self._can_strike(held, answer.joints[0], goal):
            return None
        return self._motion.plan_carry(held, answer.joints[0])

    def _can_strike(self, held: HeldObject, joints: Array, start: Array) -> bool:
        below = poses.translation(0, 0, -START_HEIGHT - THROUGH[0]) @ start
        return held.planner.plan_straight(below, start=start, joints=joints) is not None


@dataclass(frozen=True)
class StrikePose:
    """An orientation of the hand in which a face of the held object strikes."""

    rotation: Array  #: that of `world_from_grip` at the blow (3, 3)
    point: Array  #: of the face, which meets the target (3,), in the grip frame [m]
    score: float  #: higher is better

    def world_from_grip(self, target: Array) -> Array:
        """The grip (4, 4) with the face at a point (3,) of the world [m]."""
        return poses.pose(self.rotation, target - self.rotation @ self.point)


def find_strike_poses(held: Array, hand: Array) -> list[StrikePose]:
    """Return poses to strike, best first, for points (n, 3), (m, 3) in the grip frame [m]."""
    cloud = held[voxel_downsample(held, POINT_CELL)]
    found = (_strike_pose(rotation, cloud, hand) for rotation in hand_orientations(TILTS_DEG))
    good = [strike for strike in found if strike is not None]
    return sorted(good, key=lambda strike: -strike.score)[:MAX_POSES]


def _strike_pose(rotation: Array, held: Array, hand: Array) -> StrikePose | None:
    at = held @ rotation.T
    lowest = float(np.partition(at[:, 2], 2)[2])  # one stray point is no face
    if lowest > float((hand @ rotation.T)[:, 2].min()) - HAND_CLEARANCE:
        return None
    face = at[at[:, 2] < lowest + LEVEL]
    size = float(shapely.area(shapely.convex_hull(shapely.multipoints(face[:, :2]))))
    if size < MIN_FACE:
        return None
    middle = face.mean(axis=0)
    inner = middle + (1 - INWARDS) * (face - middle)
    lever = np.linalg.norm(inner[:, :2], axis=1)
    point = np.array([*inner[np.argmin(lever), :2], lowest])
    score = np.sqrt(min(size / BEST_FACE, 1.0)) - LEVER_COST * float(lever.min())
    return StrikePose(rotation, rotation.T @ point, score - TILT_COST * (1 + float(rotation[2, 2])))
