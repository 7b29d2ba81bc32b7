"""Pick and place: grasp an object by a part, lift it, hand it over, put it down, or point at it.

A failed grasp is followed by another one until the attempts are used up, and a lost object is
grasped again; what is impossible is reported without trying.
"""

from collections.abc import Callable, Collection
from dataclasses import replace
from itertools import chain, islice
from typing import TypeAlias

import numpy as np

from ...ontology.errors import MotionInterruptedError
from .. import poses
from ..grasping.context import GraspContext
from ..grasping.planner import GraspAttempts, RankedGrasps, plan_grasps, select_grasp
from ..physics.engine import TIME_STEP
from ..robot.path_planner import LIFT_HEIGHT, Grasp, GraspPath, PathPlanner
from ..robot.robot import Robot
from ..scene.world import World
from ..vision.object_detector import ObjectDetector
from ..vision.percept import Percept
from .hand_motions import HandMotion, HeldObject
from .motion_report import MotionReport

MIN_LIFT = 0.10  # [m], less is not lifted
RAISED = 0.01  # [m], from which on an object has left the table, as after an interruption
HOLD_TIME = 1.0  # [s], after a lift
OFFER_TIME = 0.5  # [s], at the receiver
MAX_SLIP, MAX_TURN = 0.01, np.radians(15)  # [m], [rad] in the hand; more is no firm hold
WAYS, MAX_MOVED = 8, 5  # paths that are checked for what bars them; neighbours put aside at once
ROOM, TOUCHING = 0.01, 0.012  # [m] from a path to what bars it; from an object to what may hide it
LOST = {"slipped", "dropped"}  # reasons to take the object again, if it is not in the hand firmly

HeldMotion: TypeAlias = Callable[[HeldObject], MotionReport]
PlanListener: TypeAlias = Callable[[str, str | None, RankedGrasps, Grasp | None], None]


