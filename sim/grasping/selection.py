# SPDX-License-Identifier: Apache-2.0
"""Aims of the hand: what it is after, how often it has closed for that, which grasp comes next."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..robot.models import Gripper
from ..robot.path_planner import Reach, Reacher
from .context import Sight
from .planner import Grasp, GraspPlan, plan_grasps

MAX_ATTEMPTS = 3  # how often the hand closes for one thing
SAME_PLACE = 0.015  # [m], a grasp so near to one that failed is not tried again
# Efforts of plans, and the scores from which on a grasp is good enough not to make the next one:
# where little effort finds no way, or only to a poor grasp, more may find a better one.
EFFORTS = {1: 0.5, 2: 0.3, 4: 0.3, 8: 0.0}


@dataclass(frozen=True)
class Aim:
    """What the hand is after, and how often it has closed for it.

    Attributes:
        name: of the thing; empty while the hand is after nothing.
        part: by which it must be taken; None for any.
        attempts: how often the hand has closed.
        tried: the grasps on which it has closed.
        failures: why that was in vain, each time that it was.
    """

    name: str
    part: str | None
    attempts: int = 0
    tried: tuple[Grasp, ...] = ()
    failures: tuple[str, ...] = ()

    @property
    def is_given_up(self) -> bool:
        """Whether the hand has closed for it as often as it may."""
        return self.attempts >= MAX_ATTEMPTS

    def closed_on(self, grasp: Grasp) -> Aim:
        """The same when the hand has closed once more."""
        return replace(self, attempts=self.attempts + 1, tried=(*self.tried, grasp))

    def failed(self, reason: str) -> Aim:
        """The same when that was in vain."""
        return replace(self, failures=(*self.failures, reason))

    def has_failed(self, grasp: Grasp) -> bool:
        """Whether the hand has closed at this place before."""
        at = grasp.world_from_grip[:3, 3]
        return any(
            float(np.linalg.norm(at - other.world_from_grip[:3, 3])) < SAME_PLACE
            for other in self.tried
        )


@dataclass(frozen=True)
class Choice:
    """How a part is taken.

    Attributes:
        plan: the last plan of grasps that was made.
        reach: the way to the best grasp that can be reached; None when there is none.
        reason: why there is none; empty when there is one.
    """

    plan: GraspPlan
    reach: Reach | None
    reason: str


def choose(
    aim: Aim,
    sight: Sight,
    reacher: Reacher,
    gripper: Gripper,
    *,
    lift: float,
    rng: np.random.Generator,
) -> Choice:
    """Choose the best grasp that can be reached and has not failed before.

    Args:
        aim: what the hand is after.
        sight: how it is seen.
        reacher: plans ways there.
        gripper: the hand.
        lift: how high the thing must be lifted afterwards [m].
        rng: where the search for grasps begins.
    """
    plan, reason, best = GraspPlan((), {}), "", None
    surroundings = sight.surroundings(reacher.table)
    for effort, enough in EFFORTS.items():
        plan = plan_grasps(surroundings, gripper, rng=rng, effort=effort)
        fresh = [grasp for grasp in plan.grasps if not aim.has_failed(grasp)]
        reach = next(reacher.ways_to(fresh, lift=lift), None)
        if best is None or (reach and reach.grasp.score > best.grasp.score):
            best = reach
        reason = "unreachable" if plan.grasps else plan.reason or "no_grasp"
        if best is not None and best.grasp.score >= enough:
            break
    if best is None and not reacher.reaches(sight.wanted):
        reason = "unreachable"
    return Choice(plan, best, "" if best else reason)
