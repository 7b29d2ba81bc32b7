# SPDX-License-Identifier: Apache-2.0
"""Striking with what is held: a face of it is brought above something, and comes down on it.

Which face, and how the hand must be turned for it, is found in `pounding`; here the arm moves. The
way down is straight, and aims below what is struck, so that the face is fast when it meets it.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import chain

import numpy as np

from .. import poses
from ..poses import Array
from ..robot.path_planner import Reacher
from ..robot.robot import NAME
from .motion import Held, Motion
from .pounding import StrikePose, hand_points, strikes

POISE = 0.07  # [m] above what is struck, a blow begins
THROUGH = (0.05, 0.02, 0.005)  # [m] below it, where a blow aims, to be fast when it strikes
BLOW_PACE, POISE_PACE = 0.9, 0.4
FELT_BLOW = 2.0  # [N]
FOLLOW_STEPS = 5  # for so long the hand goes on after it has struck
SAME_FACE = 0.6  # [rad]
AROUND = 8  # strikes for which a way round is sought


class StrikingMotion(Motion):
    """Motion of a robot that can also strike."""

    def move_above(self, held: Held, target: Array, reacher: Reacher, cloud: Array) -> str:
        """Bring a face of what is held above a point (3,) [m]; the reason why not, or "".

        Args:
            held: what strikes.
            target: the middle of what is to be struck, at its top.
            reacher: plans the way.
            cloud: what is held as it was seen before it was taken up (n, 3) [m].
        """
        above_it = np.array([0.0, 0.0, POISE])
        for strike in self._strikes(held, cloud):
            path = self._carry_to(held, strike.world_from_grip(target + above_it), reacher)
            if path is not None:
                return "" if self._follow_with(held, path) else "dropped"
        return "unreachable"

    def poise(self, held: Held, target: Array, reacher: Reacher, cloud: Array) -> str:
        """Go back above a point (3,) [m], the face that struck level again; why not, or ""."""
        now = self.robot.world_from_grip[:3, :3]
        near = [
            strike
            for strike in self._strikes(held, cloud)
            if poses.angle_between(strike.rotation, now) < SAME_FACE
        ]
        here, above_it = self._strike_as_it_is(held, cloud), np.array([0.0, 0.0, POISE])
        goals = [strike.world_from_grip(target + above_it) for strike in [*near, here]]
        ways = ((goal, reacher.straight_to(goal)) for goal in goals)
        straight = [(goal, way) for goal, way in ways if way is not None]
        best = (way for goal, way in straight if self._can_strike(way[-1], goal, reacher))
        # Where the arm comes to its limits on the straight way, it goes round by free space.
        around = (self._carry_to(held, goal, reacher) for goal in goals[:AROUND])
        for path in chain(best, around, (way for _, way in straight)):
            if path is not None:
                free = self.robot.follow(path, pace=POISE_PACE, stop=self._loses(held.name))
                return "" if free else "dropped"
        return "unreachable"

    def blow(self, held: Held, target: Array, reacher: Reacher) -> str:
        """Strike down on a point (3,) below the face [m]; the reason why not, or ""."""
        grip = self.robot.world_from_grip
        ways = (
            reacher.straight_to(poses.translation(0, 0, -POISE - through) @ grip)
            for through in THROUGH
        )
        path = next((way for way in ways if way is not None), None)
        if path is None:
            return "unreachable"
        self.robot.follow(path, pace=BLOW_PACE, stop=self._strikes_something(held.name))
        return "" if self.feel().holds(held.name) else "dropped"

    def _strikes(self, held: Held, cloud: Array) -> list[StrikePose]:
        hand = hand_points(
            self.robot.body_spheres(self.robot.opening),
            self.robot.chain,
            self.robot.gripper.hand_from_grip,
        )
        return strikes(self._in_grip(held, cloud), hand)

    def _strike_as_it_is(self, held: Held, cloud: Array) -> StrikePose:
        """The lowest point of what is held, as it is held now."""
        rotation = self.robot.world_from_grip[:3, :3]
        thing = self._in_grip(held, cloud)
        return StrikePose(rotation, thing[np.argmin((thing @ rotation.T)[:, 2])], 0.0)

    def _in_grip(self, held: Held, cloud: Array) -> Array:
        grip_from_hand = poses.inverse(self.robot.gripper.hand_from_grip)
        thing_from_seen = poses.inverse(held.world_from_start)
        return poses.transform(grip_from_hand @ self._hand_from(held.name) @ thing_from_seen, cloud)

    def _poised(self, above: Array, reacher: Reacher) -> Array | None:
        """The posture above a blow from which the way down is free to go; None if there is none."""
        answer = reacher.postures(above[None])
        is_good = answer.found[0] and self._can_strike(answer.joints[0], above, reacher)
        return answer.joints[0] if is_good else None

    def _can_strike(self, joints: Array, above: Array, reacher: Reacher) -> bool:
        """Whether a posture above a blow leaves the arm room to strike with all its speed."""
        below = poses.translation(0, 0, -POISE - THROUGH[0]) @ above
        return reacher.way_from(joints, above, below) is not None

    def _carry_to(self, held: Held, goal: Array, reacher: Reacher) -> Array | None:
        """A way to a pose from which a blow can go down; None if there is none."""
        posture = self._poised(goal, reacher)
        return None if posture is None else self._carry(held, posture, reacher)

    def _strikes_something(self, name: str) -> Callable[[], bool]:
        """A question for each step: has what is held struck, and followed through?"""
        after = 0

        def struck() -> bool:
            nonlocal after
            contacts = self.robot.engine.contacts.find(name)
            hit = any(c.force > FELT_BLOW and c.other != NAME for c in contacts)
            after += bool(after) or hit
            return after > FOLLOW_STEPS

        return struck
