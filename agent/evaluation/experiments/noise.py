# SPDX-License-Identifier: Apache-2.0
"""Accuracy against noise: eyes that fail, words heard wrongly, teachers who are wrong.

The paper expects that whatever is not right is due to sensor noise (section 4.1). Here it is
measured, and so is what the paper left out: speech and teachers. One trial teaches one scenario and
gives the 15 commands, each in a scene of its own; what is right comes from the scenario alone. All
lines and values of a curve are measured on the same scenes.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import islice
from random import Random
from typing import ClassVar, Literal, cast

from ....ontology.errors import HiltError, UnknownNameError
from ....sim.scene.scene import scene_of
from ...agent import Agent
from ...config import AgentConfig
from ...dialogue.reply import Reply
from ...execution.outcome import Json
from ..case import Case, Result
from ..experiment import Experiment
from ..scenarios import ACTIONS, Scenario, command, load_scenarios
from .curves import CURVES, Curve, drawn
from .garbling import garbled
from .judging import Truth

OTHER = "eve"  # the second teacher
Outcome = Literal["right", "wrong", "declined"]


@dataclass(frozen=True)
class NoiseRun(Experiment):
    """The curves.

    Attributes:
        seed: of scenes, eyes and ears.
        trials: for each point of a curve; half of them with Scenario A, half with B.
        curves: names of curves with commas between them; all when empty.
        sim: whether a simulated robot carries out what it decides; then right is only what it
            also managed to do.

    Raises:
        UnknownNameError: there is no such curve.
    """

    name: ClassVar[str] = "noise"
    trials: int = 30
    curves: str = ""
    sim: bool = False

    def __post_init__(self) -> None:
        for name in self._wanted:
            if name not in CURVES:
                raise UnknownNameError("curve", name, CURVES)

    @property
    def _wanted(self) -> list[str]:
        named = [name.strip() for name in self.curves.split(",")]
        return [name for name in named if name] or list(CURVES)

    def cases(self) -> Sequence[Case]:
        """Curve by curve, line by line, value by value, the trials."""
        return [
            Case(
                self.name,
                f"{curve.name}/{line}/{value:g}/{trial}",
                {"curve": curve.name, "line": line, "value": value, "trial": trial},
            )
            for curve in map(CURVES.__getitem__, self._wanted)
            for line in curve.lines
            for value in curve.values
            for trial in range(self.trials)
        ]

    def run(self, case: Case) -> Result:
        """Teach one scenario, give the 15 commands, and count what came of them."""
        curve = CURVES[str(case.spec["curve"])]
        line, value = str(case.spec["line"]), cast("float", case.spec["value"])
        trial = cast("int", case.spec["trial"])
        setting = _Setting(curve, line, value, trial, self.seed, self.sim)
        outcomes = list(setting.outcomes())
        counted = Counter(outcome for outcome, _ in outcomes)
        commands = sum(counted.values())
        facts: Json = {"commands": commands, **{o: counted[o] for o in ("right", "wrong")}}
        must = value == 0 and line in curve.sound
        return Result(
            case.key,
            not must or counted["right"] == commands,
            "check",
            0,
            f"{counted['right']} of {commands} right",
            "all right" if must else "as it comes",
            facts
            | {
                "declined": counted["declined"],
                "why": [f"{outcome}: {told}" for outcome, told in outcomes if outcome != "right"],
            },
        )

    def summary(self, results: Sequence[Result]) -> Json:
        """The curves, and what became of the paper's claim."""
        curves = drawn(results)
        return {"curves": curves, "claim": _claim(curves)}

    def files(self, results: Sequence[Result]) -> Mapping[str, Json]:
        """The curves."""
        return {"curves.json": self.summary(results)}


