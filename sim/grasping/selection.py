"""Selection of the grasp to execute: the best one that can be reached and has not failed before."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from ..robot.grasp_poses import Grasp
from ..robot.path_planner import GraspPath, PathPlanner
from .context import GraspContext
from .planner import RankedGrasps, plan_grasps

MAX_ATTEMPTS = 3  # closings of the gripper for one object
SAME_PLACE = 0.015  # [m], a grasp so near to a failed one is not tried again
# Efforts of planning, and the scores from which the next one is not needed: where little effort
# finds no reachable grasp, or a poor one, more may find a better one.
EFFORTS = {1: 0.5, 2: 0.3, 4: 0.3, 8: 0.0}


@dataclass(frozen=True)
class GraspAttempts:
    """An object to be grasped, and the attempts so far.

    The name is empty for no task; a part of None is any. The gripper has closed on the grasps
    `tried`; `failures` are the reasons why these failed, in order.
    """

    name: str
    part: str | None
    tried: tuple[Grasp, ...] = ()
    failures: tuple[str, ...] = ()

    @property
    def is_given_up(self) -> bool:
        """Whether no attempt is left."""
        return len(self.tried) >= MAX_ATTEMPTS

    def with_failure(self, reason: str) -> GraspAttempts:
        """The task after an attempt has failed."""
        return replace(self, failures=(*self.failures, reason))

    def has_tried(self, grasp: Grasp) -> bool:
        """Whether the gripper has closed at this place before."""
        at = grasp.world_from_grip[:3, 3]
        return any(
            float(np.linalg.norm(at - other.world_from_grip[:3, 3])) < SAME_PLACE
            for other in self.tried
        )


def select_grasp(
    task: GraspAttempts,
    context: GraspContext,
    planner: PathPlanner,
    *,
    lift: float,
    rng: np.random.Generator,
) -> tuple[RankedGrasps, GraspPath | None, str]:
    """Select the best grasp that can be reached, lifted by `lift` [m], and was not tried before.

    Returns the last grasp plan, and the path to the selected grasp; without a reachable one None,
    and the reason.
    """
    plan, reason, best = RankedGrasps((), {}), "", None
    cloud = context.labelled_cloud(planner.table)
    for effort, enough in EFFORTS.items():
        plan = plan_grasps(cloud, planner.robot.gripper, rng=rng, effort=effort)
        fresh = [grasp for grasp in plan.grasps if not task.has_tried(grasp)]
        path = next(planner.grasp_paths(fresh, lift=lift), None)
        if best is None or (path and path.grasp.score > best.grasp.score):
            best = path
        reason = "unreachable" if plan.grasps else plan.reason or "no_grasp"
        if best is not None and best.grasp.score >= enough:
            break
    if best is None and not planner.can_reach(context.target):
        reason = "unreachable"
    return plan, best, "" if best else reason
