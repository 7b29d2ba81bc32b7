# SPDX-License-Identifier: Apache-2.0
"""What the hand does with a thing: take it, raise it, carry it, give it, put it back, point at it.

`Motion` works on what was seen (clouds) and moves one robot. Whether it worked is judged by what
the fingers feel and by how high the thing is, never by what was intended. Nothing here raises when
a motion fails: the answer says so.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from .. import poses
from ..grasping.context import Sight
from ..grasping.point_clouds import thin
from ..grasping.scoring import GRAVITY
from ..physics.engine import TIME_STEP
from ..poses import Array
from ..robot.collision import on_hand
from ..robot.path_planner import FASTEST, Reach, Reacher
from ..robot.robot import Robot

TRANSIT_PACE = FASTEST  # shares of the joints' speed limits
APPROACH_PACE = 0.45
LIFT_PACE = 0.45
CARRY_PACE = FASTEST
CAREFUL_TORQUE = 0.25  # [N m], a thing that turns so much in the hand is carried at half the pace
FEEL_EVERY = 12  # steps between two looks at what the fingers feel
LOST_LOOKS = 2
HELD_CELL, HELD_RADIUS = 0.015, 0.008  # [m], spheres that stand for what is held
HELD_GAP = 0.006  # [m] between what is held and what is seen, on the way
RELEASE_HEIGHT = 0.003  # [m] above where it was taken up, a thing is let go
RELEASE_TIME = 0.4  # [s]
RETREAT = 0.08  # [m] the open hand goes back
POINTING_GAP = 0.05  # [m] between the finger tips and the thing pointed at
SHORTEST = 0.01  # [m], the free part's direction from the hand
HEADINGS = 24  # turns about the vertical that are tried for handing over
FACING = (-0.5, 0.0, 0.7, 0.9)  # cosines to the receiver; between two of them all are as good
REACH_ALONG = (0.0, -0.06, 0.06, -0.12)  # [m] nearer to or farther from the receiver


@dataclass(frozen=True)
class FingerContacts:
    """What the fingers feel.

    Attributes:
        first, second: (body, link) that the one and the other finger touch.
    """

    first: frozenset[tuple[str, str]]
    second: frozenset[tuple[str, str]]

    @property
    def both(self) -> frozenset[tuple[str, str]]:
        """All that is touched."""
        return self.first | self.second

    def holds(self, body: str) -> bool:
        """Whether both fingers touch this body."""
        return all(any(name == body for name, _ in side) for side in (self.first, self.second))

    def parts(self, body: str) -> tuple[str, ...]:
        """The links of this body that are touched."""
        return tuple(sorted({link for name, link in self.both if name == body}))


@dataclass(frozen=True)
class Held:
    """What is in the hand.

    Attributes:
        name: of the body.
        reach: how it was taken.
        world_from_start: where it lay (4, 4).
        hand_from_thing: how it lies in the hand since the hand closed (4, 4).
        points: (n, 3), its cloud in the frame of the hand [m].
        torque: with which its weight turns it in the hand when it lies level [N m].
        free: (3,), from the held part towards the rest of it, in the frame of the hand; zero
            when nothing of it is free.
    """

    name: str
    reach: Reach
    world_from_start: Array
    hand_from_thing: Array
    points: Array
    torque: float
    free: Array


class Motion:
    """Moves one robot among what was seen on a table.

    Args:
        robot: with a gripper.
        table: height of the table [m].
        receiver: where the one stands who gets things (3,) [m].
        meeting: where things are handed over (3,) [m].
    """

    def __init__(self, robot: Robot, *, table: float, receiver: Array, meeting: Array) -> None:
        self.robot, self.table = robot, table
        self.receiver, self.meeting = receiver, meeting

    # --- taking -------------------------------------------------------------------------------

    def take(self, reach: Reach) -> FingerContacts:
        """Go to a grasp, close the hand, and feel."""
        self.robot.open(reach.grasp.opening)
        self.robot.follow(reach.transit, pace=TRANSIT_PACE)
        self.robot.follow(reach.approach, pace=APPROACH_PACE)
        self.robot.close()
        return self.feel()

    def feel(self) -> FingerContacts:
        """What both fingers touch now."""
        first, second = (
            frozenset((contact.other, contact.other_link) for contact in side)
            for side in self.robot.felt()
        )
        return FingerContacts(first, second)

    def let_go(self, reacher: Reacher) -> None:
        """Open the hand and go back the way it came, then home."""
        self.robot.open(self.robot.gripper.opening)
        self.robot.wait(RELEASE_TIME)
        back = self.robot.world_from_grip @ poses.translation(0, 0, -RETREAT)
        self._follow_if(reacher.straight_to(back), APPROACH_PACE)
        self.go_home(reacher)

    def go_home(self, reacher: Reacher) -> None:
        """Go to where the arm waits, past everything if there is such a way."""
        home = self.robot.kind.home
        spheres = self.robot.body_spheres(self.robot.opening)
        path = reacher.transit(home, spheres, reacher.seen, gap=-1.0)
        self._follow_if(path, TRANSIT_PACE)

    # --- holding ------------------------------------------------------------------------------

    def raise_up(self, held: Held, height: float, reacher: Reacher) -> bool:
        """Go straight up by `height` [m] with what is held; False as soon as it is lost."""
        path = reacher.straight_up(height)
        if path is None:
            path = held.reach.lift
        return self.robot.follow(path, pace=LIFT_PACE, stop=self._loses(held.name))

    def hold_still(self, held: Held, seconds: float) -> float:
        """Stand still; how long the thing was held [s]."""
        steps, lost = round(seconds / TIME_STEP), self._loses(held.name)
        for step in range(steps):
            self.robot.advance(1)
            if lost():
                return step * TIME_STEP
        return steps * TIME_STEP

    def slip(self, held: Held) -> tuple[float, float]:
        """How far the thing has moved [m] and turned [rad] in the hand since the hand closed."""
        now = self._hand_from(held.name)
        moved = np.linalg.norm(now[:3, 3] - held.hand_from_thing[:3, 3])
        turned = poses.angle_between(now[:3, :3], held.hand_from_thing[:3, :3])
        return float(moved), float(turned)

    def height_gained(self, held: Held) -> float:
        """How far the thing is above where it lay [m]."""
        now = self.robot.engine.bodies.pose(held.name)
        return float(now[2, 3] - held.world_from_start[2, 3])

    def grip_on(self, name: str, reach: Reach, sight: Sight, before: Array) -> Held:
        """What is known of a thing once the hand has closed on it.

        Args:
            name: of the body.
            reach: how it was taken.
            sight: how it was seen.
            before: where the thing lay then (4, 4).
        """
        hand_from_world = poses.inverse(self.robot.world_from_hand)
        seen = hand_from_world @ self.robot.engine.bodies.pose(name) @ poses.inverse(before)
        grip = self.robot.gripper.hand_from_grip[:3, 3]
        rest = poses.transform(seen, sight.rest)
        cloud = poses.transform(seen, sight.percept.cloud)
        arm = poses.transform(seen, sight.balance[None])[0] - grip
        return Held(
            name,
            reach,
            before,
            self._hand_from(name),
            cloud[thin(cloud, HELD_CELL)],
            GRAVITY * sight.kind.mass * float(np.hypot(arm[0], arm[2])),
            rest.mean(axis=0) - grip if len(rest) else np.zeros(3),
        )

    # --- carrying -----------------------------------------------------------------------------

    def hand_over(self, held: Held, reacher: Reacher) -> str:
        """Carry what is held to the receiver; the reason why not, or an empty text."""
        for goal in self._offers(held, reacher):
            path = self._carry(held, goal, reacher)
            if path is None:
                continue
            return "" if self._follow_with(held, path) else "dropped"
        return "unreachable"

    def put_back(self, held: Held, reacher: Reacher) -> str:
        """Put what is held down where it lay; the reason why not, or an empty text."""
        at = held.reach.grasp.world_from_grip
        above = self._carry(held, held.reach.lift[-1], reacher)
        if above is None:
            return "unreachable"
        if not self._follow_with(held, above):
            return "dropped"
        self._follow_if(
            reacher.straight_to(poses.translation(0, 0, RELEASE_HEIGHT) @ at), APPROACH_PACE
        )
        self.let_go(reacher)
        return ""

    def _offers(self, held: Held, reacher: Reacher) -> Iterator[Array]:
        """Postures for handing over: the free part towards the receiver, then the nearest ones."""
        turns = poses.rotation_about((0, 0, 1), np.arange(HEADINGS) * 2 * np.pi / HEADINGS)
        towards = (self.receiver - self.meeting) * (1, 1, 0)
        towards /= np.linalg.norm(towards)
        rotations = turns @ self.robot.world_from_grip[:3, :3]
        facing = _unit(rotations @ held.free * (1, 1, 0)) @ towards
        worse = -np.digitize(facing, FACING)
        for shift in REACH_ALONG:
            for level in np.unique(worse):
                chosen = rotations[worse == level]
                answer = reacher.postures(poses.pose(chosen, self.meeting + shift * towards))
                reached = answer.joints[answer.found]
                yield from reached[np.argsort(reacher.travel(reached), kind="stable")]

    # --- pointing -----------------------------------------------------------------------------

    def point_at(self, cloud: Array, reacher: Reacher) -> str:
        """Point at a thing with closed fingers, or the hand where it has none, without touching it.

        The reason why not, or an empty text.
        """
        if self.robot.kind.gripper:
            self.robot.open(0.0)
        spheres = self.robot.body_spheres(0.0)
        for goal in self._pointing(cloud, reacher):
            path = reacher.transit(goal, spheres, reacher.seen, gap=POINTING_GAP / 2)
            if path is None:
                continue
            free = self.robot.follow(path, pace=TRANSIT_PACE, stop=self.robot.bumps)
            return "" if free else "bumped"
        return "unreachable"

    def _pointing(self, cloud: Array, reacher: Reacher) -> Iterator[Array]:
        """Postures in which the hand points at the middle of a cloud (n, 3)."""
        middle = cloud.mean(axis=0)
        down = poses.rotation_about((1, 0, 0), np.pi)
        lean = poses.rotation_about((0, 1, 0), np.radians((30.0, 45.0, 15.0, 0.0)))
        around = poses.rotation_about((0, 0, 1), np.arange(8) * np.pi / 4)
        rotations = (around[None] @ lean[:, None] @ down).reshape(-1, 3, 3)
        along = rotations[..., 2]
        # As far back as the nearest point of the thing along the way of the finger asks for.
        depth = np.min((cloud - middle) @ along.T, axis=0) - POINTING_GAP
        at = middle + (depth - self.robot.tip)[:, None] * along
        answer = reacher.postures(poses.pose(rotations, at))
        yield from answer.joints[answer.found]

    # --- helpers ------------------------------------------------------------------------------

    def _follow_with(self, held: Held, path: Array) -> bool:
        """Run through a path with what is held, the slower the more it would turn in the hand."""
        pace = CARRY_PACE / (1 + held.torque / CAREFUL_TORQUE)
        return self.robot.follow(path, pace=pace, stop=self._loses(held.name))

    def _follow_if(self, path: Array | None, pace: float) -> None:
        if path is not None:
            self.robot.follow(path, pace=pace)

    def _hand_from(self, name: str) -> Array:
        return poses.inverse(self.robot.world_from_hand) @ self.robot.engine.bodies.pose(name)

    def _carry(self, held: Held, goal: Array, reacher: Reacher) -> Array | None:
        """A way to a posture on which neither the arm nor what is held hits anything."""
        return reacher.transit(
            goal,
            self.robot.body_spheres(self.robot.opening),
            reacher.others,
            gap=HELD_GAP,
            held=on_hand(self.robot.chain, held.points, HELD_RADIUS),
        )

    def _loses(self, name: str) -> Callable[[], bool]:
        """A question for each step: is the thing gone? A contact may be missing for one look."""
        step = missing = 0

        def lost() -> bool:
            nonlocal step, missing
            step += 1
            if step % FEEL_EVERY == 0:
                missing = 0 if self.feel().holds(name) else missing + 1
            return missing >= LOST_LOOKS

        return lost


def _unit(vectors: Array) -> Array:
    """Vectors (n, 3) at unit length; what is too short to have a direction becomes zero."""
    length = np.linalg.norm(vectors, axis=1, keepdims=True)
    return np.where(length > SHORTEST, vectors / np.maximum(length, SHORTEST), 0.0)
