# SPDX-License-Identifier: Apache-2.0
"""Every problem situation of the paper: 256 scenes x 15 commands in each of 2 scenarios, 7,680."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import ClassVar

from ..case import Case
from .decisions import Decisions


@dataclass(frozen=True)
class Situations(Decisions):
    """All scenes that can be made of the objects, the empty one too."""

    name: ClassVar[str] = "situations"

    def cases(self) -> Sequence[Case]:
        """Scenario by scenario, the smaller scenes first."""
        return [
            case
            for scenario in self.scenarios.values()
            for scene in _subsets(sorted(scenario.grasps))
            for case in self.commands(scenario, "+".join(scene) or "empty", scene, self.seed)
        ]


def _subsets(names: Sequence[str]) -> Iterator[tuple[str, ...]]:
    for size in range(len(names) + 1):
        yield from combinations(names, size)
