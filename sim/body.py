# SPDX-License-Identifier: Apache-2.0
"""The robot's body: vision, one arm with a hand, and the world it acts in.

It searches for features, takes objects by the part it is told, lifts, hands over, puts down, points
and strikes. It knows nothing of rules: which object and which part is decided elsewhere. Every
motion returns a `MotionReport`: a motion that fails is tried again with another grasp where that
can help, and what cannot be done is reported without trying it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from contextlib import AbstractContextManager
from hashlib import sha256
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ..ontology.errors import MotionInterruptedError
from ..ontology.objects import ObjectType
from .manipulation.hand_motions import HandMotion
from .manipulation.motion_report import MotionReport
from .manipulation.pick_and_place import LIFT_HEIGHT, PickAndPlace
from .manipulation.striking import Striking
from .robot.interruption import Interruption
from .robot.models import find_robot
from .robot.robot import Robot
from .scene.scene import Scene
from .scene.world import SleepManager, World
from .vision.percept import Percept, visible_features
from .vision.perception_noise import NoiseLevels
from .vision.vision_backends import CachedVision, open_vision

if TYPE_CHECKING:
    from .media.recording import WorldRecorder

HAND_ABILITIES = {"graspObject", "moveTo", "handOver", "moveAbove", "raise", "lower"}
TABLE_HEIGHT = 0.0  # [m]
RECEIVER = (1.15, 0.0, 0.40)  # [m], the person who receives objects sits across the table
MEETING = (0.58, 0.0, 0.40)  # [m], where objects are handed over


class Body(AbstractContextManager["Body"]):
    """A robot at a table with the objects of a scene.

    Use it in a `with` block, or `close` it.

    Args:
        scene: what is on the table.
        objects: the object types there are.
        seed: from which all choices of the motions are drawn.
        gui: whether to show a window.
        robot: its name in `robots.yaml`.
        vision: where percepts come from: "mask", "learned" or "learned:FILE".
        noise: of the cameras' depths; none when None.
        interruption: pauses or ends motions from another thread; a motion that is ended reports
            "interrupted".

    Attributes:
        world: the table, the objects, and time.
        vision: where percepts come from.
        robot: the arm and its hand.
        pick_and_place: grasps objects and hands them over.
        striking: drives nails with the held object.
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
        noise: NoiseLevels | None = None,
        interruption: Interruption | None = None,
    ) -> None:
        kind = find_robot(robot)
        self.world = World.build(scene, objects, gui=gui)
        self.vision = open_vision(self.world, source=vision, noise=noise)
        sleeping = SleepManager(self.world)
        self.interruption = interruption or Interruption()
        self.robot = Robot(
            self.world.engine, kind, step=sleeping.step, interruption=self.interruption
        )
        receiver, meeting = np.array(RECEIVER), np.array(MEETING)
        motion = HandMotion(self.robot, table=TABLE_HEIGHT, receiver=receiver, meeting=meeting)
        self._vision = CachedVision(self.world, self.vision)
        self.pick_and_place = PickAndPlace(self.world, motion, self._vision, sleeping, seed=seed)
        self.striking = Striking(self.world, self.pick_and_place)

    def close(self) -> None:
        """Stop the simulator."""
        self.world.close()

    def __exit__(self, *_: object) -> None:
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

    @property
    def held(self) -> Percept | None:
        """The object in the hand, as it was seen before it was grasped; None when it is empty."""
        held = self.pick_and_place.held
        return held.context.percept if held else None

    # --- seeing -------------------------------------------------------------------------------

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """Return the objects in view that have one of the features ("object:knife"), surest first.

        An object in the hand is known as it was seen before, also where vision misses it now.
        """
        found = self._vision.search(features)
        held = self.pick_and_place.held
        if held is None:
            return found
        is_missed = all(percept.name != held.name for percept in found)
        is_wanted = not visible_features(held.context.kind).isdisjoint(features)
        return (*found, held.context.percept) if is_missed and is_wanted else found

    def picture(self, path: Path) -> Path:
        """Write a picture of the scene as it is now, and return the path."""
        from .media.pictures import save_picture, take_picture

        save_picture(take_picture(self.world.engine), path)
        return path

    def record(self, path: Path) -> WorldRecorder:
        """Return a recorder of everything that happens inside its `with` block."""
        from .media.recording import WorldRecorder

        return WorldRecorder(self.world, path)

    def state_hash(self) -> str:
        """Return a hash of all poses, the joints of the arm, and the time that has passed.

        Two runs with the same hash do not differ in the last bit of any of these numbers.
        """
        numbers = [self.world.pose(name) for name in self.world.kinds]
        numbers += [self.robot.joints, np.array(self.world.engine.steps)]
        return sha256(b"".join(each.tobytes() for each in numbers)).hexdigest()[:16]

    # --- taking and giving --------------------------------------------------------------------

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Close the hand on an object, by this part only; None leaves the choice to the hand."""
        return self._moved("grasp", lambda: self.pick_and_place.grasp(percept, part))

    def lift(self, height_m: float = LIFT_HEIGHT) -> MotionReport:
        """Lift the held object from the table and hold it for a second."""
        return self._moved("lift", lambda: self.pick_and_place.lift(height_m))

    def hold(self, seconds: float) -> MotionReport:
        """Stand still with the held object."""
        return self._moved("hold", lambda: self.pick_and_place.hold(seconds))

    def hand_over(self) -> MotionReport:
        """Bring the held object to the receiver, its free part first, and hold it there."""
        return self._moved("hand_over", self.pick_and_place.hand_over)

    def put_back(self) -> MotionReport:
        """Put the held object back where it was taken up, and let it go."""
        return self._moved("put_back", self.pick_and_place.put_back)

    def put_down(self) -> MotionReport:
        """Put the held object on the nearest free place of the table, and let it go."""
        return self._moved("put_down", self.pick_and_place.put_down)

    def release(self) -> MotionReport:
        """Open the hand where it is, and go back to the waiting posture."""
        return self._moved("release", self.pick_and_place.release)

    def _moved(self, action: str, move: Callable[[], MotionReport]) -> MotionReport:
        """The report of a motion, also of one that is ended while it runs."""
        try:
            return move()
        except MotionInterruptedError:
            return self.pick_and_place.interrupted(action)

    # --- pointing and striking ----------------------------------------------------------------

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at an object without touching it."""
        return self._moved("point_at", lambda: self.pick_and_place.point_at(percept))

    def move_above(self, percept: Percept) -> MotionReport:
        """Bring the held object above one that is to be driven in, a face of it downwards."""
        return self._moved("move_above", lambda: self.striking.move_above(percept))

    def raise_(self) -> MotionReport:
        """Bring the held object back above what it strikes, ready for a blow."""
        return self._moved("raise", self.striking.raise_)

    def lower(self) -> MotionReport:
        """Strike once; the report says how deep the target is in."""
        return self._moved("lower", self.striking.lower)