class PickAndPlace:
    """Grasps objects with a robot, lifts them, hands them over and puts them back."""

    def __init__(self, world: World, robot: Robot, vision: ObjectDetector, *, seed: int) -> None:
        self.world, self.robot = world, robot
        #: the object in the hand, with its grasp; None when it is empty
        self.in_hand: HeldObject | None = None
        #: called, if not None, before each closing of the gripper, with the name of the object, the
        #: part to grasp it by, the last grasp plan, and the selected grasp
        self.on_plan: PlanListener | None = None
        self._motion, self._vision = HandMotion(robot, vision), vision
        self._rng = np.random.default_rng(seed)
        #: returns the parts by one of which something in the way may be taken and put aside (None
        #: for any); none until somebody says so
        self.movable: Callable[[Percept], Collection[str | None]] = lambda _: ()
        self._task = GraspAttempts("", None)
        self._wanted: set[str] = set()  # names of all that was to be taken for the task
        self._put_aside, self._barred_by = tuple[str, ...](), tuple[str, ...]()  # kinds
        self._is_interrupted = False  # since the last motion, which left the arm where it was

    @property
    def holding(self) -> str | None:
        """The name of the object in the hand; None when it is empty."""
        return self.in_hand.name if self.in_hand else None

    @property
    def held(self) -> Percept | None:
        """The object in the hand, as it was seen before it was grasped; None when it is empty."""
        return self.in_hand.context.percept if self.in_hand else None

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the hand on an object, by this part only; None leaves the choice to the hand.

        An object that the hand holds by this part already is kept.
        """
        return self._moved("grasp", lambda: self._take(percept, part))

    def lift(self) -> MotionReport:
        """Lift the held object and hold it for a second; grasp it again when it slips."""
        return self._act("lift", self._lift)

    def hand_over(self) -> MotionReport:
        """Bring the held object to the receiver, its free part first; retry when it is lost."""
        return self._act(
            "hand_over", lambda held: self._retry(held, self._hand_over, self._grasp_and_lift)
        )

    def put_back(self) -> MotionReport:
        """Put the held object back where it was taken up, and let it go."""
        return self._act("put_back", lambda held: self._put(held, "put_back"))

    def put_down(self) -> MotionReport:
        """Put the held object on the nearest free place of the table, and let it go."""
        return self._act("put_down", lambda held: self._put(held, "put_down"))

    def release(self) -> MotionReport:
        """Open the hand, once the receiver pulls at what was handed over, and go home."""
        return self._act("release", self._let_go)

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at an object without touching it; a held one is put back before."""
        return self._moved("point_at", lambda: self._point_at(percept))

    def _act(self, action: str, act: HeldMotion) -> MotionReport:
        if (held := self.in_hand) is None:
            return MotionReport(action, ok=False, reason="nothing_held")
        return self._moved(action, lambda: act(held))

    def _moved(self, action: str, move: Callable[[], MotionReport]) -> MotionReport:
        self._put_aside = ()
        try:
            return move()
        except MotionInterruptedError:
            if self.in_hand and not self.robot.is_holding:
                self.in_hand = None
            self._is_interrupted = True
            return self._report(action, "interrupted")

    def _report(self, action: str, reason: str, *, held_s: float = 0.0) -> MotionReport:
        held = self.in_hand
        slip_m, slip_rad = held.slip if held else (0.0, 0.0)
        return MotionReport(
            action,
            ok=not reason,
            reason=reason,
            touched=self._motion.touched(held) if held else (),
            lifted_m=self._motion.height_gained(held) if held else 0.0,
            held_s=held_s,
            attempts=len(self._task.tried),
            failures=self._task.failures,
            score=held.path.grasp.score if held else 0.0,
            slip_m=slip_m,
            slip_rad=slip_rad,
            moved=self._put_aside,
            barred_by=self._barred_by if reason == "blocked" else (),
        )

    def _take(self, percept: Percept, part: str | None) -> MotionReport:
        if self.robot.kind.gripper is None:
            return MotionReport("grasp", ok=False, reason="no_gripper")
        if self._keeps(percept, part):
            return self._report("grasp", "")
        self._clear_hand()
        self._task = GraspAttempts(percept.name, part)
        self._wanted = {percept.name}
        return self._grasp()

    def _put(self, held: HeldObject, action: str) -> MotionReport:
        put = self._motion.put_back if action == "put_back" else self._motion.put_down
        if not (reason := put(held)):
            self.in_hand = None
        return self._report(action, reason)

    def _put_away(self, held: HeldObject) -> None:
        is_held = self.robot.is_holding
        if not is_held or not (self._put(held, "put_back").ok or self._put(held, "put_down").ok):
            self._drop(held)

    def _clear_hand(self) -> None:
        if self.in_hand:
            self._put_away(self.in_hand)
        if self._is_interrupted:
            points = self._vision.obstacles("")
            planner = PathPlanner(self.robot, points, points)
            self._motion.release(planner, self.robot.gripper.opening)
        self._is_interrupted = False

    def _point_at(self, percept: Percept) -> MotionReport:
        self._clear_hand()
        if (context := self._observe(percept.name, None)) is None:
            return MotionReport("point_at", ok=False, reason="nothing_seen")
        planner = PathPlanner(self.robot, context.scene, context.obstacles)
        reason = self._motion.point_at(context.percept.cloud, planner)
        return MotionReport("point_at", ok=not reason, reason=reason)

    def _let_go(self, held: HeldObject) -> MotionReport:
        if not held.is_offered:
            return self._drop(held)
        if not (is_taken := self._motion.give(held)) and self.robot.is_holding:
            return self._report("release", "not_taken")
        return replace(self._drop(held), taken=is_taken)

    def _drop(self, held: HeldObject) -> MotionReport:
        self._motion.release(held.planner, held.path.grasp.opening)
        self.in_hand = None
        return self._report("release", "")

    def _keeps(self, percept: Percept, part: str | None) -> bool:
        held = self.in_hand
        if held is None or held.name != percept.name or part not in {None, held.context.part}:
            return False
        if not self._is_interrupted:
            self._task = GraspAttempts(percept.name, part)
        self._is_interrupted = False
        return True

    def _observe(self, name: str, part: str | None) -> GraspContext | None:
        if (percept := self._vision.find(name)) is None:
            return None
        kind = self._vision.kinds[percept.object]
        return GraspContext(percept, kind, part, self._vision.obstacles(name))

    def _grasp(self) -> MotionReport:
        reason = "nothing_seen"
        while not self._task.is_given_up:
            context = self._observe(self._task.name, self._task.part)
            if context is None or not len(context.target):
                break
            planner = PathPlanner(self.robot, context.scene, context.obstacles)
            plan, path, reason = select_grasp(self._task, context, planner, rng=self._rng)
            if self.on_plan:
                self.on_plan(self._task.name, self._task.part, plan, path.grasp if path else None)
            if path is None and self._make_room(context, planner):
                continue
            if path is None:
                reason = "blocked" if self._barred_by and reason != "too_wide" else reason
                break
            if not (reason := self._close_on(path, context, planner)):
                break
            self._task = replace(self._task, failures=(*self._task.failures, reason))
            self._motion.release(planner, path.grasp.opening)
            self.in_hand = None
        return self._report("grasp", reason)

    def _make_room(self, context: GraspContext, planner: PathPlanner) -> bool:
        """Put something in the way aside, or what is in its way; return whether that was done."""
        done, ways = self._put_aside, self._barring(context, planner)
        for other in dict.fromkeys(chain(*ways)):
            for part in self.movable(other) if other.name not in self._wanted else ():
                if self._put_aside == done and len(done) < MAX_MOVED:
                    self._move_aside(other, part)
        self._barred_by = tuple(each.object for each in next(iter(ways), ()))
        return self._put_aside != done

    def _barring(self, context: GraspContext, planner: PathPlanner) -> list[list[Percept]]:
        """Return what bars each of some grasps, the fewest first, then what touches the object."""
        alone, loose = replace(context, neighbours=context.neighbours[:0]), self.world.loose
        free = replace(planner, scene=alone.scene, obstacles=alone.neighbours, table=-np.inf)
        rest = [p for p in self._vision.percepts if p.name in loose and p != context.percept]
        rest.sort(key=lambda percept: -percept.cloud[:, 2].max())
        clouds = {p: replace(alone, neighbours=p.cloud).obstacles for p in rest}
        near = {p: replace(free, obstacles=points) for p, points in clouds.items()}
        cloud, ways = alone.labelled_cloud(planner.table), list[list[Percept]]()
        grasps = plan_grasps(cloud, self.robot.gripper, rng=self._rng).grasps if rest else ()
        for path in islice(free.grasp_paths(grasps), WAYS):
            way, opening = np.vstack([path.approach, path.lift]), path.grasp.opening
            ways.append([p for p in rest if not near[p].is_clear(way, opening, gap=ROOM)])
        gaps = (np.linalg.norm(clouds[p][:, None] - free.scene, axis=-1) for p in rest)
        touching = [p for p, gap in zip(rest, gaps, strict=True) if gap.min() < TOUCHING]
        return [each for each in (*sorted(ways, key=len), touching) if each]

    def _move_aside(self, other: Percept, part: str | None) -> None:
        self._wanted.add(other.name)
        task, self._task = self._task, GraspAttempts(other.name, part)
        if self._grasp_and_lift().ok and self.in_hand and self._put(self.in_hand, "put_down").ok:
            self._put_aside += (other.object,)
        self._clear_hand()
        self._task = task

    def _close_on(self, path: GraspPath, context: GraspContext, planner: PathPlanner) -> str:
        try:
            self._motion.grasp(path, force=context.force)
        except MotionInterruptedError:
            if self.robot.is_holding:
                self.in_hand = self._motion.held_object(context, planner, path)
            raise
        self._task = replace(self._task, tried=(*self._task.tried, path.grasp))
        if not self.robot.is_holding:
            return "missed"
        held = self._motion.held_object(context, planner, path)
        if not {*self._motion.touched(held, context.neighbours)} <= {*context.allowed_parts}:
            return "wrong_part"
        self.in_hand = held
        return ""

    def _retry(
        self, held: HeldObject, act: HeldMotion, recover: Callable[[], MotionReport]
    ) -> MotionReport:
        report = act(held)
        while report.reason in LOST:
            report = replace(report, failures=(*self._task.failures, report.reason))
            self._task = replace(self._task, failures=report.failures)
            self._put_away(self.in_hand or held)
            if self._task.is_given_up:
                break
            recovered = recover()
            if not recovered.ok or self.in_hand is None:
                return replace(report, attempts=recovered.attempts, failures=recovered.failures)
            report = act(self.in_hand)
        return report

    def _lift(self, held: HeldObject) -> MotionReport:
        return self._retry(held, self._lift_once, self._grasp)

    def _lift_once(self, held: HeldObject) -> MotionReport:
        gained = self._motion.height_gained(held)
        rest = LIFT_HEIGHT if gained < RAISED else max(0.0, LIFT_HEIGHT - gained)
        if rest and not self._motion.lift(held, rest):
            return self._report("lift", "slipped")
        report = self._hold(held, "lift", HOLD_TIME)
        if report.ok and report.lifted_m < MIN_LIFT:
            return replace(report, ok=False, reason="slipped")
        return report

    def _hold(self, held: HeldObject, action: str, seconds: float) -> MotionReport:
        is_lost = self._motion.loss_check()
        for done in range(round(seconds / TIME_STEP)):
            self.robot.advance(1)
            if is_lost():
                return self._report(action, "dropped", held_s=done * TIME_STEP)
        self.in_hand = held = self._motion.seen(held)
        is_loose = bool(np.greater(held.slip, (MAX_SLIP, MAX_TURN)).any())
        return self._report(action, "slipped" if is_loose else "", held_s=seconds)

    def _grasp_and_lift(self) -> MotionReport:
        grasped = self._grasp()
        return self._lift(self.in_hand) if self.in_hand else grasped

    def _hand_over(self, held: HeldObject) -> MotionReport:
        if reason := self._motion.hand_over(held):
            return self._report("hand_over", reason)
        report = self._hold(held, "hand_over", OFFER_TIME)
        grip = self.robot.world_from_grip
        at = (*grip[:3, 3].tolist(), *poses.quaternion(grip[:3, :3]))
        self.in_hand = held = replace(self.in_hand or held, is_offered=report.ok)
        facing_rad, clearance_m = self._motion.offered(held)
        offered = replace(report, at=at, facing_rad=facing_rad, clearance_m=clearance_m)
        return offered if report.ok else report
