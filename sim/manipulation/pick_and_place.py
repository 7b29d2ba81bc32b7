# SPDX-License-Identifier: Apache-2.0
"""Pick and place: grasp an object by a part, lift it, hand it over, put it down, or point at it.

Each action returns a `MotionReport`. A failed grasp is followed by another one until the attempts
are used up, and a lost object is grasped again; what is impossible is reported without trying.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from ...ontology.errors import MotionInterruptedError
from .. import poses
from ..grasping.context import GraspContext
from ..grasping.planner import RankedGrasps
from ..grasping.selection import GraspAttempts, select_grasp
from ..poses import Array
from ..robot.grasp_poses import Grasp
from ..robot.path_planner import GraspPath, PathPlanner
from ..scene.world import SleepManager, World
from ..vision.percept import Percept
from ..vision.vision_backends import CachedVision
from .hand_motions import FingerContacts, HandMotion, HeldObject
from .motion_report import MotionReport

LIFT_HEIGHT = 0.15  # [m]
MIN_LIFT = 0.10  # [m], less is not lifted
RAISED = 0.01  # [m], from which on an object has left the table, as after an interruption
HOLD_TIME = 1.0  # [s], after a lift
OFFER_TIME = 0.5  # [s], at the receiver
BUMP = 0.01  # [m], a neighbour that moved more was bumped
LOST = {"slipped", "dropped"}  # reasons that mean that the object has left the hand

PlanListener: TypeAlias = Callable[[str, str | None, RankedGrasps, Grasp | None], None]


class PickAndPlace:
    """Grasps objects with a robot, lifts them, hands them over and puts them back.

    The seed is that of the choice of grasps.

    Attributes:
        motion: moves the robot.
        held: the object in the hand; None when it is empty.
        on_plan: called, if not None, before each closing of the gripper, with the name of the
            object, the part to grasp it by, the last grasp plan, and the selected grasp.
    """

    def __init__(
        self,
        world: World,
        motion: HandMotion,
        vision: CachedVision,
        sleeping: SleepManager,
        *,
        seed: int,
    ) -> None:
        self.motion = motion
        self.held: HeldObject | None = None
        self.on_plan: PlanListener | None = None
        self._world, self._vision, self._sleeping = world, vision, sleeping
        self._rng = np.random.default_rng(seed)
        self._task = GraspAttempts("", None)
        self._before: dict[str, Array] = {}  # poses of all objects before the task
        self._is_interrupted = False  # since the last motion, which left the arm where it was

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the gripper on an object, by this part; None leaves the choice to the robot."""
        if self.motion.robot.kind.gripper is None:
            return MotionReport("grasp", ok=False, reason="no_gripper")
        if self._resumes(percept, part):
            return self.report("grasp", "")
        self.clear_hand()
        self._task = GraspAttempts(percept.name, part)
        self._before = {name: self._world.pose(name) for name in self._world.kinds}
        self._sleeping.sleep_again(but=percept.name)
        return self._grasp()

    def lift(self, height_m: float = LIFT_HEIGHT) -> MotionReport:
        """Lift the held object and hold it for a second; grasp it again when it slips.

        Grasps are planned for `LIFT_HEIGHT`; a larger height may be out of reach.
        """
        return self._retry(lambda: self._lift(height_m), self._grasp)

    def hold(self, seconds: float) -> MotionReport:
        """Stand still with the held object."""
        if self.held is None:
            return MotionReport("hold", ok=False, reason="nothing_held")
        held_s = self.motion.hold_still(self.held, seconds)
        return self.report("hold", "" if held_s >= seconds else "dropped", held_s=held_s)

    def hand_over(self) -> MotionReport:
        """Bring the held object to the receiver, its free part first, and hold it there.

        An object that is lost on the way is grasped and lifted again.
        """
        return self._retry(self._hand_over, self._grasp_and_lift)

    def put_back(self) -> MotionReport:
        """Put the held object back where it was taken up, and release it."""
        if self.held is None:
            return MotionReport("put_back", ok=False, reason="nothing_held")
        reason = self.motion.put_back(self.held, self.motion.path_planner(self.held.context))
        if not reason:
            self.held = None
        return self.report("put_back", reason)

    def put_down(self) -> MotionReport:
        """Put the held object on the nearest free place of the table, and release it."""
        if self.held is None:
            return MotionReport("put_down", ok=False, reason="nothing_held")
        reason = self.motion.put_down(self.held, self.motion.path_planner(self.held.context))
        if not reason:
            self.held = None
        return self.report("put_down", reason)

    def release(self) -> MotionReport:
        """Open the gripper where it is, and go home."""
        if self.held is None:
            return MotionReport("release", ok=False, reason="nothing_held")
        self.drop()
        return self.report("release", "")

    def clear_hand(self) -> None:
        """Empty the hand: put what it holds back, or down; leave where it was interrupted."""
        if self.held and not self.put_back().ok and not self.put_down().ok:
            self.drop()
        if self._is_interrupted:
            points = self._vision.obstacles("")
            motion = self.motion
            motion.release(PathPlanner(motion.robot, motion.table, points, points))
        self._is_interrupted = False

    def interrupted(self, action: str) -> MotionReport:
        """Report on a motion that was ended while it ran."""
        held = self.held
        if held and not self.motion.finger_contacts().holds(held.name):
            self.held = None
        self._is_interrupted = True
        return self.report(action, "interrupted")

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at an object without touching it; a held one is put back before."""
        self.clear_hand()
        context = self._observe(percept.name, None)
        if context is None:
            return MotionReport("point_at", ok=False, reason="nothing_seen")
        planner = self.motion.path_planner(context)
        reason = self.motion.point_at(context.percept.cloud, planner)
        return MotionReport("point_at", ok=not reason, reason=reason)

    def drop(self) -> None:
        """Release the held object, or what is left of the grip on it, and go home."""
        if self.held:
            self.motion.release(self.motion.path_planner(self.held.context))
        self.held = None

    def report(
        self, action: str, reason: str, *, held_s: float = 0.0, touched: tuple[str, ...] = ()
    ) -> MotionReport:
        """Report on an action in the present state; it succeeded when `reason` is empty."""
        held = self.held
        slip_m, slip_rad = self.motion.slip(held) if held else (0.0, 0.0)
        return MotionReport(
            action,
            ok=not reason,
            reason=reason,
            touched=touched or (self.motion.finger_contacts().parts(held.name) if held else ()),
            lifted_m=self.motion.height_gained(held) if held else 0.0,
            held_s=held_s,
            attempts=self._task.attempts,
            failures=self._task.failures,
            score=held.path.grasp.score if held else 0.0,
            slip_m=slip_m,
            slip_rad=slip_rad,
            bumped=self._bumped(),
        )

    def _resumes(self, percept: Percept, part: str | None) -> bool:
        """Whether the hand still holds an object as wanted, after an interruption."""
        held = self.held
        if not self._is_interrupted or held is None or held.name != percept.name:
            return False
        self._is_interrupted = False
        return part in {None, held.context.part}

    # --- steps --------------------------------------------------------------------------------

    def _observe(self, name: str, part: str | None) -> GraspContext | None:
        """How an object and its surroundings are seen now; None when it is not visible."""
        percept = self._vision.find(name)
        if percept is None:
            return None
        return GraspContext(percept, self._world.kinds[name], part, self._vision.obstacles(name))

    def _grasp(self) -> MotionReport:
        """Observe, plan and close the gripper until it holds the part or the task is given up."""
        reason = "nothing_seen"
        while not self._task.is_given_up:
            context = self._observe(self._task.name, self._task.part)
            if context is None or not len(context.target):
                break
            reason, path = self._select(context)
            if path is None:
                break
            reason, contacts = self._close_on(path, context)
            if not reason:
                return self.report("grasp", "", touched=contacts.parts(self._task.name))
            self._task = self._task.with_failure(reason)
            self.motion.release(self.motion.path_planner(context))
            self.held = None
        return MotionReport(
            "grasp",
            ok=False,
            reason=reason,
            attempts=self._task.attempts,
            failures=self._task.failures,
            bumped=self._bumped(),
        )

    def _select(self, context: GraspContext) -> tuple[str, GraspPath | None]:
        """The path to the selected grasp, or the reason why there is none."""
        selection = select_grasp(
            self._task,
            context,
            self.motion.path_planner(context),
            self.motion.robot.gripper,
            lift=LIFT_HEIGHT,
            rng=self._rng,
        )
        if self.on_plan:
            grasp = selection.path.grasp if selection.path else None
            self.on_plan(self._task.name, self._task.part, selection.plan, grasp)
        return selection.reason, selection.path

    def _close_on(self, path: GraspPath, context: GraspContext) -> tuple[str, FingerContacts]:
        """Close the gripper once; the reason of failure, and what the fingers touch."""
        name = self._task.name
        before = self._world.pose(name)
        try:
            contacts = self.motion.grasp(path)
        except MotionInterruptedError:
            if self.motion.finger_contacts().holds(name):
                self.held = self.motion.held_object(context, path, before)
            raise
        self._task = self._task.with_attempt(path.grasp)
        allowed = {(name, part) for part in context.allowed_parts}
        if contacts.both - allowed:
            return "wrong_part", contacts
        if not contacts.holds(name):
            return "missed", contacts
        self.held = self.motion.held_object(context, path, before)
        return "", contacts

    def _retry(
        self, act: Callable[[], MotionReport], recover: Callable[[], MotionReport]
    ) -> MotionReport:
        """Act with the held object; when it is lost, recover it and act again."""
        report = act()
        while report.reason in LOST:
            self._task = self._task.with_failure(report.reason)
            self.drop()
            report = replace(report, failures=self._task.failures)
            if self._task.is_given_up:
                break
            recovered = recover()
            if not recovered.ok:
                return replace(report, attempts=recovered.attempts, failures=recovered.failures)
            report = act()
        return report

    def _lift(self, height_m: float) -> MotionReport:
        held = self.held
        if held is None:
            return MotionReport("lift", ok=False, reason="nothing_held")
        gained = self.motion.height_gained(held)
        rest = height_m if gained < RAISED else max(0.0, height_m - gained)
        if rest and not self.motion.lift(held, rest, self.motion.path_planner(held.context)):
            return self.report("lift", "slipped")
        held_s = self.motion.hold_still(held, HOLD_TIME)
        if held_s < HOLD_TIME:
            return self.report("lift", "dropped", held_s=held_s)
        lifted = self.motion.height_gained(held) >= min(MIN_LIFT, height_m)
        return self.report("lift", "" if lifted else "slipped", held_s=held_s)

    def _grasp_and_lift(self) -> MotionReport:
        grasped = self._grasp()
        return self.lift() if grasped.ok else grasped

    def _hand_over(self) -> MotionReport:
        held = self.held
        if held is None:
            return MotionReport("hand_over", ok=False, reason="nothing_held")
        reason = self.motion.hand_over(held, self.motion.path_planner(held.context))
        if reason:
            return self.report("hand_over", reason)
        held_s = self.motion.hold_still(held, OFFER_TIME)
        if held_s < OFFER_TIME:
            return self.report("hand_over", "dropped", held_s=held_s)
        grip = self.motion.robot.world_from_grip
        at = (*grip[:3, 3].tolist(), *poses.quaternion(grip[:3, :3]))
        return replace(self.report("hand_over", "", held_s=held_s), at=at)

    def _bumped(self) -> tuple[str, ...]:
        """The neighbours that have moved since the task was set."""
        moved = {
            name: float(np.linalg.norm(self._world.pose(name)[:3, 3] - before[:3, 3]))
            for name, before in self._before.items()
            if name != self._task.name
        }
        return tuple(name for name, distance in moved.items() if distance > BUMP)
