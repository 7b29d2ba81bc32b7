# SPDX-License-Identifier: Apache-2.0
"""Grasps of one part of an object, found in its point cloud and ordered by how well they hold.

`plan_grasps` proposes poses of the hand (`hand_poses`), judges each by its width profile (`hold`),
turns the best ones a little to see whether that makes them better, and gives the good ones, best
first. The part constraint is a filter: both contact bands must lie wholly on the wanted part. When
nothing is left, `GraspPlan.reason` says why.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from .. import poses
from ..poses import Array
from ..robot.models import Gripper
from . import scoring
from .point_clouds import Surroundings
from .sampling import propose
from .scoring import GraspScores

COARSE_CELL = 0.0035  # [m] between the points that proposals look at
FINE_CELL = 0.002  # [m] between the points that the profile looks at
COARSE_REACH, FINE_REACH = 0.15, 0.13  # [m] round the part, what a hand may run into
COARSE_POINTS, FINE_POINTS = 2000, 6000  # of each kind, also of large things
SAMPLES = 60  # points of the part from which poses are tried
OTHER_TURN = 0.2  # [rad], with more effort the hand comes from other directions, too
JUDGED = 240  # proposals that are judged
PLACE = 0.02  # [m], side of the cubes that are one place; each place gets its share of them
TILT_COST = 0.03  # [m], a level approach counts as this much farther from the balance
SHUFFLE = 0.02  # [m], so that different directions come first at one place
REFINED = 24  # of those, the best are turned and judged again
TURNS_DEG = (-7.0, -3.5, 3.5, 7.0)  # about the approach direction
LARGEST_MOVE = 0.03  # [m] towards the middle of something round
DEEPER = (0.004, 0.008, 0.012)  # [m], the best ones are also tried deeper
SHOWN = 24  # of the poses that were ruled out
LEAST_POINTS = 12  # of a part, else nothing can be said about it
APART = 0.012  # [m], grasps nearer than this and turned alike are one
APART_ANGLE = 0.35  # [rad]
_REASONS = {"too_wide": "too_wide", "part": "blocked", "neighbour": "blocked"}


@dataclass(frozen=True)
class Grasp:
    """One way to take hold of a part.

    Attributes:
        world_from_grip: (4, 4), the grip frame when the fingers close.
        width: of the part between the pads [m].
        opening: of the hand before it closes [m].
        score: at most 1, the higher the better.
    """

    world_from_grip: Array
    width: float
    opening: float
    score: float

    @property
    def approach(self) -> Array:
        """The direction (3,) in which the hand comes."""
        return self.world_from_grip[:3, 2]


@dataclass(frozen=True)
class GraspPlan:
    """The grasps of a part, best first, and what ruled out the others.

    Attributes:
        grasps: the good ones.
        rejected: obstacle -> how many poses it ruled out.
        ruled_out: some of the poses that were ruled out, to be shown.
    """

    grasps: tuple[Grasp, ...]
    rejected: Mapping[str, int]
    ruled_out: tuple[Grasp, ...] = ()

    @property
    def reason(self) -> str:
        """Why there is no grasp; empty when there are some, or there was nothing to try.

        "too_wide" or "blocked" (by neighbours or other parts) where that ruled out most of the
        poses, else "no_grasp": also of a knife some directions are too wide.
        """
        if self.grasps or not any(self.rejected.values()):
            return ""
        counts = Counter[str]()
        for obstacle, count in self.rejected.items():
            counts[_REASONS.get(obstacle, "no_grasp")] += count
        reason, count = counts.most_common(1)[0]
        return reason if 2 * count > counts.total() else "no_grasp"


def plan_grasps(
    surroundings: Surroundings,
    gripper: Gripper,
    *,
    rng: np.random.Generator,
    count: int = 40,
    effort: int = 1,
) -> GraspPlan:
    """Plan grasps of the wanted part.

    Args:
        surroundings: the part, and what is near it.
        gripper: the hand.
        rng: where the search begins.
        count: most grasps that are given.
        effort: how many times as many poses as usual are tried and judged, in other directions.
    """
    if len(surroundings.wanted) < LEAST_POINTS:
        return GraspPlan((), {})
    coarse = surroundings.thinned(COARSE_CELL, reach=COARSE_REACH, most=COARSE_POINTS)
    fine = surroundings.thinned(FINE_CELL, reach=FINE_REACH, most=FINE_POINTS)
    turn = (effort - 1) * OTHER_TURN
    proposed = propose(coarse, gripper, rng=rng, count=effort * SAMPLES, turn=turn)
    opening = np.minimum(proposed.width + 2 * scoring.SPARE, gripper.opening)
    low = scoring.hits_table(proposed.world_from_grip, opening, surroundings.table, gripper)
    first = np.flatnonzero(~low)
    first = first[
        _spread_out(proposed.world_from_grip[first], surroundings.balance, rng, effort * JUDGED)
    ]
    between = proposed.width[first]
    holds = scoring.judge(proposed.world_from_grip[first], between, fine, gripper)
    rejected = _count(holds)
    rejected["table"] = rejected.get("table", 0) + int(low.sum())
    rejected["too_wide"] = rejected.get("too_wide", 0) + proposed.too_wide
    rejected["part"] = rejected.get("part", 0) + proposed.blocked
    ruled_out = holds[np.flatnonzero(holds.score <= 0)[:SHOWN]]
    holds = _refine(holds, fine, gripper)
    best = holds[_distinct(holds, count)]
    return GraspPlan(tuple(_grasps(best)), rejected, tuple(_grasps(ruled_out)))


def _spread_out(
    world_from_grip: Array, balance: Array, rng: np.random.Generator, count: int
) -> np.ndarray:
    """Which `count` proposals to judge: some of each place, those near the centre of mass first."""
    positions = world_from_grip[:, :3, 3]
    cost = np.linalg.norm(positions - balance, axis=1) + TILT_COST * (1 + world_from_grip[:, 2, 2])
    order = np.argsort(cost + rng.uniform(0.0, SHUFFLE, len(cost)))
    places = np.unique(np.floor(positions / PLACE).astype(int), axis=0, return_inverse=True)[1]
    rank = np.zeros(len(order), dtype=int)
    for place in np.unique(places):
        members = order[places[order] == place]
        rank[members] = np.arange(len(members))
    return np.lexsort((cost, rank))[:count]


def _refine(holds: GraspScores, fine: Surroundings, gripper: Gripper) -> GraspScores:
    """The holds, and better ones near the best of them."""
    best = holds[_distinct(holds, REFINED, least=-2 * scoring.RULED_OUT)]
    centred = scoring.judge(best.world_from_grip @ _corrections(best), best.between, fine, gripper)
    holds = holds.joined(centred)
    best = holds[_distinct(holds, REFINED)]
    turns = np.tile(np.eye(4), (len(TURNS_DEG) + len(DEEPER), 1, 1))
    turns[: len(TURNS_DEG), :3, :3] = poses.rotation_about((0, 0, 1), np.radians(TURNS_DEG))
    turns[len(TURNS_DEG) :, 2, 3] = DEEPER
    changed = (best.world_from_grip[:, None] @ turns).reshape(-1, 4, 4)
    between = np.repeat(best.between, len(turns))
    return holds.joined(scoring.judge(changed, between, fine, gripper))


def _corrections(holds: GraspScores) -> Array:
    """How to move each hand to where the part is widest, and turn it along its faces.

    On a round thing of radius r, at a distance d from its middle, the slope is d / sqrt(r^2 - d^2)
    and half the width is the root: their product is how far the middle is away.
    """
    result = np.tile(np.eye(4), (len(holds.width), 1, 1))
    result[:, :3, :3] = poses.rotation_about((0, 0, 1), holds.twist)
    move = np.clip(holds.slope * holds.width[:, None] / 2, -LARGEST_MOVE, LARGEST_MOVE)
    result[:, 0, 3], result[:, 2, 3] = move.T
    return result


def _count(holds: GraspScores) -> dict[str, int]:
    numbers = np.bincount(holds.obstacle, minlength=len(scoring.OBSTACLES))
    return {name: int(n) for name, n in zip(scoring.OBSTACLES, numbers, strict=True) if name and n}


def _distinct(holds: GraspScores, count: int, *, least: float = 0.0) -> np.ndarray:
    """Indices of possible holds, best first, without those that nearly repeat a better one."""
    chosen: list[int] = []
    for index in np.argsort(-holds.score, kind="stable"):
        if len(chosen) == count or holds.score[index] <= least:
            break
        if not chosen or not _near(holds.world_from_grip[chosen], holds.world_from_grip[index]):
            chosen.append(int(index))
    return np.array(chosen, dtype=int)


def _grasps(holds: GraspScores) -> Iterator[Grasp]:
    for each in range(len(holds.score)):
        yield Grasp(
            holds.world_from_grip[each],
            float(holds.width[each]),
            float(holds.opening[each]),
            float(holds.score[each]),
        )


def _near(chosen: Array, candidate: Array) -> bool:
    aside = chosen[:, :3, 3] - candidate[:3, 3]
    close = np.flatnonzero((aside * aside).sum(axis=1) < APART**2)
    if not len(close):
        return False
    turned = poses.angle_between(chosen[close, :3, :3], candidate[:3, :3])
    return bool((turned < APART_ANGLE).any())
