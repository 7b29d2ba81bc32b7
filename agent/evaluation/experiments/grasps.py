# SPDX-License-Identifier: Apache-2.0
"""The 16 grasp rules of section 4.1, each taught by sentence and carried out from random poses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import ClassVar, cast

from ...agent import Agent
from ...config import AgentConfig
from ..case import Case, Result
from ..experiment import Experiment
from ..scenarios import ACTIONS, grasp_sentence, load_scenarios
from .judging import grasped


@dataclass(frozen=True)
class Grasps(Experiment):
    """Grasps of one object alone on the table.

    Attributes:
        seed: of the first pose; the others follow it.
        poses: random poses of each object in each context.
    """

    name: ClassVar[str] = "grasps"
    poses: int = 3

    def cases(self) -> Sequence[Case]:
        """Object by object, context by context, pose by pose."""
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

    def run(self, case: Case) -> Result:
        """Teach one grasp rule, ask for the object alone on the table, and look at the world."""
        spec = cast("dict[str, str]", case.spec)
        name, context, part = spec["object"], spec["context"], spec["part"]
        seed = cast("int", case.spec["seed"])
        with Agent.open("memory:", AgentConfig(scene=f"objects:{name}", seed=seed)) as agent:
            agent.hear(grasp_sentence(name, context, part), only="tell")
            reply = agent.hear(f"{ACTIONS[context]} the {name}", only="do")
        return grasped(case, name, part, reply)