@dataclass(frozen=True)
class _Setting:
    """One trial at one point of a curve."""

    curve: Curve
    line: str
    value: float
    trial: int
    seed: int
    sim: bool

    def outcomes(self) -> Iterator[tuple[Outcome, str]]:
        """What came of each command, and how it went in words."""
        rng = Random(f"{self.seed}/{self.trial}")  # noqa: S311 - scenes, not secrets
        pupil = self._pupil()
        for affordance in self._scenario.affordances:
            for action in ACTIONS:
                objects = rng.sample(sorted(self._scenario.grasps), rng.randint(1, 8))
                scene = scene_of(objects, seed=rng.randrange(2**31), objects=pupil.objects)
                with pupil.facing(scene, simulate=self.sim) as agent:
                    said = self._heard(command(action, affordance), rng.random())
                    reply = agent.hear(said, only="do", keep=False)
                truth = Truth.of(self._scenario, action, affordance, objects)
                told = f'"{said}" with {", ".join(objects)} there: {reply.said}'
                yield _outcome(truth, reply), f"{told} Right would be {truth.in_words()}."

    @cached_property
    def _scenario(self) -> Scenario:
        return _scenarios()[self.trial % 2]

    def _heard(self, text: str, chance: float) -> str:
        if self.curve.name != "speech":
            return text
        rng = Random(f"{self.seed}/{self.trial}/{text}/{chance}")  # noqa: S311
        return garbled(text, self.line, self.value, rng, _vocabulary())

    def _pupil(self) -> Agent:
        """Who was taught the scenario, with what the curve puts in the way."""
        choices = self.curve.lines[self.line] if "=" in self.curve.lines[self.line] else ""
        if self.curve.is_of_sensors:
            noise = f"{self.curve.name}={self.value}"
            return _well_taught(self._scenario.name, noise, choices)
        if self.curve.name == "speech":
            said = [self._heard(each, 0.0) for each in self._scenario.sentences()]
            return _taught(said)
        trust = self.value if self.curve.name == "trust" else 1.0
        share = self.value if self.curve.name == "wrong" else 1.0
        number = self.trial if self.curve.name == "wrong" else self.trial % 2
        return _contradicted(self._scenario.name, trust, share, choices, f"{self.seed}/{number}")


def _outcome(truth: Truth, reply: Reply) -> Outcome:
    decision = reply.achievement.decision if reply.achievement else None
    best = decision.object.best if decision else None
    # By its name: what is taken for something else still is what it is.
    chosen = best.name if best else None
    part = decision.chosen_part if decision else None
    if reply.achievement is None or not truth.allows(chosen, part):
        return "wrong" if chosen else "declined"
    return "right" if reply.is_done or not reply.achievement.world.executed else "wrong"


def _claim(curves: Sequence[Json]) -> Json:
    """Where the paper's claim holds, that only sensor noise can lower the score."""
    lowered = {
        str(curve["curve"])
        for curve in curves
        for points in cast("dict[str, list[dict[str, float]]]", curve["lines"]).values()
        if points[0]["accuracy"] == 1.0 and min(point["upper"] for point in points) < 1.0
    }
    of_sensors = sorted(name for name in lowered if CURVES[name].is_of_sensors)
    others = sorted(lowered - {*of_sensors})
    return {"lowered_by_sensors": of_sensors, "lowered_by_others": others, "holds": not others}


# --- Who was taught what -------------------------------------------------------------------------


@lru_cache(maxsize=1)
def _scenarios() -> tuple[Scenario, Scenario]:
    return load_scenarios()


@lru_cache(maxsize=1)
def _vocabulary() -> tuple[str, ...]:
    scenario, _ = _scenarios()
    commands = [command(action, use) for action in ACTIONS for use in scenario.affordances]
    words = {word for text in (*scenario.sentences(), *commands) for word in text.split()}
    return tuple(sorted(words))


@lru_cache(maxsize=4)
def _well_taught(scenario: str, noise: str, choices: str) -> Agent:
    return _taught(_named(scenario).sentences(), noise=noise, choices=choices)


@lru_cache(maxsize=4)
def _contradicted(scenario: str, trust: float, share: float, choices: str, seed: str) -> Agent:
    """Taught by somebody trusted, then by another who says the opposite of some of it."""
    pupil = _taught(_named(scenario).sentences(), choices=choices)
    pupil.base.set_trust(OTHER, trust)
    (opposite,) = (each for each in _scenarios() if each.name != scenario)
    sentences = list(islice(opposite.sentences(), _count_of_uses(opposite)))
    rng = Random(seed)  # noqa: S311
    for sentence in rng.sample(sentences, round(share * len(sentences))):
        pupil.hear(sentence, speaker=OTHER, only="tell")
    return pupil


def _taught(sentences: Sequence[str], *, noise: str = "", choices: str = "") -> Agent:
    overrides = (choices,) if choices else ()
    pupil = Agent.open("memory:", AgentConfig(noise=noise, simulate=False, overrides=overrides))
    for sentence in sentences:
        with suppress(HiltError):  # a sentence that was heard wrongly may say what cannot be
            pupil.hear(sentence, only="tell")
    return pupil


def _named(name: str) -> Scenario:
    (scenario,) = (each for each in _scenarios() if each.name == name)
    return scenario


def _count_of_uses(scenario: Scenario) -> int:
    """How many of its sentences, which come first, say what something is used for."""
    levels = (each for uses in scenario.affordances.values() for each in uses.values())
    return sum(map(len, levels))
