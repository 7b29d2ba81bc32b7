# SPDX-License-Identifier: Apache-2.0
"""The paper's run: 2 scenarios, 10 scenes and 15 commands (section 4.1), decided or carried out.

Each scenario is taught by its 32 sentences; each command is a sentence too. Scenes are drawn from
the seed, of every size, one of them with all objects, and so that each of the four principles is
asked for. Bodiless, an agent sees its scene perfectly; with a simulator a robot looks, chooses,
grasps and hands over, from a table that nobody has touched yet.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from random import Random
from typing import ClassVar, cast

from ..agent import Agent
from ..outcome import Json
from .case import Case, Result
from .experiment import Experiment
from .judging import Truth, judged
from .scenarios import ACTIONS, Scenario, command, load_scenarios

PRINCIPLES = {1, 2, 3, 4}


@dataclass(frozen=True)
class PaperRun(Experiment):
    """The paper's run.

    Attributes:
        seed: of the scenes, and of how things lie on the table.
        sim: whether a simulated robot carries out what was decided.
        scenes: how many scenes.
    """

    name: ClassVar[str] = "paper"
    sim: bool = False
    scenes: int = 10

    def cases(self) -> Sequence[Case]:
        """Scenario by scenario, scene by scene, command by command."""
        return [
            self._case(scenario, number, scene, action, affordance)
            for scenario in self._scenarios.values()
            for number, scene in enumerate(self.drawn_scenes())
            for affordance in scenario.affordances
            for action in ACTIONS
        ]

    def run(self, case: Case) -> Result:
        """Give the command to a robot that was taught the scenario and has the scene before it."""
        spec = cast("dict[str, str]", case.spec)
        scene = cast("list[str]", case.spec["scene"])
        scenario = self._scenarios[spec["scenario"]]
        on_table = f"objects:{','.join(scene)}"
        seed = cast("int", case.spec["seed"])
        with Agent.open("memory:", scene=on_table, seed=seed, simulate=self.sim) as agent:
            for sentence in scenario.sentences():
                agent.hear(sentence, only="tell")
            reply = agent.hear(command(spec["action"], spec["affordance"]), only="do")
        truth = Truth.of(scenario, spec["action"], spec["affordance"], scene)
        return judged(case, truth, reply)

    def drawn_scenes(self) -> list[list[str]]:
        """The objects of each scene, the first with all, no two alike, all principles asked for."""
        rng = Random(self.seed)  # noqa: S311 - scenes, not secrets
        drawn = next(scenes for scenes in self._draws(rng) if self._covers(scenes))
        return [sorted(scene) for scene in drawn]

    @cached_property
    def _scenarios(self) -> dict[str, Scenario]:
        return {scenario.name: scenario for scenario in load_scenarios()}

    def _draws(self, rng: Random) -> Iterator[list[frozenset[str]]]:
        names = sorted(self._scenarios["A"].grasps)
        while True:
            scenes = [frozenset(names)]
            while len(scenes) < self.scenes:
                size = 1 + len(scenes) % (len(names) - 1)  # 2, 3, ... 7, 1, 2, ...
                scenes += {frozenset(rng.sample(names, size))} - {*scenes}
            yield scenes

    def _covers(self, scenes: Sequence[frozenset[str]]) -> bool:
        """Whether each principle is asked for; one scene can only ask for some."""
        asked = {
            Truth.of(scenario, "pointTo", affordance, scene).principle
            for scenario in self._scenarios.values()
            for scene in scenes
            for affordance in scenario.affordances
        }
        return asked >= PRINCIPLES or len(scenes) == 1

    def _case(
        self, scenario: Scenario, number: int, scene: list[str], action: str, affordance: str
    ) -> Case:
        spec: Json = {
            "scenario": scenario.name,
            "scene": scene,
            "action": action,
            "affordance": affordance,
            "seed": self.seed + number,
        }
        return Case(self.name, f"{scenario.name}/{number}/{action}/{affordance}", spec)
