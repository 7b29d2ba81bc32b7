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
from ..robot.models import RobotType
from ..robot.path_planner import Reach, Reacher
from ..robot.robot import Robot
from ..scene.sleeping import Resting
from ..scene.world import World
from ..vision.gaze import Gaze
from ..vision.percept import Percept
from ..vision.sensors import Eyes
from .motion import FingerContacts, Held
from .report import MotionReport
from .striking import StrikingMotion
from .target import StrikeTarget

TABLE_HEIGHT = 0.0  # [m]
LIFT_HEIGHT = 0.15  # [m]
LEAST_LIFT = 0.10  # [m], less is not lifted
HOLD_TIME = 1.0  # [s], after a lift
OFFER_TIME = 0.5  # [s], at the receiver
BUMP = 0.01  # [m], a neighbour that moved more was bumped
LOST = {"slipped", "dropped"}  # reasons that mean: the thing is not in the hand any more
RECEIVER = (1.15, 0.0, 0.40)  # [m], the one who gets things sits across the table
MEETING = (0.58, 0.0, 0.40)  # [m], where things are handed over

Onlooker: TypeAlias = Callable[[str, str | None, GraspPlan, Grasp | None], None]


class Handling:
    """A robot at a table that takes things and gives them.

    Args:
        world: what is on the table.
        kind: what robot it is.
        eyes: where percepts come from.
        seed: from which all choices of the motions are drawn.

    Attributes:
        onlooker: called while it is not None before each closing of the hand: name of the thing,
            the part it must be taken by, the last plan of grasps, and the grasp that is taken.
    """

    def __init__(self, world: World, kind: RobotType, eyes: Eyes, *, seed: int) -> None:
        self.world, self.vision = world, eyes
        self._resting = Resting(world.engine, self._loose())
        self.robot = Robot(world.engine, kind, step=self._step)
        self.motion = StrikingMotion(
            self.robot,
            table=TABLE_HEIGHT,
            receiver=np.array(RECEIVER),
            meeting=np.array(MEETING),
        )
        self.onlooker: Onlooker | None = None
        self._gaze = Gaze(world, eyes)
        self._rng = np.random.default_rng(seed)
        self._held: Held | None = None
        self._sight: Sight | None = None
        self._aim = Aim("", None)
        self._places: dict[str, Array] = {}
        self._target: StrikeTarget | None = None

    @property
    def holding(self) -> str | None:
        """The name of the thing in the hand; None when it is empty."""
        return self._held.name if self._held else None

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the hand on a thing.

        Args:
            percept: the thing.
            part: the part by which it must be taken; None leaves the choice to the hand.
        """
        if self.robot.kind.gripper is None:
            return MotionReport("grasp", ok=False, reason="no_gripper")
        if self._held:
            self.put_back()
        self._aim = Aim(percept.name, part)
        self._places = {name: self.world.pose(name) for name in self.world.kinds}
        self._resting.settle(but=percept.name)
        return self._grasp_again()

    def lift(self, height_m: float = LIFT_HEIGHT) -> MotionReport:
        """Take what is held up from the table and hold it for a second; regrasps what slips.

        Args:
            height_m: how high; a grasp is only planned for `LIFT_HEIGHT`, more may be out of reach.
        """
        return self._with_it(lambda: self._lift_once(height_m), self._grasp_again)

    def hold(self, seconds: float) -> MotionReport:
        """Stand still with what is held."""
        if self._held is None:
            return MotionReport("hold", ok=False, reason="nothing_held")
        held_s = self.motion.hold_still(self._held, seconds)
        return self._report("hold", "" if held_s >= seconds else "dropped", held_s=held_s)

    def hand_over(self) -> MotionReport:
        """Bring what is held to the receiver, its free part first, and hold it there.

        What is lost on the way is taken and lifted again.
        """
        return self._with_it(self._offer, self._lift_again)

    def put_back(self) -> MotionReport:
        """Put what is held back where it was taken up, and let it go."""
        if self._held is None or self._sight is None:
            return MotionReport("put_back", ok=False, reason="nothing_held")
        reason = self.motion.put_back(self._held, self._reacher(self._sight))
        if not reason:
            self._held = None
        return self._report("put_back", reason)

    # --- how ----------------------------------------------------------------------------------

    def _loose(self) -> tuple[str, ...]:
        """What lies loose on the table, and nothing stands in it."""
        stand = {name: self.world.support(name) for name in self.world.kinds}
        return tuple(name for name in stand if not stand[name] and name not in stand.values())

    def _step(self, count: int) -> None:
        """Let time pass, and notice what is moved."""
        for _ in range(count):
            self.world.step()
            self._resting.watch(1)

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
                return self._report("grasp", "", touched=touch.parts(self._aim.name))
            self._aim = self._aim.failed(reason)
            self._release()
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
            self._reacher(sight),
            self.robot.gripper,
            lift=LIFT_HEIGHT,
            rng=self._rng,
        )
        if self.onlooker:
            grasp = choice.reach.grasp if choice.reach else None
            self.onlooker(self._aim.name, self._aim.part, choice.plan, grasp)
        return choice.reason, choice.reach

    def _take(self, reach: Reach, sight: Sight) -> tuple[str, FingerContacts]:
        """Close the hand once; what went wrong, and what the fingers feel."""
        name = self._aim.name
        before = self.world.pose(name)
        touch = self.motion.take(reach)
        self._aim = self._aim.closed_on(reach.grasp)
        self._sight = sight
        if not touch.both:
            return "missed", touch
        if any(body != name or link not in sight.allowed for body, link in touch.both):
            return "wrong_part", touch
        if not touch.holds(name):
            return "missed", touch
        self._held = self.motion.grip_on(name, reach, sight, before)
        return "", touch

    def _with_it(
        self, act: Callable[[], MotionReport], again: Callable[[], MotionReport]
    ) -> MotionReport:
        """Do something with what is held; take what is lost again, and do it anew."""
        report = act()
        while report.reason in LOST:
            self._aim = self._aim.failed(report.reason)
            self._release()
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
        if self._held is None or self._sight is None:
            return MotionReport("hand_over", ok=False, reason="nothing_held")
        reason = self.motion.hand_over(self._held, self._reacher(self._sight))
        held_s = 0.0
        if not reason:
            held_s = self.motion.hold_still(self._held, OFFER_TIME)
            reason = "" if held_s >= OFFER_TIME else "dropped"
        report = self._report("hand_over", reason, held_s=held_s)
        return replace(report, at=self._grip()) if report.ok else report

    def _grip(self) -> tuple[float, ...]:
        world_from_grip = self.robot.world_from_grip
        return (*world_from_grip[:3, 3].tolist(), *poses.quaternion(world_from_grip[:3, :3]))

    def _lift_once(self, height_m: float) -> MotionReport:
        if self._held is None or self._sight is None:
            return MotionReport("lift", ok=False, reason="nothing_held")
        if not self.motion.raise_up(self._held, height_m, self._reacher(self._sight)):
            return self._report("lift", "slipped")
        held_s = self.motion.hold_still(self._held, HOLD_TIME)
        if held_s < HOLD_TIME:
            return self._report("lift", "dropped", held_s=held_s)
        lifted = self.motion.height_gained(self._held) >= min(LEAST_LIFT, height_m)
        return self._report("lift", "" if lifted else "slipped", held_s=held_s)

    def _release(self) -> None:
        """Open the hand, go back and home."""
        if self._sight is not None:
            self.motion.let_go(self._reacher(self._sight))
        self._held = None

    def _reacher(self, sight: Sight) -> Reacher:
        return Reacher(self.robot, TABLE_HEIGHT, sight.everything, sight.others)

    def _report(
        self, action: str, reason: str, *, held_s: float = 0.0, touched: tuple[str, ...] = ()
    ) -> MotionReport:
        held = self._held
        slip_m, slip_rad = self.motion.slip(held) if held else (0.0, 0.0)
        return MotionReport(
            action,
            ok=not reason,
            reason=reason,
            touched=touched or (self.motion.feel().parts(held.name) if held else ()),
            lifted_m=self.motion.height_gained(held) if held else 0.0,
            held_s=held_s,
            attempts=self._aim.attempts,
            failures=self._aim.failures,
            score=held.reach.grasp.score if held else 0.0,
            slip_m=slip_m,
            slip_rad=slip_rad,
            bumped=self._bumped(),
            depth_m=self._target.depth if self._target else 0.0,
            driven=self._target is not None and self._target.is_in,
        )

    def _bumped(self) -> tuple[str, ...]:
        """The neighbours that have moved since the hand went for its aim."""
        moved = {
            name: float(np.linalg.norm(self.world.pose(name)[:3, 3] - before[:3, 3]))
            for name, before in self._places.items()
            if name != self._aim.name
        }
        return tuple(name for name, distance in moved.items() if distance > BUMP)
