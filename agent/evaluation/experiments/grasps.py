"""The grasps of section 4.1: 16 grasp rules, each taught by sentence and executed in simulation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, cast

from ...agent import Agent
from ...config import AgentConfig
from ..case import Case, CaseResult
from ..experiment import Experiment
from ..learning_scenarios import ACTIONS, grasp_sentence, load_scenarios
from .ground_truth import judge_grasp


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
        spec = cast("dict[str, str]", case.spec)
        name, context, part = spec["object"], spec["context"], spec["part"]
        seed = cast("int", case.spec["seed"])
        with Agent.open("memory:", AgentConfig(scene=f"objects:{name}", seed=seed)) as agent:
            agent.hear(grasp_sentence(name, context, part), only="tell")
            reply = agent.hear(f"{ACTIONS[context]} the {name}", only="do")
        return judge_grasp(case, name, part, reply)
