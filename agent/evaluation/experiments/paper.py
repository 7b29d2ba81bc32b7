# SPDX-License-Identifier: Apache-2.0
"""The paper's run: 2 scenarios, 10 scenes and 15 commands (section 4.1).

Scenes are drawn from the seed, of every size, the first with all objects, no two alike, and so that
each of the four principles is asked for.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import cycle
from random import Random
from typing import ClassVar

from ..case import Case
from .decisions import Decisions
from .judging import Truth

PRINCIPLES = {1, 2, 3, 4}
MAX_SCENES = 255  # of eight objects no more are different, but for the empty one


@dataclass(frozen=True)
class PaperRun(Decisions):
    """The paper's run.

    Attributes:
        seed: of the scenes, and of how things lie on the table.
        sim: whether a simulated robot carries out what was decided.
        gap: smallest distance between two things on its table [m].
        scenes: how many scenes, at most `MAX_SCENES`.
    """

    name: ClassVar[str] = "paper"
    scenes: int = 10

    def cases(self) -> Sequence[Case]:
        """Scenario by scenario, scene by scene, command by command."""
        drawn = self.drawn_scenes()
        return [
            case
            for scenario in self.scenarios.values()
            for number, scene in enumerate(drawn)
            for case in self.commands(scenario, str(number), scene, self.seed + number)
        ]

    def drawn_scenes(self) -> list[list[str]]:
        """The objects of each scene."""
        rng = Random(self.seed)  # noqa: S311 - scenes, not secrets
        drawn = next(scenes for scenes in self._draws(rng) if self._covers(scenes))
        return [sorted(scene) for scene in drawn]

    def _draws(self, rng: Random) -> Iterator[list[frozenset[str]]]:
        names = sorted(self.scenarios["A"].grasps)
        while True:
            scenes, sizes = [frozenset(names)], cycle(range(1, len(names)))
            while len(scenes) < self.scenes:
                scenes += {frozenset(rng.sample(names, next(sizes)))} - {*scenes}
            yield scenes

    def _covers(self, scenes: Sequence[frozenset[str]]) -> bool:
        """Whether each principle is asked for, as the paper wants it; a single scene cannot."""
        asked = {
            Truth.of(scenario, "pointTo", affordance, scene).principle
            for scenario in self.scenarios.values()
            for scene in scenes
            for affordance in scenario.affordances
        }
        return asked >= PRINCIPLES or len(scenes) == 1
