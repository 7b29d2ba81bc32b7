# SPDX-License-Identifier: Apache-2.0
"""The robot's body: vision, one arm with a hand, and the world it acts in.

It searches for features, takes objects by the part it is told, lifts, hands over, puts back, points
and strikes. It knows nothing of rules: which object and which part is decided elsewhere. Every
motion returns a `MotionReport`: a motion that fails is tried again with another grasp where that
can help, and what cannot be done is reported without trying it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

import numpy as np

from ..ontology.objects import ObjectType
from .manipulation.pick_and_place import LIFT_HEIGHT, LOST, PickAndPlace
from .manipulation.report import MotionReport
from .manipulation.striking import StrikingMotion
from .manipulation.target import StrikeTarget
from .robot.models import find_robot
from .robot.robot import Robot
from .scene.scene import Scene
from .scene.sleeping import SleepManager
from .scene.world import World
from .vision.gaze import Gaze
from .vision.noise import Noise
from .vision.percept import Percept, visible_features
from .vision.sensors import open_eyes

if TYPE_CHECKING:
    from .media.recording import Recorder

HAND_ABILITIES = {"graspObject", "moveTo", "handOver", "moveAbove", "raise", "lower"}
TABLE_HEIGHT = 0.0  # [m]
RECEIVER = (1.15, 0.0, 0.40)  # [m], the person who receives objects sits across the table
MEETING = (0.58, 0.0, 0.40)  # [m], where objects are handed over
AFTER_BLOW = 0.15  # [s], until everything is at rest


class Body:
    """A robot at a table with the objects of a scene.

    Use it in a `with` block, or `close` it.

    Args:
        scene: what is on the table.
        objects: the object types there are.
        seed: from which all choices of the motions are drawn.
        gui: whether to show a window.
        robot: name of the robot; see `robots.yaml`.
        vision: where percepts come from: "mask", "learned" or "learned:FILE".
        noise: of the cameras' depths; none when None.

    Attributes:
        world: the table, the objects, and time.
        vision: where percepts come from.
        robot: the arm and its hand.
        motion: moves them among what is seen.
        pick_and_place: takes objects and gives them.
    """

    def __init__(
        self,
        scene: Scene,
        objects: Mapping[str, ObjectType],
        *,
        seed: int,
        gui: bool = False,
        robot: str = "panda",
        vision: str = "mask",
        noise: Noise | None = None,
    ) -> None:
        kind = find_robot(robot)
        self.world = World.build(scene, objects, gui=gui)
        self.vision = open_eyes(self.world, source=vision, noise=noise)
        sleeping = SleepManager(self.world)
        self.robot = Robot(self.world.engine, kind, step=sleeping.step)
        self.motion = StrikingMotion(
            self.robot,
            table=TABLE_HEIGHT,
            receiver=np.array(RECEIVER),
            meeting=np.array(MEETING),
        )
        self._gaze = Gaze(self.world, self.vision)
        self.pick_and_place = PickAndPlace(
            self.world, self.robot, self.motion, self._gaze, sleeping, seed=seed
        )

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
        """The name of the object in the hand; None when it is empty."""
        held = self.pick_and_place.held
        return held.name if held else None

    # --- seeing -------------------------------------------------------------------------------

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """Return the objects in view that have one of the features ("object:knife"), surest first.

        An object in the hand is known as it was seen before, also where vision misses it now.
        """
        found = self._gaze.search(features)
        held, sight = self.pick_and_place.held, self.pick_and_place.sight
        if held is None or sight is None:
            return found
        is_missed = all(percept.name != held.name for percept in found)
        is_wanted = not visible_features(sight.kind).isdisjoint(features)
        return (*found, sight.percept) if is_missed and is_wanted else found

    def picture(self, path: Path) -> Path:
        """Write a picture of the scene as it is now, and return the path."""
        from .media.pictures import save_picture, take_picture

        save_picture(take_picture(self.world.engine), path)
        return path

    def record(self, path: Path) -> Recorder:
        """Return a recorder of everything that happens inside its `with` block."""
        from .media.recording import Recorder

        return Recorder(self.world, path)

    # --- taking and giving --------------------------------------------------------------------

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the hand on an object, by this part only; None leaves the choice to the hand."""
        return self.pick_and_place.grasp(percept, part)

    def lift(self, height_m: float = LIFT_HEIGHT) -> MotionReport:
        """Lift the held object from the table and hold it for a second."""
        return self.pick_and_place.lift(height_m)

    def hold(self, seconds: float) -> MotionReport:
        """Stand still with the held object."""
        return self.pick_and_place.hold(seconds)

    def hand_over(self) -> MotionReport:
        """Bring the held object to the receiver, its free part first, and hold it there."""
        return self.pick_and_place.hand_over()

    def put_back(self) -> MotionReport:
        """Put the held object back where it was taken up, and let it go."""
        return self.pick_and_place.put_back()

    # --- pointing and striking ----------------------------------------------------------------

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at an object without touching it."""
        if self.holding:
            self.put_back()
        sight = self._gaze.sight(percept.name, None)
        if sight is None:
            return MotionReport("point_at", ok=False, reason="nothing_seen")
        reacher = self.pick_and_place.reacher(sight)
        reason = self.motion.point_at(sight.percept.cloud, reacher)
        return MotionReport("point_at", ok=not reason, reason=reason)

    def move_above(self, percept: Percept) -> MotionReport:
        """Bring the held object above one that is to be driven in, a face of it downwards."""
        hand = self.pick_and_place
        if hand.held is None or hand.sight is None:
            return MotionReport("move_above", ok=False, reason="nothing_held")
        if self.world.support(percept.name) is None:
            return hand.report("move_above", "nothing_to_strike")
        hand.target = target = StrikeTarget(self.world, percept.name, percept.cloud)
        reacher, cloud = hand.reacher(hand.sight), hand.sight.percept.cloud
        reason = self.motion.move_above(hand.held, target.top, reacher, cloud)
        return hand.report("move_above", reason)

    def raise_(self) -> MotionReport:
        """Bring the held object back above what it strikes, ready for a blow."""
        hand = self.pick_and_place
        if hand.held is None or hand.sight is None or hand.target is None:
            return MotionReport("raise", ok=False, reason="nothing_held")
        reacher, cloud = hand.reacher(hand.sight), hand.sight.percept.cloud
        reason = self.motion.poise(hand.held, hand.target.top, reacher, cloud)
        return hand.report("raise", reason)

    def lower(self) -> MotionReport:
        """Strike once; driving the target in all the way counts as success, even if the grip fails.

        The report says how deep the target is in.
        """
        hand = self.pick_and_place
        if hand.held is None or hand.sight is None or hand.target is None:
            return MotionReport("lower", ok=False, reason="nothing_held")
        reason = self.motion.blow(hand.held, hand.target.top, hand.reacher(hand.sight))
        self.robot.wait(AFTER_BLOW)
        report = hand.report("lower", reason)
        if reason not in LOST:
            return report
        hand.release()
        return replace(report, ok=True, reason="") if report.driven else report
