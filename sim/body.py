# SPDX-License-Identifier: Apache-2.0
"""The body of the agent: eyes, one arm and a hand, in a simulated world.

It searches for features, takes things by the part it is told, lifts them, gives them, puts them
back and points at them. It knows nothing of rules: which thing and which part is decided
elsewhere. Every motion ends in a `MotionReport`; a motion that fails is tried again with another
grasp where that can help, and what cannot be done is said and not tried.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import TracebackType
from typing import TYPE_CHECKING

from ..ontology.objects import ObjectType
from .manipulation.pick_and_place import LOST, Handling
from .manipulation.report import MotionReport
from .manipulation.target import StrikeTarget
from .robot.models import find_robot
from .scene.scene import Scene
from .scene.world import World
from .vision.noise import Noise
from .vision.percept import Percept, visible_features
from .vision.sensors import open_eyes

if TYPE_CHECKING:
    from .media.recording import Recorder

HAND_ABILITIES = {"graspObject", "moveTo", "handOver", "moveAbove", "raise", "lower"}
AFTER_BLOW = 0.15  # [s], until all is quiet


class Body(Handling):
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
        world = World.build(scene, objects, gui=gui)
        super().__init__(world, kind, open_eyes(world, source=eyes, noise=noise), seed=seed)

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

    # --- seeing -------------------------------------------------------------------------------

    def search(self, features: Sequence[str]) -> tuple[Percept, ...]:
        """The things in view that have one of the features ("object:knife"), the surest first.

        What is in the hand is known as it was seen there, also where the eyes do not tell it apart.
        """
        found = self._gaze.search(features)
        if self._held is None or self._sight is None:
            return found
        name, kind = self._held.name, self._sight.kind
        is_missed = all(percept.name != name for percept in found)
        is_wanted = not visible_features(kind).isdisjoint(features)
        return (*found, self._sight.percept) if is_missed and is_wanted else found

    def picture(self, path: Path) -> Path:
        """Write a picture of the scene as it is now; gives the path back."""
        from .media.pictures import save_picture, take_picture

        save_picture(take_picture(self.world.engine), path)
        return path

    def record(self, path: Path) -> Recorder:
        """A recorder of all that happens inside its `with` block."""
        from .media.recording import Recorder

        return Recorder(self.world, path)

    # --- pointing and striking ----------------------------------------------------------------

    def point_at(self, percept: Percept) -> MotionReport:
        """Point at a thing without touching it."""
        if self._held:
            self.put_back()
        sight = self._gaze.sight(percept.name, None)
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
        self._target = StrikeTarget(self.world, percept.name, percept.cloud)
        reacher, cloud = self._reacher(self._sight), self._sight.percept.cloud
        reason = self.motion.move_above(self._held, self._target.top, reacher, cloud)
        return self._report("move_above", reason)

    def raise_(self) -> MotionReport:
        """Bring what is held back above what it strikes, ready for a blow."""
        if self._held is None or self._sight is None or self._target is None:
            return MotionReport("raise", ok=False, reason="nothing_held")
        reacher, cloud = self._reacher(self._sight), self._sight.percept.cloud
        reason = self.motion.poise(self._held, self._target.top, reacher, cloud)
        return self._report("raise", reason)

    def lower(self) -> MotionReport:
        """Strike once. What is in all the way was struck well, also where that costs the hold."""
        if self._held is None or self._sight is None or self._target is None:
            return MotionReport("lower", ok=False, reason="nothing_held")
        reason = self.motion.blow(self._held, self._target.top, self._reacher(self._sight))
        self.robot.wait(AFTER_BLOW)
        report = self._report("lower", reason)
        if reason not in LOST:
            return report
        self._release()
        return replace(report, ok=True, reason="") if report.driven else report
