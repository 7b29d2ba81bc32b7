# SPDX-License-Identifier: Apache-2.0
"""The body of the agent: eyes, one arm and a hand, in a simulated world.

It searches for features, takes things by the part it is told, lifts them, gives them, puts them
back and points at them. It knows nothing of rules: which thing and which part is decided
elsewhere. Every motion ends in a `MotionReport`; a motion that fails is tried again with another
grasp where that can help, and what cannot be done is said and not tried.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING, TypeAlias

import numpy as np

from ..ontology.objects import ObjectType
from . import poses
from .camera import View
from .eyes import open_eyes
from .grasp import Grasp, GraspPlan, plan_grasps
from .motion import Held, Touch
from .noise import Noise
from .percept import Percept, visible_features
from .poses import Array
from .reach import Reach, Reacher
from .report import MotionReport
from .resting import Resting
from .robot import Robot
from .robots import find_robot
from .scene import Scene
from .sight import Sight
from .striking import StrikingMotion
from .world import World

if TYPE_CHECKING:
    from .recording import Recorder

TABLE_HEIGHT = 0.0  # [m]
LIFT_HEIGHT = 0.15  # [m]
LEAST_LIFT = 0.10  # [m], less is not lifted
HOLD_TIME = 1.0  # [s], after a lift
OFFER_TIME = 0.5  # [s], at the receiver
MAX_ATTEMPTS = 3  # how often the hand closes for one thing
# Efforts of plans, and the scores from which on a grasp is good enough not to make the next one:
# where little effort finds no way, or only to a poor grasp, more may find a better one.
EFFORTS = {1: 0.5, 2: 0.3, 4: 0.0}
BUMP = 0.01  # [m], a neighbour that moved more was bumped
LOST = {"slipped", "dropped"}  # reasons that mean: the thing is not in the hand any more
SAME_PLACE = 0.015  # [m], a grasp so near to one that failed is not tried again
RECEIVER = (1.15, 0.0, 0.40)  # [m], the one who gets things sits across the table
MEETING = (0.58, 0.0, 0.40)  # [m], where things are handed over
HAND_ABILITIES = {"graspObject", "moveTo", "handOver", "moveAbove", "raise", "lower"}
AFTER_BLOW = 0.15  # [s], until all is quiet
IN = 0.003  # [m], what lacks less is in all the way
TOP = 0.0015  # [m], what is so little below the highest point is the top


Onlooker: TypeAlias = Callable[[str, str | None, GraspPlan, Grasp | None], None]


@dataclass(frozen=True)
class _Aim:
    """What the hand is after, and how often it has closed for it."""

    name: str
    part: str | None
    attempts: int = 0
    tried: tuple[Grasp, ...] = ()
    failures: tuple[str, ...] = ()

    def closed_on(self, grasp: Grasp) -> _Aim:
        """The same when the hand has closed once more."""
        return replace(self, attempts=self.attempts + 1, tried=(*self.tried, grasp))

    def failed(self, reason: str) -> _Aim:
        """The same when that was in vain."""
        return replace(self, failures=(*self.failures, reason))


class Body:
    """A robot at a table with the things of a scene.

    Use it in a `with` block, or `close` it.

    Args:
        scene: what is on the table.
        objects: the types there are.
        seed: from which all choices of the motions are drawn.
        gui: whether to show a window.
        robot: which one; see `robots.yaml`.
        eyes: where percepts come from; see `eyes`.
        noise: of the cameras' depths; none when None.

    Attributes:
        onlooker: called while it is not None before each closing of the hand: name of the thing,
            the part it must be taken by, the last plan of grasps, and the grasp that is taken.
    """

    def __init__(
        self,
        scene: Scene,
        objects: Mapping[str, ObjectType],
        *,
        seed: int,
        gui: bool = False,
        robot: str = "panda",
        eyes: str = "mask",
        noise: Noise | None = None,
    ) -> None:
        kind = find_robot(robot)
        self.world = World.build(scene, objects, gui=gui)
        self._resting = Resting(self.world.engine, self._loose())
        self.robot = Robot(self.world.engine, kind, step=self._step)
        self.vision = open_eyes(self.world, source=eyes, noise=noise)
        self.motion = StrikingMotion(
            self.robot,
            table=TABLE_HEIGHT,
            receiver=np.array(RECEIVER),
            meeting=np.array(MEETING),
        )
        self.onlooker: Onlooker | None = None
        self._rng = np.random.default_rng(seed)
        self._held: Held | None = None
        self._sight: Sight | None = None
        self._aim = _Aim("", None)
        self._places: dict[str, Array] = {}
        self._struck: str | None = None
        self._target, self._depth_seen = np.zeros(3), 0.0
        self._views: tuple[View, ...] = ()
        self._seen_at = -1

    def close(self) -> None:
        """Stop the simulator."""
        self.world.close()

    def __enter__(self) -> Body:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    @property
    def abilities(self) -> frozenset[str]:
        """The primitives of the action trees that it can perform."""
        hand = HAND_ABILITIES if self.robot.kind.gripper else set[str]()
        return frozenset({"findObject", "pointAt", *hand})

    @property
    def holding(self) -> str | None:
        """The name of the thing in the hand; None when it is empty."""
        return self._held.name if self._held else None

    # --- seeing -------------------------------------------------------------------------------

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """The things in view that have one of the features ("object:knife"), the surest first.

        What is in the hand is known as it was seen there, also where the eyes do not tell it apart.
        """
        found = self.vision.search(features, views=self._look())
        if self._held is None or self._sight is None:
            return found
        name, kind = self._held.name, self._sight.kind
        is_missed = all(percept.name != name for percept in found)
        is_wanted = not visible_features(kind).isdisjoint(features)
        return (*found, self._sight.percept) if is_missed and is_wanted else found

    def picture(self, path: Path) -> Path:
        """Write a picture of the scene as it is now; gives the path back."""
        from .pictures import save_picture, take_picture

        save_picture(take_picture(self.world.engine), path)
        return path

    def record(self, path: Path) -> Recorder:
        """A recorder of all that happens inside its `with` block."""
        from .recording import Recorder

        return Recorder(self.world, path)

    # --- acting -------------------------------------------------------------------------------

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
        self._aim = _Aim(percept.name, part)
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

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at a thing without touching it."""
        if self._held:
            self.put_back()
        sight = self._see(percept.name, None)
        if sight is None:
            return MotionReport("point_at", ok=False, reason="nothing_seen")
        reason = self.motion.point_at(sight.percept.cloud, self._reacher(sight))
        return MotionReport("point_at", ok=not reason, reason=reason)

    def move_above(self, percept: Percept) -> MotionReport:
        """Bring what is held above a thing that is to be driven in, a face of it downwards."""
        if self._held is None or self._sight is None:
            return MotionReport("move_above", ok=False, reason="nothing_held")
        if self.world.support(percept.name) is None:
            return self._report("move_above", "nothing_to_strike")
        self._struck = percept.name
        self._depth_seen = self.world.depth(percept.name)
        self._target = top_of(percept.cloud)
        return self._report(
            "move_above",
            self.motion.move_above(
                self._held, self._target, self._reacher(self._sight), self._sight.percept.cloud
            ),
        )

    def raise_(self) -> MotionReport:
        """Bring what is held back above what it strikes, ready for a blow."""
        if self._held is None or self._sight is None or self._struck is None:
            return MotionReport("raise", ok=False, reason="nothing_held")
        reacher, cloud = self._reacher(self._sight), self._sight.percept.cloud
        return self._report("raise", self.motion.poise(self._held, self._aim_at(), reacher, cloud))

    def lower(self) -> MotionReport:
        """Strike once. What is in all the way was struck well, also where that costs the hold."""
        if self._held is None or self._sight is None or self._struck is None:
            return MotionReport("lower", ok=False, reason="nothing_held")
        reason = self.motion.blow(self._held, self._aim_at(), self._reacher(self._sight))
        self.robot.wait(AFTER_BLOW)
        report = self._report("lower", reason)
        if reason not in LOST:
            return report
        self._release()
        return replace(report, ok=True, reason="") if report.driven else report

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
        while self._aim.attempts < MAX_ATTEMPTS:
            sight = self._see(self._aim.name, self._aim.part)
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
        plan, reason, best = GraspPlan((), {}), "", None
        surroundings = sight.surroundings(TABLE_HEIGHT)
        for effort, enough in EFFORTS.items():
            plan = plan_grasps(surroundings, self.robot.gripper, rng=self._rng, effort=effort)
            fresh = [grasp for grasp in plan.grasps if not self._has_failed(grasp)]
            reach = next(self._reacher(sight).ways_to(fresh, lift=LIFT_HEIGHT), None)
            if best is None or (reach and reach.grasp.score > best.grasp.score):
                best = reach
            reason = "unreachable" if plan.grasps else plan.reason or "no_grasp"
            if best is not None and best.grasp.score >= enough:
                break
        if self.onlooker:
            self.onlooker(self._aim.name, self._aim.part, plan, best.grasp if best else None)
        if best is not None:
            return "", best
        return (reason if self._reacher(sight).reaches(sight.wanted) else "unreachable"), None

    def _has_failed(self, grasp: Grasp) -> bool:
        at = grasp.world_from_grip[:3, 3]
        return any(
            float(np.linalg.norm(at - other.world_from_grip[:3, 3])) < SAME_PLACE
            for other in self._aim.tried
        )

    def _take(self, reach: Reach, sight: Sight) -> tuple[str, Touch]:
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
            if self._aim.attempts >= MAX_ATTEMPTS:
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

    def _look(self) -> tuple[View, ...]:
        """What the cameras see; the last views as long as no time has passed."""
        now = self.world.engine.steps
        if now != self._seen_at:
            self._views, self._seen_at = self.vision.look(), now
        return self._views

    def _see(self, name: str, part: str | None) -> Sight | None:
        kind = self.world.kinds.get(name)
        if kind is None:
            return None
        views = self._look()
        found = self.vision.search([f"object:{kind.name}"], views=views)
        percept = next((each for each in found if each.name == name), None)
        if percept is None:
            return None
        return Sight(percept, kind, part, self.vision.obstacles(name, views=views))

    def _reacher(self, sight: Sight) -> Reacher:
        return Reacher(self.robot, TABLE_HEIGHT, sight.everything, sight.others)

    def _aim_at(self) -> Array:
        """The top of what is struck: where it was seen, lower by as much as it has gone in."""
        depth = self.world.depth(self._struck) if self._struck else 0.0
        return self._target - (0, 0, depth - self._depth_seen)

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
            depth_m=self.world.depth(self._struck) if self._struck else 0.0,
            driven=self._struck is not None and self._is_in(self._struck),
        )

    def _is_in(self, name: str) -> bool:
        mount = self.world.kinds[name].mount
        return mount is not None and self.world.depth(name) > mount.deepest - IN

    def _bumped(self) -> tuple[str, ...]:
        """The neighbours that have moved since the hand went for its aim."""
        moved = {
            name: float(np.linalg.norm(self.world.pose(name)[:3, 3] - before[:3, 3]))
            for name, before in self._places.items()
            if name != self._aim.name
        }
        return tuple(name for name, distance in moved.items() if distance > BUMP)


def top_of(cloud: Array) -> Array:
    """The middle of the highest face of a cloud (n, 3) [m]."""
    top = float(cloud[:, 2].max())
    face = cloud[cloud[:, 2] > top - TOP]
    return np.array([*(face[:, :2].min(axis=0) + face[:, :2].max(axis=0)) / 2, top])
