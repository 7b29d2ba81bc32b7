"""Grasp planning for one part of an object: sample candidates, score, refine, rank, and select.

The part constraint is a filter: both contact bands must lie wholly on the part.
"""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from .. import poses
from ..poses import Array
from ..robot.models import Gripper
from ..robot.path_planner import Grasp, GraspPath, PathPlanner
from . import scoring
from .context import GraspContext, LabelledPointCloud
from .sampling import sample_grasps
from .scoring import GraspScores

COARSE_CELL = 0.0035  # [m], voxel size for sampling
FINE_CELL = 0.002  # [m], voxel size for scoring
COARSE_REACH, FINE_REACH = 0.15, 0.13  # [m] round the part, where the hand may hit something
COARSE_POINTS, FINE_POINTS = 2000, 6000  # of each label, also for large objects
SAMPLES = 60  # points of the part from which poses are tried
OTHER_TURN = 0.2  # [rad] by which orientations are turned with each further effort
SCORED = 240  # candidates that are scored
PLACE = 0.02  # [m], side of the cubes that each get their share of the scored candidates
TILT_COST = 0.03  # [m], a level approach counts as this much farther from the centre of mass
SHUFFLE = 0.02  # [m], so that different orientations come first at one place
REFINED = 24  # of the scored ones, the best are turned and moved, and scored again
TURNS_DEG = (-7.0, -3.5, 3.5, 7.0)  # about the approach direction
MAX_CORRECTION = 0.03  # [m] towards the middle of a round part
DEEPER = (0.004, 0.008, 0.012)  # [m], the best ones are also tried deeper
MAX_GRASPS = 40
SHOWN = 24  # rejected poses that are kept for display
MIN_POINTS = 12  # of a part
APART = 0.012  # [m], nearer grasps of similar orientation are one
APART_ANGLE = 0.35  # [rad]
MAX_ATTEMPTS = 3  # closings of the gripper for one object
SAME_PLACE = 0.015  # [m], a grasp so near to a failed one is not tried again
# Efforts of planning, and the scores from which the next one is not needed: where little effort
# finds no reachable grasp, or a poor one, more may find a better one.
EFFORTS = {1: 0.5, 2: 0.3, 4: 0.3, 8: 0.0}
ACCEPTABLE = 0.1  # score; a grasp that is not above it is not tried
_REASONS = {"too_wide": "too_wide", "part": "blocked", "neighbour": "blocked", "below_table": ""}


@dataclass(frozen=True)
class RankedGrasps:
    """The grasps of a part, best first, and why other candidates were rejected."""

    grasps: tuple[Grasp, ...]
    rejected: Mapping[str, int]  #: number of rejected poses for each reason
    examples: tuple[Grasp, ...] = ()  #: some rejected poses, for display

    @property
    def reason(self) -> str:
        """Why there is no grasp; empty when there are some, or there was nothing to try.

        "too_wide" or "blocked" (by neighbours or other parts) when that holds for most of the
        poses, else "no_grasp": also of a knife some orientations are too wide.
        """
        counts = Counter[str]()
        for rejection, count in self.rejected.items():
            counts[_REASONS.get(rejection, "no_grasp")] += count
        del counts[""]
        if self.grasps or not counts.total():
            return ""
        reason, count = counts.most_common(1)[0]
        return reason if 2 * count > counts.total() else "no_grasp"


@dataclass(frozen=True)
class GraspAttempts:
    """An object to be grasped, and the attempts so far."""

    name: str  #: empty for no task
    part: str | None  #: None for any
    tried: tuple[Grasp, ...] = ()  #: the grasps on which the gripper has closed
    failures: tuple[str, ...] = ()  #: the reasons why these failed, in order

    @property
    def is_given_up(self) -> bool:
        """Whether no attempt is left."""
        return len(self.tried) >= MAX_ATTEMPTS

    def has_tried(self, grasp: Grasp) -> bool:
        """Whether the gripper has closed at this place before."""
        aside = (grasp.world_from_grip - other.world_from_grip for other in self.tried)
        return any(float(np.linalg.norm(each[:3, 3])) < SAME_PLACE for each in aside)


def select_grasp(
    task: GraspAttempts, context: GraspContext, planner: PathPlanner, *, rng: np.random.Generator
) -> tuple[RankedGrasps, GraspPath | None, str]:
    """Select the best grasp that can be reached and lifted, and was not tried before.

    Returns the last grasp plan, and the path to the grasp; without one None, and the reason.
    """
    plan, best = RankedGrasps((), {}), None
    cloud = context.labelled_cloud(planner.table)
    for effort, enough in EFFORTS.items():
        plan = plan_grasps(cloud, planner.robot.gripper, rng=rng, effort=effort)
        fresh = [grasp for grasp in plan.grasps if not task.has_tried(grasp)]
        path = next(planner.grasp_paths(fresh), None)
        if best is None or (path and path.grasp.score > best.grasp.score):
            best = path
        if best is not None and best.grasp.score >= enough:
            break
    if best is None and not plan.grasps and planner.can_reach(context.target):
        return plan, None, plan.reason or "no_grasp"
    return plan, best, "" if best else "unreachable"


