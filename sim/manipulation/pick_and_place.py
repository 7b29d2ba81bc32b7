# SPDX-License-Identifier: Apache-2.0
"""Handling a thing: taken by a part, lifted, held, given, put back; what is lost is taken again.

Of every motion a `MotionReport` tells what came of it. A grasp that fails is followed by another
one as long as the aim is not given up, and what cannot be done is said and not tried.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import TypeAlias

import numpy as np

from .. import poses
from ..grasping.context import Sight
from ..grasping.planner import Grasp, GraspPlan
from ..grasping.selection import Aim, choose
from ..poses import Array
from ..robot.path_planner import Reach, Reacher
from ..robot.robot import Robot
from ..scene.sleeping import SleepManager
from ..scene.world import World
from ..vision.gaze import Gaze
from ..vision.percept import Percept
from .motion import FingerContacts, Held, Motion
from .report import MotionReport
from .target import StrikeTarget

LIFT_HEIGHT = 0.15  # [m]
LEAST_LIFT = 0.10  # [m], less is not lifted
HOLD_TIME = 1.0  # [s], after a lift
OFFER_TIME = 0.5  # [s], at the receiver
BUMP = 0.01  # [m], a neighbour that moved more was bumped
LOST = {"slipped", "dropped"}  # reasons that mean: the thing is not in the hand any more

PlanListener: TypeAlias = Callable[[str, str | None, GraspPlan, Grasp | None], None]


class PickAndPlace:
    """Takes objects with a robot, lifts them, hands them over and puts them back.

    Args:
        world: what is on the table.
        robot: that acts.
        motion: moves its arm.
        gaze: sees the objects.
        sleeping: which of them lie still.
        seed: from which all choices of grasps are drawn.

    Attributes:
        held: what is in the hand; None when it is empty.
        sight: how the object that the hand closed on last was seen before.
        target: what is struck with the held object, as it stands in reports.
        on_plan: called while it is not None before each closing of the hand: name of the object,
            the part it must be taken by, the last plan of grasps, and the grasp that is taken.
    """

    def __init__(
        self,
        world: World,
        robot: Robot,
        motion: Motion,
        gaze: Gaze,
        sleeping: SleepManager,
        *,
        seed: int,
    ) -> None:
        self.held: Held | None = None
        self.sight: Sight | None = None
        self.target: StrikeTarget | None = None
        self.on_plan: PlanListener | None = None
        self._world, self._robot, self._motion = world, robot, motion
        self._gaze, self._sleeping = gaze, sleeping
        self._rng = np.random.default_rng(seed)
        self._aim = Aim("", None)
        self._places: dict[str, Array] = {}

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the hand on a thing.

        Args:
            percept: the thing.
            part: the part by which it must be taken; None leaves the choice to the hand.
        """
        if self._robot.kind.gripper is None:
            return MotionReport("grasp", ok=False, reason="no_gripper")
        if self.held:
            self.put_back()
        self._aim = Aim(percept.name, part)
        self._places = {name: self._world.pose(name) for name in self._world.kinds}
        self._sleeping.sleep_again(but=percept.name)
        return self._grasp_again()

    def lift(self, height_m: float = LIFT_HEIGHT) -> MotionReport:
        """Take what is held up from the table and hold it for a second; regrasps what slips.

        Args:
            height_m: how high; a grasp is only planned for `LIFT_HEIGHT`, more may be out of reach.
        """
        return self._with_it(lambda: self._lift_once(height_m), self._grasp_again)

    def hold(self, seconds: float) -> MotionReport:
        """Stand still with what is held."""
        if self.held is None:
            return MotionReport("hold", ok=False, reason="nothing_held")
        held_s = self._motion.hold_still(self.held, seconds)
        return self.report("hold", "" if held_s >= seconds else "dropped", held_s=held_s)

    def hand_over(self) -> MotionReport:
        """Bring what is held to the receiver, its free part first, and hold it there.

        What is lost on the way is taken and lifted again.
        """
        return self._with_it(self._offer, self._lift_again)

    def put_back(self) -> MotionReport:
        """Put what is held back where it was taken up, and let it go."""
        if self.held is None or self.sight is None:
            return MotionReport("put_back", ok=False, reason="nothing_held")
        reason = self._motion.put_back(self.held, self.reacher(self.sight))
        if not reason:
            self.held = None
        return self.report("put_back", reason)

    # --- how ----------------------------------------------------------------------------------

    def _grasp_again(self) -> MotionReport:
        """Look, plan and close the hand until it holds the part, or the attempts are used up."""
        reason = "nothing_seen"
        while not self._aim.is_given_up:
            sight = self._gaze.sight(self._aim.name, self._aim.part)
            if sight is None or not len(sight.wanted):
                break
            reason, reach = self._choose(sight)
            if reach is None:
                break
            reason, touch = self._take(reach, sight)
            if not reason:
                return self.report("grasp", "", touched=touch.parts(self._aim.name))
            self._aim = self._aim.failed(reason)
            self.release()
        return MotionReport(
            "grasp",
            ok=False,
            reason=reason,
            attempts=self._aim.attempts,
            failures=self._aim.failures,
            bumped=self._bumped(),
        )

    def _choose(self, sight: Sight) -> tuple[str, Reach | None]:
        """The way to the best grasp that can be reached and has not failed before; or why not."""
        choice = choose(
            self._aim,
            sight,
            self.reacher(sight),
            self._robot.gripper,
            lift=LIFT_HEIGHT,
            rng=self._rng,
        )
        if self.on_plan:
            grasp = choice.reach.grasp if choice.reach else None
            self.on_plan(self._aim.name, self._aim.part, choice.plan, grasp)
        return choice.reason, choice.reach

    def _take(self, reach: Reach, sight: Sight) -> tuple[str, FingerContacts]:
        """Close the hand once; what went wrong, and what the fingers feel."""
        name = self._aim.name
        before = self._world.pose(name)
        touch = self._motion.take(reach)
        self._aim = self._aim.closed_on(reach.grasp)
        self.sight = sight
        if not touch.both:
            return "missed", touch
        if any(body != name or link not in sight.allowed for body, link in touch.both):
            return "wrong_part", touch
        if not touch.holds(name):
            return "missed", touch
        self.held = self._motion.grip_on(name, reach, sight, before)
        return "", touch

    def _with_it(
        self, act: Callable[[], MotionReport], again: Callable[[], MotionReport]
    ) -> MotionReport:
        """Do something with what is held; take what is lost again, and do it anew."""
        report = act()
        while report.reason in LOST:
            self._aim = self._aim.failed(report.reason)
            self.release()
            report = replace(report, failures=self._aim.failures)
            if self._aim.is_given_up:
                break
            taken = again()
            if not taken.ok:
                return replace(report, attempts=taken.attempts, failures=taken.failures)
            report = act()
        return report

    def _lift_again(self) -> MotionReport:
        grasped = self._grasp_again()
        return self.lift() if grasped.ok else grasped

    def _offer(self) -> MotionReport:
        if self.held is None or self.sight is None:
            return MotionReport("hand_over", ok=False, reason="nothing_held")
        reason = self._motion.hand_over(self.held, self.reacher(self.sight))
        held_s = 0.0
        if not reason:
            held_s = self._motion.hold_still(self.held, OFFER_TIME)
            reason = "" if held_s >= OFFER_TIME else "dropped"
        report = self.report("hand_over", reason, held_s=held_s)
        return replace(report, at=self._grip()) if report.ok else report

    def _grip(self) -> tuple[float, ...]:
        world_from_grip = self._robot.world_from_grip
        return (*world_from_grip[:3, 3].tolist(), *poses.quaternion(world_from_grip[:3, :3]))

    def _lift_once(self, height_m: float) -> MotionReport:
        if self.held is None or self.sight is None:
            return MotionReport("lift", ok=False, reason="nothing_held")
        if not self._motion.raise_up(self.held, height_m, self.reacher(self.sight)):
            return self.report("lift", "slipped")
        held_s = self._motion.hold_still(self.held, HOLD_TIME)
        if held_s < HOLD_TIME:
            return self.report("lift", "dropped", held_s=held_s)
        lifted = self._motion.height_gained(self.held) >= min(LEAST_LIFT, height_m)
        return self.report("lift", "" if lifted else "slipped", held_s=held_s)

    def release(self) -> None:
        """Open the hand, go back and home."""
        if self.sight is not None:
            self._motion.let_go(self.reacher(self.sight))
        self.held = None

    def reacher(self, sight: Sight) -> Reacher:
        """Return a planner of paths among what was seen."""
        return Reacher(self._robot, self._motion.table, sight.everything, sight.others)

    def report(
        self, action: str, reason: str, *, held_s: float = 0.0, touched: tuple[str, ...] = ()
    ) -> MotionReport:
        """Return a report on an action as things stand now; it succeeded when `reason` is ""."""
        held = self.held
        slip_m, slip_rad = self._motion.slip(held) if held else (0.0, 0.0)
        return MotionReport(
            action,
            ok=not reason,
            reason=reason,
            touched=touched or (self._motion.feel().parts(held.name) if held else ()),
            lifted_m=self._motion.height_gained(held) if held else 0.0,
            held_s=held_s,
            attempts=self._aim.attempts,
            failures=self._aim.failures,
            score=held.reach.grasp.score if held else 0.0,
            slip_m=slip_m,
            slip_rad=slip_rad,
            bumped=self._bumped(),
            depth_m=self.target.depth if self.target else 0.0,
            driven=self.target is not None and self.target.is_in,
        )

    def _bumped(self) -> tuple[str, ...]:
        """The neighbours that have moved since the hand went for its aim."""
        moved = {
            name: float(np.linalg.norm(self._world.pose(name)[:3, 3] - before[:3, 3]))
            for name, before in self._places.items()
            if name != self._aim.name
        }
        return tuple(name for name, distance in moved.items() if distance > BUMP)
