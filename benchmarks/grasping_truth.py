"""What really happened in a grasping episode: the judge of what the robot reports.

The robot judges by sight and touch only; this reads poses and contacts of the simulator.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np

from hilt.sim import poses
from hilt.sim.body import Body
from hilt.sim.manipulation.hand_motions import AHEAD, TAKEN
from hilt.sim.manipulation.pick_and_place import MAX_SLIP, MAX_TURN, MIN_LIFT
from hilt.sim.robot.robot import MIN_FORCE, NAME, Robot

BUMP = 0.01  # [m], a neighbour that moved more was bumped
LOST_GAP = 0.05  # [m], what is farther from where the receiver's hand should be was lost


@dataclass(frozen=True)
class Lift:
    """Where the object was in the world and in the hand after it had been lifted and held.

    Attributes:
        height_m: above where it lay [m].
        slip_m: movement at the grip since the fingers closed [m].
        slip_rad: turn in the hand since then [rad].
        touched: the parts of it that the fingers touch.
    """

    height_m: float
    slip_m: float
    slip_rad: float
    touched: tuple[str, ...]

    def is_good(self, allowed: Collection[str]) -> bool:
        """Whether it is held high and firmly, by allowed parts only."""
        is_firm = self.slip_m <= MAX_SLIP and self.slip_rad <= MAX_TURN
        is_right = bool(self.touched) and {*self.touched} <= {*allowed}
        return is_firm and is_right and self.height_m >= MIN_LIFT


class GroundTruth:
    """Watches an episode in which a body grasps one object."""

    def __init__(self, body: Body, name: str, allowed: Collection[str]) -> None:
        self._body, self._name, self._allowed = body, name, {(name, part) for part in allowed}
        self._before = {each: body.world.pose(each) for each in body.world.kinds}
        self._aim, self._at_closing = "", np.eye(4)
        self._closed: list[frozenset[tuple[str, str]]] = []  # what closings held and touched
        body.on_plan = self._plan
        self._close, body.robot.close = body.robot.close, self._closing

    @property
    def closed(self) -> int:
        """The number of closings on anything."""
        return len(self._closed)

    @property
    def wrong(self) -> int:
        """The number of closings on something other than allowed parts."""
        return sum(not touched <= self._allowed for touched in self._closed)

    def lift(self) -> Lift:
        """What can be said of the object in the hand now."""
        touched = frozenset().union(*finger_contacts(self._body.robot))
        now = poses.inverse(self._body.robot.world_from_hand) @ self._body.world.pose(self._name)
        motion, grip = now @ poses.inverse(self._at_closing), self._body.robot.hand_from_grip
        moved = poses.transform(motion, grip[None, :3, 3]) - grip[:3, 3]
        return Lift(
            float((self._body.world.pose(self._name) - self._before[self._name])[2, 3]),
            float(np.linalg.norm(moved)),
            float(poses.angle_between(np.eye(3), motion[:3, :3])),
            tuple(sorted({part for name, part in touched if name == self._name})),
        )

    def bumped(self, put_aside: Collection[str]) -> tuple[str, ...]:
        """The neighbours that were moved, and not put aside on purpose."""
        world = self._body.world
        rest = {n for n, kind in world.kinds.items() if kind.name not in put_aside} - {self._name}
        gaps = {n: np.linalg.norm((world.pose(n) - self._before[n])[:3, 3]) for n in rest}
        return tuple(sorted(name for name, gap in gaps.items() if gap > BUMP))

    def release(self) -> bool:
        """Let the hand release the object; whether the receiver has it then."""
        held, robot = self._body.in_hand, self._body.robot
        if held is None:
            return False
        grip = robot.hand_from_grip[:3, 3] + held.free
        start = poses.transform(robot.world_from_hand, grip[None])
        object_from_world = poses.inverse(self._body.world.pose(self._name))
        said = self._body.release().taken
        after = poses.transform(self._body.world.pose(self._name) @ object_from_world, start)
        lost = np.linalg.norm((after - start)[0] - TAKEN * np.array(AHEAD)) > LOST_GAP
        return said and not lost

    def _plan(self, name: str, *_: object) -> None:
        self._aim = name

    def _closing(self, force: float = np.inf) -> None:
        self._close(force)
        sides = finger_contacts(self._body.robot)
        if self._aim == self._name and all(sides):
            self._closed.append(sides[0] | sides[1])
            hand = poses.inverse(self._body.robot.world_from_hand)
            self._at_closing = hand @ self._body.world.pose(self._name)


def finger_contacts(robot: Robot) -> list[frozenset[tuple[str, str]]]:
    """Return the bodies and links that each finger touches."""
    found = (robot.engine.bodies.contacts(NAME, link) for link in robot.gripper.links)
    return [
        frozenset((c.other, c.other_link) for c in each if c.force > MIN_FORCE and c.other != NAME)
        for each in found
    ]
