"""Regret with a deliberately bad teacher, with and without experience.

    export PYTHONPATH=benchmarks
    hilt evaluate experience:ExperienceExperiment --report regret.html
    hilt evaluate experience:ExperienceExperiment --sim

The model: each part of each object holds with a probability of its own, drawn uniformly from [0, 1]
once for a trial; a grasp that does not hold slips when the object is lifted. The teacher tells of
each object the worst part to pass it by. Each episode asks for a random object, and the person says
"yes" to each question. The regret of an episode is the probability that the best part holds, less
that of the part that was taken. Both robots get the same objects and the same luck.

With `sim`, the simulated robot passes a mug from random poses by its barrel, as it was told, which
is without friction. How surely its parts hold is not known, so there is no regret, only what it
did, and when it asked.

A trial is right if Hilt asked for the first time about a part exactly when s of n grasps by it held
such that s or fewer would have a probability below 2.5 %, if the part held with probability 1 - b/a
(the bound b is the setting `contradiction`, a the belief in what was told).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import comb, sqrt
from random import Random
from statistics import fmean, stdev
from typing import ClassVar, cast

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig, household, load_language, open_base
from hilt.agent.dialogue.reply import Reply
from hilt.agent.evaluation.experiment import Case, CaseResult, Experiment
from hilt.agent.evaluation.experiments.noise_robustness import Z
from hilt.agent.evaluation.learning_scenarios import rule_sentence
from hilt.agent.execution.embodiment import Embodiment
from hilt.agent.execution.outcome import Json
from hilt.agent.protocols import Motion
from hilt.ontology.actions import load_actions
from hilt.sim.manipulation.motion_report import MotionReport
from hilt.sim.scene.scene import scene_with
from hilt.sim.vision.percept import Percept

_Regrets = dict[str, list[float]]

ROBOTS = {"with experience": True, "without": False}
TOLD, BOUND, TAIL = 0.95, 0.25, 0.025
SIM_EPISODES = 6
SLIPPERY = {"mug": "barrel"}  # object -> the part that is without friction


class ChanceMotion:
    """A hand that holds parts with given probabilities: object -> part -> probability."""

    abilities = frozenset({"graspObject", "moveTo", "handOver"})

    def __init__(self, chances: Mapping[str, Mapping[str, float]], seed: int) -> None:
        self.chances, self._seed, self.episode = chances, seed, 0
        self.taken = ("", "")  # the object and the part of the last grasp

    def grasp(self, percept: Percept, part: str | None) -> MotionReport:
        """Take an object by a part."""
        self.taken = (percept.object, part or "")
        return MotionReport("grasp", ok=True, touched=self.taken[1:], attempts=1)

    def lift(self) -> MotionReport:
        """Lift it; whether it slips depends on the seed, the episode and the part only."""
        luck = Random(f"{self._seed}/{self.episode}/{self.taken}").random()  # noqa: S311
        is_held = luck < self.chances[self.taken[0]][self.taken[1]]
        return MotionReport("lift", ok=is_held, reason="" if is_held else "slipped")

    def hand_over(self) -> MotionReport:
        """Hand it over."""
        return MotionReport("hand_over", ok=True)


@dataclass
class _Record:
    """What one robot did: its regret after each episode, its questions, and what it came to."""

    regrets: list[float] = field(default_factory=list[float])
    questions: int = 0
    counts: dict[str, list[int]] = field(default_factory=dict[str, list[int]])  # held, trials
    asked_about: set[str] = field(default_factory=set[str])
    mistimed: list[str] = field(default_factory=list[str])

    def note_question(self, name: str, reply: Reply) -> None:
        """Note whether Hilt asks, and whether the first time for an object is the right one."""
        is_asked = reply.ending == "asked"
        held, trials = self.counts.setdefault(name, [0, 0])
        if name not in self.asked_about and is_asked != is_contradicted(held, trials):
            self.mistimed.append(f"{name}: held {held} of {trials}")
        self.questions += is_asked
        if is_asked:
            self.asked_about.add(name)

    def note_trials(self, name: str, told: str, reply: Reply) -> None:
        """Count what the grasps by the part that was told came to."""
        for trial in reply.result.trials if reply.result else ():
            if trial.part == told and name in self.counts:
                self.counts[name][0] += trial.outcome == "held"
                self.counts[name][1] += 1


def is_contradicted(held: int, trials: int) -> bool:
    """Return whether so few successes contradict what was told; computed from the binomial."""
    share = 1 - BOUND / TOLD
    few = range(held + 1)
    return sum(comb(trials, k) * share**k * (1 - share) ** (trials - k) for k in few) < TAIL


@dataclass(frozen=True)
class ExperienceExperiment(Experiment):
    """Episodes with a bad teacher, of robots with and without experience.

    Attributes:
        trials: number of trials, each with other probabilities.
        episodes: number of episodes of a trial.
        sim: whether a simulated robot acts, instead of the model above.
    """

    name: ClassVar[str] = "experience:ExperienceExperiment"
    trials: int = 10
    episodes: int = 200
    sim: bool = False

    def cases(self) -> Sequence[Case]:
        """Return a case for each trial, or for each object of the simulation."""
        if self.sim:
            return [
                Case(self.name, f"sim/{n}", {"object": n, "part": p}) for n, p in SLIPPERY.items()
            ]
        seeds = range(self.seed, self.seed + self.trials)
        return [Case(self.name, f"trial/{seed}", {"seed": seed}) for seed in seeds]

    def run(self, case: Case) -> CaseResult:
        """Run the episodes with both robots, or in the simulator."""
        if self.sim:
            return self._simulated(case)
        seed = cast("int", case.spec["seed"])
        records = {name: self._episodes(seed, learns=learns) for name, learns in ROBOTS.items()}
        mine, other = records.values()
        regrets: Json = {name: record.regrets for name, record in records.items()}
        return CaseResult(
            case.key,
            not mine.mistimed and other.questions == 0 and mine.regrets[-1] <= other.regrets[-1],
            "check",
            0,
            f"regret {mine.regrets[-1]:.1f}, without {other.regrets[-1]:.1f}; "
            + ("; ".join(mine.mistimed) or f"{mine.questions} questions in time"),
            "less regret with experience, and questions when the interval says so",
            {"regrets": regrets, "questions": mine.questions},
        )

    def summary(self, results: Sequence[CaseResult]) -> Json:
        """Return the curves of the mean cumulative regret, and how often Hilt asked."""
        facts = [result.facts for result in results if "regrets" in result.facts]
        if not facts:
            return {}
        lines = {
            name: list(_points([cast("_Regrets", each["regrets"])[name] for each in facts]))
            for name in ROBOTS
        }
        curve: Json = {"curve": "experience", "label": "episodes", "measure": "regret"}
        asked = fmean(cast("int", each["questions"]) for each in facts)
        return {"curves": [curve | {"lines": lines}], "questions_a_trial": round(asked, 2)}

    def _episodes(self, seed: int, *, learns: bool) -> _Record:
        """Run the episodes of a trial with a robot that learns from experience or not."""
        rng = Random(seed)  # noqa: S311 - a model of luck, not secrets
        chances = {
            name: {part: rng.random() for part in kind.parts}
            for name, kind in household().objects.items()
            if kind.graspable
        }
        worst = {name: min(parts, key=lambda part: parts[part]) for name, parts in chances.items()}
        motion, record, regret = ChanceMotion(chances, seed), _Record(), 0.0
        config = AgentConfig(simulate=False)
        with Agent.open("memory:", config, motion=cast("Motion", motion)) as agent:
            if not learns:
                agent.affordances.experience = None
            for name, part in worst.items():
                agent.hear(rule_sentence(name, part, "pass"), only="tell")
            for motion.episode in range(self.episodes):
                name = rng.choice(list(chances))
                reply = agent.hear(f"pass me the {name}")
                if learns:
                    record.note_question(name, reply)
                if reply.ending == "asked":
                    reply = agent.hear("yes")
                record.note_trials(name, worst[name], reply)
                regret += max(chances[name].values()) - chances[name][motion.taken[1]]
                record.regrets.append(round(regret, 6))
        return record

    def _simulated(self, case: Case) -> CaseResult:
        """Let the simulated robot pass an object from random poses, and say yes if it asks."""
        spec, record = cast("dict[str, str]", case.spec), _Record()
        name, told, done = spec["object"], spec["part"], list[str]()
        with _slippery_agent(name, told) as taught:
            taught.hear(rule_sentence(name, told, "pass"), only="tell")
            for seed in range(self.seed, self.seed + SIM_EPISODES):
                record.asked_about.clear()  # each episode is a conversation of its own
                scene = scene_with([name], seed=seed, objects=taught.objects)
                with taught.in_scene(scene, simulate=True) as agent:
                    reply = agent.hear(f"pass me the {name}")
                    record.note_question(name, reply)
                    reply = agent.hear("yes") if reply.ending == "asked" else reply
                record.note_trials(name, told, reply)
                trials = reply.result.trials if reply.result else ()
                done += [f"{each.part} {each.outcome}" for each in trials]
        found = f"{', '.join(done)}; {record.questions} questions"
        return CaseResult(
            case.key,
            not record.mistimed,
            "check",
            0,
            "; ".join([found, *record.mistimed]),
            "questions when the interval says so",
            {"questions": record.questions, "trials": done},
        )


def _slippery_agent(name: str, part: str) -> Agent:
    """Return an untaught agent in a household where a part of an object is without friction."""
    kinds, actions = household(), load_actions()
    kind = kinds.objects[name]
    greased = replace(kind.parts[part], material=replace(kind.parts[part].material, friction=0.0))
    kind = replace(kind, parts={**kind.parts, part: greased})
    kinds = replace(kinds, objects={**kinds.objects, name: kind})
    empty = Embodiment(scene_with((), seed=0, objects=kinds.objects), kinds, simulate=False)
    return Agent(open_base("memory:", kinds, actions), load_language(kinds), actions, empty)


def _points(runs: Sequence[Sequence[float]]) -> Iterator[Json]:
    """Yield the mean cumulative regret of the runs at ten places, with its 95 % interval."""
    length = len(runs[0])
    for count in sorted({round(length * tenth / 10) or 1 for tenth in range(1, 11)}):
        found = [run[count - 1] for run in runs]
        mean = fmean(found)
        half = Z * stdev(found) / sqrt(len(found)) if len(found) > 1 else 0.0
        bounds = {"lower": round(max(0.0, mean - half), 6), "upper": round(mean + half, 6)}
        yield {"x": count, "regret": round(mean, 6), **bounds, "decisions": count * len(runs)}
