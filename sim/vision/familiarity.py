# SPDX-License-Identifier: Apache-2.0
"""Familiarity: whether something looks like anything that was learned.

A classifier must choose among the classes it knows, and is sure even of what belongs to none. So
what is to be named is also compared with examples of the class it is taken for, chosen to lie all
over what that class can look like (farthest points, Gonzalez 1985). Up to the distance that hardly
anything learned exceeds it is familiar; beyond that, the less the farther.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..grasping.point_clouds import spread
from ..poses import Array

LEAST_DEVIATION = 1e-3
MOST_DEVIATIONS = 6.0  # a single number that is far off must not decide alone
LIMIT_SHARE = 0.99  # of what is held back that is familiar
LEAST_LIMIT = 0.1  # hardly any two views are nearer
LOOSEST = 1.25  # times the median of all limits
STEEPNESS = 6.0  # at 1.5 times the limit a twelfth of the confidence is left


@dataclass(frozen=True, eq=False)
class Familiarity:
    """Examples of each class.

    Attributes:
        deviation: of each input within classes (d,); the unit of distances.
        examples: some members of all classes (m, d).
        classes: to which class each example belongs (m,).
        limit: distance to the nearest example up to which something is familiar (c,).
    """

    deviation: Array
    examples: Array
    classes: NDArray[np.int64]
    limit: Array

    @classmethod
    def learned(
        cls,
        inputs: Array,
        classes: NDArray[np.int64],
        held_inputs: Array,
        held_classes: NDArray[np.int64],
        *,
        count: int,
    ) -> Familiarity:
        """Choose examples of each class among inputs (n, d), and limits from those held back."""
        kinds = range(int(classes.max()) + 1)
        centres = np.array([inputs[classes == kind].mean(axis=0) for kind in kinds])
        deviation = (inputs - centres[classes]).std(axis=0) + LEAST_DEVIATION
        members = [np.flatnonzero(classes == kind) for kind in kinds]
        chosen = [each[spread(inputs[each] / deviation, count, first=0)] for each in members]
        index = np.concatenate(chosen)
        usual = cls(deviation, inputs[index], classes[index], np.ones(len(chosen)))
        oddness = usual.oddness(held_inputs, held_classes)
        held = [oddness[held_classes == kind] for kind in kinds]
        limits = [np.quantile(each, LIMIT_SHARE) if len(each) else np.nan for each in held]
        # Of some classes few are held back; one odd example must not open them for everything.
        limit = np.fmin(limits, LOOSEST * np.nanmedian(limits))
        return cls(deviation, inputs[index], classes[index], np.maximum(limit, LEAST_LIMIT))

    def oddness(self, inputs: Array, classes: NDArray[np.int64]) -> Array:
        """How far inputs (n, d) are from what is usual in their classes (n,); 1 is the limit."""
        return np.array(
            [
                self._distance(row, kind) / self.limit[kind]
                for row, kind in zip(inputs, classes, strict=True)
            ]
        )

    def _distance(self, row: Array, kind: int) -> float:
        """Root mean square deviation from the nearest example of a class."""
        deviations = np.abs(self.examples[self.classes == kind] - row) / self.deviation
        squares = np.minimum(deviations, MOST_DEVIATIONS) ** 2
        return float(np.sqrt(squares.mean(axis=1).min()))

    def of(self, inputs: Array, classes: NDArray[np.int64]) -> Array:
        """How familiar inputs (n, d) are as members of classes (n,), each in (0, 1]."""
        return np.maximum(self.oddness(inputs, classes), 1.0) ** -STEEPNESS

    def as_arrays(self, prefix: str) -> dict[str, NDArray[np.float32]]:
        """Its numbers by name, to be kept in a file."""
        return {f"{prefix}_{n}": np.asarray(v, dtype=np.float32) for n, v in vars(self).items()}

    @classmethod
    def from_arrays(cls, arrays: Mapping[str, NDArray[np.float32]], prefix: str) -> Familiarity:
        """The familiarity whose numbers `as_arrays` gave."""
        names = ("deviation", "examples", "classes", "limit")
        deviation, examples, classes, limit = (
            np.asarray(arrays[f"{prefix}_{name}"], dtype=np.float64) for name in names
        )
        return cls(deviation, examples, classes.astype(np.int64), limit)