def plan_grasps(
    cloud: LabelledPointCloud, gripper: Gripper, *, rng: np.random.Generator, effort: int = 1
) -> RankedGrasps:
    """Plan at most `MAX_GRASPS` grasps of the target of a cloud, from samples drawn by `rng`.

    `effort` multiplies the number of candidates; above 1 other orientations are tried.
    """
    if len(cloud.target) < MIN_POINTS:
        return RankedGrasps((), {})
    coarse = cloud.downsampled(COARSE_CELL, reach=COARSE_REACH, limit=COARSE_POINTS)
    fine = cloud.downsampled(FINE_CELL, reach=FINE_REACH, limit=FINE_POINTS)
    turn = (effort - 1) * OTHER_TURN
    at, width, rejected = sample_grasps(coarse, gripper, rng=rng, count=effort * SAMPLES, turn=turn)
    opening = np.minimum(width + 2 * scoring.SPARE, gripper.opening)
    low = scoring.hits_table(at, opening, cloud.table, gripper)
    high = np.flatnonzero(~low)
    chosen = high[_spread_out(at[high], cloud.centre_of_mass, rng, effort * SCORED)]
    scores = scoring.score_grasps(at[chosen], width[chosen], fine, gripper)
    rejected["table"] += int(low.sum())
    rejected.update(scoring.REJECTIONS[index] for index in scores.rejection if index)
    examples = scores[np.flatnonzero(scores.score <= 0)[:SHOWN]]
    scores = _refine(scores, fine, gripper)
    best = scores[_distinct(scores, MAX_GRASPS, above=ACCEPTABLE)]
    return RankedGrasps(_as_grasps(best), rejected, _as_grasps(examples))


def _spread_out(grips: Array, centre: Array, rng: np.random.Generator, count: int) -> np.ndarray:
    positions = grips[:, :3, 3]
    cost = np.linalg.norm(positions - centre, axis=1) + TILT_COST * (1 + grips[:, 2, 2])
    order = np.argsort(cost + rng.uniform(0.0, SHUFFLE, len(cost)))
    places = np.unique(np.floor(positions / PLACE).astype(int), axis=0, return_inverse=True)[1]
    rank = np.zeros(len(order), dtype=int)
    for place in np.unique(places):
        members = order[places[order] == place]
        rank[members] = np.arange(len(members))
    return np.lexsort((cost, rank))[:count]


def _refine(scores: GraspScores, fine: LabelledPointCloud, gripper: Gripper) -> GraspScores:
    best = scores[_distinct(scores, REFINED, above=-2 * scoring.REJECTION_PENALTY)]
    centred = best.world_from_grip @ _corrections(best)
    scores = poses.joined(scores, scoring.score_grasps(centred, best.section_width, fine, gripper))
    best = scores[_distinct(scores, REFINED)]
    changes = np.tile(np.eye(4), (len(TURNS_DEG) + len(DEEPER), 1, 1))
    changes[: len(TURNS_DEG), :3, :3] = poses.rotation_about((0, 0, 1), np.radians(TURNS_DEG))
    changes[len(TURNS_DEG) :, 2, 3] = DEEPER
    changed = (best.world_from_grip[:, None] @ changes).reshape(-1, 4, 4)
    section_width = np.repeat(best.section_width, len(changes))
    return poses.joined(scores, scoring.score_grasps(changed, section_width, fine, gripper))


def _corrections(scores: GraspScores) -> Array:
    """Motions (c, 4, 4) of each hand to where the part is widest, turned to its faces.

    On a round part of radius r, at a distance d from its middle, the slope is d / sqrt(r^2 - d^2)
    and half the width is the root: their product is the distance of the middle.
    """
    result = np.tile(np.eye(4), (len(scores.width), 1, 1))
    result[:, :3, :3] = poses.rotation_about((0, 0, 1), scores.twist)
    move = scores.slope * scores.width[:, None] / 2
    result[:, 0, 3], result[:, 2, 3] = np.clip(move, -MAX_CORRECTION, MAX_CORRECTION).T
    return result


def _distinct(scores: GraspScores, count: int, *, above: float = 0.0) -> np.ndarray:
    rotations, places = scores.world_from_grip[:, :3, :3], scores.world_from_grip[:, :3, 3]
    chosen = np.zeros(0, dtype=int)
    for index in np.argsort(-scores.score, kind="stable"):
        if len(chosen) == count or scores.score[index] <= above:
            break
        aside = places[chosen] - places[index]
        close = chosen[(aside * aside).sum(axis=1) < APART**2]
        turned = poses.angle_between(rotations[close], rotations[index]) if len(close) else close
        if not len(close) or turned.min() >= APART_ANGLE:
            chosen = np.append(chosen, index)
    return chosen


def _as_grasps(scores: GraspScores) -> tuple[Grasp, ...]:
    numbers = np.stack([scores.width, scores.opening, scores.score], axis=1).tolist()
    rows = zip(scores.world_from_grip, numbers, strict=True)
    return tuple(Grasp(pose, *row) for pose, row in rows)
