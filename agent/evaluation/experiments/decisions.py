# SPDX-License-Identifier: Apache-2.0
"""Commands given by sentence to an agent that was taught a scenario by sentence.

A scenario is taught once, its sentences in the order of its tables; then every case is a new agent
over that base, with the scene of the case before it, that is told the command. So no case can
depend on another one. Nothing of the way is left out: the command is parsed, the rules come from
the base, the choice from inference. Bodiless, the agent sees its scene perfectly; simulated, a
robot looks with its cameras and carries out what it decided, on a table nobody has touched yet.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import cast

from ....sim.scene.scene import Scene, scene_of
from ...agent import Agent
from ...config import AgentConfig
from ...dialogue.reply import Reply
from ..case import Case, Result
from ..experiment import Experiment
from ..scenarios import ACTIONS, Scenario, command, load_scenarios
from .explaining import why
from .judging import Truth, judged

GAP = 0.05  # [m], room for two fingers and a little more: what is decided is tested, not clutter


@dataclass(frozen=True)
class Decisions(Experiment):
    """Scenarios x scenes x commands.

    Attributes:
        seed: of everything random.
        sim: whether a simulated robot carries out what was decided.
        gap: smallest distance between two things on its table [m].
    """

    sim: bool = False
    gap: float = GAP

    @property
    def actions(self) -> Sequence[str]:
        """What is commanded."""
        return tuple(ACTIONS)

    @cached_property
    def scenarios(self) -> Mapping[str, Scenario]:
        """What is taught, by name."""
        return {scenario.name: scenario for scenario in load_scenarios()}

    def commands(
        self, scenario: Scenario, name: str, scene: Sequence[str], seed: int
    ) -> Iterator[Case]:
        """A case for each command: the paper's 15, for its scenarios.

        Args:
            scenario: what is taught.
            name: what the scene is called in the keys.
            scene: the objects on the table.
            seed: of how they lie there, and of what the robot does.
        """
        for affordance in scenario.affordances:
            for action in self.actions:
                yield Case(
                    self.name,
                    f"{scenario.name}/{name}/{action}/{affordance}",
                    {
                        "scenario": scenario.name,
                        "scene": list(scene),
                        "action": action,
                        "affordance": affordance,
                        "seed": seed,
                    },
                )

    def run(self, case: Case) -> Result:
        """Give the command to an agent that knows the scenario and has the scene before it."""
        spec = cast("dict[str, str]", case.spec)
        objects = cast("list[str]", case.spec["scene"])
        scenario = self.scenarios[spec["scenario"]]
        truth = Truth.of(scenario, spec["action"], spec["affordance"], objects)
        reply = self._reply(case, simulate=self.sim)
        result = judged(case, truth, reply)
        # What a camera saw cannot be worked out again later; perfect eyes can be asked again.
        return replace(result, facts=result.facts | {"why": why(reply)}) if self.sim else result

    def explain(self, case: Case, result: Result) -> str:
        """The proofs: kept where a robot looked, else worked out again, which gives the same."""
        return super().explain(case, result) or "\n".join(why(self._reply(case, simulate=False)))

    def picture(self, objects: Sequence[str], seed: int, path: Path) -> Path:
        """Write a picture of a scene before anything was done, and give its path back."""
        pupil = next(iter(self._taught.values()))
        with pupil.facing(self._scene(objects, seed, pupil), simulate=True) as agent:
            return agent.body.picture(path)

    def _reply(self, case: Case, *, simulate: bool) -> Reply:
        spec = cast("dict[str, str]", case.spec)
        objects = cast("list[str]", case.spec["scene"])
        pupil = self._taught[spec["scenario"]]
        scene = self._scene(objects, cast("int", case.spec["seed"]), pupil)
        with pupil.facing(scene, simulate=simulate) as agent:
            return agent.hear(command(spec["action"], spec["affordance"]), only="do", keep=False)

    def _scene(self, objects: Sequence[str], seed: int, pupil: Agent) -> Scene:
        return replace(scene_of(objects, seed=seed, objects=pupil.objects), gap=self.gap)

    def mind(self) -> Agent:
        """An agent without a body that was told nothing yet, over a base in memory."""
        return Agent.open("memory:", AgentConfig(simulate=False))

    @cached_property
    def _taught(self) -> Mapping[str, Agent]:
        return {name: taught(scenario, self.mind()) for name, scenario in self.scenarios.items()}


def taught(scenario: Scenario, mind: Agent) -> Agent:
    """An agent after it was told a scenario."""
    for sentence in scenario.sentences():
        mind.hear(sentence, only="tell")
    return mind
