# SPDX-License-Identifier: Apache-2.0
"""Point clouds of what a grasp reckons with: the wanted part, and what it must not touch."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from enum import IntEnum

import numpy as np

from ..poses import Array

_EMPTY = np.zeros((0, 3))


LEAST_GROWTH = 1.1  # of the cubes, so that growing ends soon


class Label(IntEnum):
    """What a point belongs to."""

    WANTED = 0
    OTHER_PART = 1
    NEIGHBOUR = 2


@dataclass(frozen=True)
class Surroundings:
    """What there is round a part that is to be grasped.

    Attributes:
        points: (n, 3) [m], world frame.
        labels: (n,) of `Label`.
        table: height of the table [m].
        balance: (3,), where the object's centre of mass is thought to be [m].
        mass: of the object [kg].
    """

    points: Array
    labels: np.ndarray
    table: float
    balance: Array
    mass: float

    @property
    def wanted(self) -> Array:
        """The points of the wanted part (k, 3)."""
        return self.points[self.labels == Label.WANTED]

    def thinned(self, cell: float, *, reach: float, most: int) -> Surroundings:
        """Fewer points, evenly spread, and only those near the wanted part.

        Args:
            cell: side of the cubes of which each keeps one point [m].
            reach: how far from the part points are kept [m].
            most: how many points there may be of each label; the cubes grow until it is so.
        """
        low, high = self.wanted.min(axis=0) - reach, self.wanted.max(axis=0) + reach
        near = np.all((self.points >= low) & (self.points <= high), axis=1)
        index = np.concatenate(
            [
                self._spread(np.flatnonzero(near & (self.labels == each)), cell, most)
                for each in Label
            ]
        )
        return Surroundings(
            self.points[index], self.labels[index], self.table, self.balance, self.mass
        )

    def _spread(self, group: np.ndarray, cell: float, most: int) -> np.ndarray:
        kept = group[thin(self.points[group], cell)]
        while len(kept) > most:
            cell *= max(LEAST_GROWTH, float(np.sqrt(len(kept) / most)))
            kept = group[thin(self.points[group], cell)]
        return kept


def surround(
    wanted: Array,
    others: Iterable[Array],
    neighbours: Iterable[Array],
    *,
    table: float,
    balance: Array,
    mass: float,
) -> Surroundings:
    """The surroundings of a part: clouds (n, 3) of it, of the other parts and of neighbours."""
    groups = [wanted, np.vstack([_EMPTY, *others]), np.vstack([_EMPTY, *neighbours])]
    labels = np.repeat(np.array(list(Label)), [len(group) for group in groups])
    return Surroundings(np.vstack(groups), labels, table, np.asarray(balance, float), mass)


def thin(points: Array, cell: float) -> np.ndarray:
    """Indices of one point for each cube of side `cell` [m] that holds any, in order."""
    if not len(points):
        return np.zeros(0, dtype=int)
    cubes = np.floor(points / cell).astype(np.int64)
    cubes -= cubes.min(axis=0)
    span = cubes.max(axis=0) + 1
    key = (cubes[:, 0] * span[1] + cubes[:, 1]) * span[2] + cubes[:, 2]
    return np.sort(np.unique(key, return_index=True)[1])


def spread(points: Array, count: int, *, first: int) -> np.ndarray:
    """Indices of `count` points far from each other, beginning with `first` (farthest points)."""
    chosen = [first]
    distance = np.full(len(points), np.inf)
    while len(chosen) < min(count, len(points)):
        distance = np.minimum(distance, np.sum((points - points[chosen[-1]]) ** 2, axis=1))
        chosen.append(int(np.argmax(distance)))
    return np.array(chosen)


def level_direction(points: Array) -> float:
    """The angle [rad] of the longest extent of the points in the level plane."""
    flat = points[:, :2] - points[:, :2].mean(axis=0)
    along = np.linalg.eigh(flat.T @ flat)[1][:, -1]
    return float(np.arctan2(along[1], along[0]))
