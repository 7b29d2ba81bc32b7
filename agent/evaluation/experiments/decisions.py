"""Experiments that give commands to an agent that was taught a scenario (section 4.1).

A scenario is taught once, by sentence, in the order of its tables. Each case is a new agent over
that knowledge base, with the scene of the case, which is given the command as a sentence; so no
case can depend on another one. The whole system is tested: the command is parsed, the rules are
read from the knowledge base, the choice is inferred. Without simulation the agent sees the scene
perfectly; with simulation a robot looks and executes its decision, on an undisturbed table.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import combinations, cycle, product
from pathlib import Path
from random import Random
from typing import ClassVar

from ....sim.scene.scene import Scene, scene_with
from ...agent import Agent
from ...config import AgentConfig
from ...dialogue.reply import Reply
from ..experiment import Case, CaseResult, Experiment, Json
from ..learning_scenarios import ACTIONS, LearningScenario, command, load_scenarios, rule_sentence
from .ground_truth import CorrectChoices, explain_reply, judge_command

PRINCIPLES = {1, 2, 3, 4}


@dataclass(frozen=True)
class DecisionExperiment(Experiment):
    """An experiment that gives each command in each scene to an agent taught each scenario."""

    sim: bool = False  # whether a simulated robot executes its decisions
    gap: float = 0.05  # smallest distance on its table [m]: room for two fingers and a little more

    @property
    def actions(self) -> Sequence[str]:
        """The actions of the commands."""
        return tuple(ACTIONS)

    @cached_property
    def scenarios(self) -> Mapping[str, LearningScenario]:
        """The scenarios by name."""
        return {scenario.name: scenario for scenario in load_scenarios()}

    def cases_in(self, scenes: Sequence[tuple[str, Sequence[str], int]]) -> Sequence[Case]:
        """Return the cases by scenario, scene and command: 15 a scene for a scenario of the paper.

        A scene is its name in the keys, its objects, and the seed of its poses and the robot.
        """
        found: list[Case] = []
        for scenario, (name, scene, seed) in product(self.scenarios.values(), scenes):
            spec: Json = {"scenario": scenario.name, "scene": list(scene), "seed": seed}
            for affordance, action in product(scenario.affordances, self.actions):
                key = f"{scenario.name}/{name}/{action}/{affordance}"
                asked = spec | {"action": action, "affordance": affordance}
                found.append(Case(self.name, key, asked))
        return found

    def run(self, case: Case) -> CaseResult:
        """Give the command to an agent that was taught the scenario and has the scene."""
        asked = (case.spec[name] for name in ("action", "affordance", "scene"))
        truth = CorrectChoices.from_scenario(self.scenarios[case.spec["scenario"]], *asked)
        reply = self._reply(case, simulate=self.sim)
        result = judge_command(case, truth, reply)
        if self.sim:  # camera images cannot be reproduced later, so the explanation is kept
            return replace(result, facts=result.facts | {"why": explain_reply(reply)})
        return result

    def explain(self, case: Case, result: CaseResult) -> str:
        """Return the proofs: those kept by a simulated run, or else by running the case again."""
        kept = super().explain(case, result)
        return kept or "\n".join(explain_reply(self._reply(case, simulate=False)))

    def picture(self, objects: Sequence[str], seed: int, path: Path) -> Path:
        """Write a picture of the initial scene and return its path."""
        taught = next(iter(self._taught_agents.values()))
        with taught.in_scene(self._scene(objects, seed, taught), simulate=True) as agent:
            return agent.body.picture(path)

    def _reply(self, case: Case, *, simulate: bool) -> Reply:
        spec = case.spec
        taught = self._taught_agents[spec["scenario"]]
        scene = self._scene(spec["scene"], spec["seed"], taught)
        with taught.in_scene(scene, simulate=simulate) as agent:
            return agent.hear(command(spec["action"], spec["affordance"]), only="do", keep=False)

    def _scene(self, objects: Sequence[str], seed: int, taught: Agent) -> Scene:
        return replace(scene_with(objects, seed=seed, objects=taught.objects), gap=self.gap)

    def new_agent(self) -> Agent:
        """Return an agent without a body, with an empty knowledge base in memory."""
        return Agent.open("memory:", AgentConfig(simulate=False))

    @cached_property
    def _taught_agents(self) -> Mapping[str, Agent]:
        return {name: teach(each, self.new_agent()) for name, each in self.scenarios.items()}


@dataclass(frozen=True)
class PaperExperiment(DecisionExperiment):
    """The evaluation of the paper, with at most 255 scenes, drawn from the seed."""

    name: ClassVar[str] = "paper"
    scenes: int = 10

    def cases(self) -> Sequence[Case]:
        """Return the cases by scenario, scene and command."""
        scenes = enumerate(self.drawn_scenes())
        return self.cases_in([(str(n), scene, self.seed + n) for n, scene in scenes])

    def drawn_scenes(self) -> list[list[str]]:
        """Return the objects of each scene."""
        rng = Random(self.seed)  # noqa: S311 - scenes, not secrets
        names, asked = sorted(self.scenarios["A"].grasps), list(self.scenarios.values())
        while True:
            scenes, sizes = [frozenset(names)], cycle(range(1, len(names)))
            while len(scenes) < self.scenes:
                scenes += {frozenset(rng.sample(names, next(sizes)))} - {*scenes}
            tested = {
                CorrectChoices.from_scenario(scenario, "pointTo", affordance, scene).principle
                for scenario, scene in product(asked, scenes)
                for affordance in scenario.affordances
            }
            if tested >= PRINCIPLES or len(scenes) == 1:
                return [sorted(scene) for scene in scenes]


@dataclass(frozen=True)
class SituationsExperiment(DecisionExperiment):
    """Every problem situation of the paper: all subsets of its objects as scenes."""

    name: ClassVar[str] = "situations"

    def cases(self) -> Sequence[Case]:
        """Return the cases by scenario, the smaller scenes first."""
        names = sorted(next(iter(self.scenarios.values())).grasps)
        scenes = (scene for size in range(len(names) + 1) for scene in combinations(names, size))
        return self.cases_in([("+".join(scene) or "empty", scene, self.seed) for scene in scenes])


@dataclass(frozen=True)
class GraspExperiment(Experiment):
    """Grasps of a single object on the table, from random poses; each has the next seed."""

    name: ClassVar[str] = "grasps"
    sim: ClassVar[bool] = True
    poses: int = 3  # for each object and context

    def cases(self) -> Sequence[Case]:
        """Return the cases by object, context and pose."""
        specs: list[Json] = [
            {"object": name, "context": context, "part": part, "seed": seed}
            for name, parts in load_scenarios()[0].grasps.items()
            for context, part in parts.items()
            for seed in range(self.seed, self.seed + self.poses)
        ]
        return [Case(self.name, "{object}/{context}/{seed}".format(**spec), spec) for spec in specs]

    def run(self, case: Case) -> CaseResult:
        """Teach one grasp rule, command the action, and judge what the robot did."""
        name, context, part, seed = (case.spec[k] for k in ("object", "context", "part", "seed"))
        with Agent.open("memory:", AgentConfig(scene=f"objects:{name}", seed=seed)) as agent:
            agent.hear(rule_sentence(name, part, context), only="tell")
            reply = agent.hear(f"{ACTIONS[context]} the {name}", only="do")
        truth = CorrectChoices(frozenset({name}), 0, {name: frozenset({part})})
        result = judge_command(case, truth, reply)
        facts = result.facts | {"why": explain_reply(reply)}
        return replace(result, right=facts.get("success", False), kind="grasp", facts=facts)


def teach(scenario: LearningScenario, agent: Agent) -> Agent:
    """Tell an agent the sentences of a scenario, and return it."""
    for speaker, sentence in scenario.told():
        agent.hear(sentence, speaker=speaker, only="tell")
    return agent
