"""The evaluation of the paper (section 4.1), and its extension to all scenes.

The paper evaluates 2 scenarios x 10 scenes x 15 commands. Its scenes are drawn at random: the first
has all objects, they are distinct, and together they test all four principles. All 256 scenes make
7,680 cases. Its 16 grasp rules are each taught by sentence and executed in simulation.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import combinations, cycle
from random import Random
from typing import ClassVar

from ...agent import Agent
from ...config import AgentConfig
from ..experiment import Case, CaseResult, Experiment
from ..learning_scenarios import ACTIONS, grasp_sentence, load_scenarios
from .command_experiment import DecisionExperiment
from .ground_truth import CorrectChoices, judge_grasp

PRINCIPLES = {1, 2, 3, 4}
MAX_SCENES = 255  # the non-empty subsets of eight objects


@dataclass(frozen=True)
class PaperExperiment(DecisionExperiment):
    """The evaluation of the paper, with at most `MAX_SCENES` scenes, drawn from the seed."""

    name: ClassVar[str] = "paper"
    scenes: int = 10

    def cases(self) -> Sequence[Case]:
        """Return the cases by scenario, scene and command."""
        return self.cases_in(self.drawn_scenes())

    def drawn_scenes(self) -> list[list[str]]:
        """Return the objects of each scene."""
        rng = Random(self.seed)  # noqa: S311 - scenes, not secrets
        drawn = next(scenes for scenes in self._draws(rng) if self._covers(scenes))
        return [sorted(scene) for scene in drawn]

    def _draws(self, rng: Random) -> Iterator[list[frozenset[str]]]:
        names = sorted(self.scenarios["A"].objects)
        while True:
            scenes, sizes = [frozenset(names)], cycle(range(1, len(names)))
            while len(scenes) < self.scenes:
                scenes += {frozenset(rng.sample(names, next(sizes)))} - {*scenes}
            yield scenes

    def _covers(self, scenes: Sequence[frozenset[str]]) -> bool:
        tested = {
            CorrectChoices.from_scenario(scenario, "pointTo", affordance, scene).principle
            for scenario in self.scenarios.values()
            for scene in scenes
            for affordance in scenario.affordances
        }
        return tested >= PRINCIPLES or len(scenes) == 1


@dataclass(frozen=True)
class SituationsExperiment(DecisionExperiment):
    """Every problem situation of the paper: all subsets of its objects as scenes."""

    name: ClassVar[str] = "situations"

    def cases(self) -> Sequence[Case]:
        """Return the cases by scenario, the smaller scenes first."""
        return [
            case
            for scenario in self.scenarios.values()
            for size in range(len(scenario.objects) + 1)
            for scene in combinations(sorted(scenario.objects), size)
            for case in self.commands(scenario, "+".join(scene) or "empty", scene, self.seed)
        ]


@dataclass(frozen=True)
class GraspExperiment(Experiment):
    """Grasps of a single object on the table.

    Attributes:
        seed: the seed of the first pose; the next poses have the next seeds.
        poses: number of random poses for each object and context.
    """

    name: ClassVar[str] = "grasps"
    poses: int = 3

    @property
    def simulates(self) -> bool:
        """Always."""
        return True

    def cases(self) -> Sequence[Case]:
        """Return the cases by object, context and pose."""
        return [
            Case(
                self.name,
                f"{name}/{context}/{seed}",
                {"object": name, "context": context, "part": part, "seed": seed},
            )
            for name, parts in load_scenarios()[0].grasps.items()
            for context, part in parts.items()
            for seed in range(self.seed, self.seed + self.poses)
        ]

    def run(self, case: Case) -> CaseResult:
        """Teach one grasp rule, command the action, and judge what the robot did."""
        name, context, part, seed = (case.spec[k] for k in ("object", "context", "part", "seed"))
        with Agent.open("memory:", AgentConfig(scene=f"objects:{name}", seed=seed)) as agent:
            agent.hear(grasp_sentence(name, context, part), only="tell")
            reply = agent.hear(f"{ACTIONS[context]} the {name}", only="do")
        return judge_grasp(case, name, part, reply)
