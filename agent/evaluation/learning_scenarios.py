"""The learning scenarios of the paper: the rules taught, their sentences, and the right choices.

Section 4.1 and Table 2. The sentences follow the templates of Table 3. The right choices are read
from the table alone, never by inference: the objects of its highest column with one in the scene.
"""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import yaml

from ...kb.rule import DEFAULT_SPEAKER

SCENARIOS_FILE = Path(__file__).with_name("scenarios.yaml")
LEVELS = ("generally", "often", "sometimes", "occasionally")  # highest first
ACTIONS = {"pass": "pass me", "pickUp": "pick up", "pointTo": "point to"}
_INFINITIVES = {"pass": "pass", "pickUp": "pick up"}
CONTEXTS = tuple(_INFINITIVES)  # the actions that grasp


@dataclass(frozen=True)
class LearningScenario:
    """The rules that are taught in one learning scenario of the paper (section 4.1)."""

    name: str
    affordances: Mapping[str, Mapping[str, Sequence[str]]]  # affordance -> level -> objects
    grasps: Mapping[str, Mapping[str, str]]  # every object -> context -> the part to grasp
    levels: tuple[str, ...] = LEVELS  # highest first; grasps are taught with the first

    def told(self) -> list[tuple[str, str]]:
        """Return the teacher and what is said, in order."""
        return [(DEFAULT_SPEAKER, sentence) for sentence in self.sentences()]

    def parts(self, name: str, action: str) -> frozenset[str]:
        """Return the right parts of an object for an action; empty if none was taught."""
        return frozenset(part for context, part in self.grasps[name].items() if context == action)

    def sentences(self) -> list[str]:
        """Return the sentences that teach the scenario."""
        functional = [
            rule_sentence(name, affordance, level=level)
            for affordance, levels in self.affordances.items()
            for level, names in levels.items()
            for name in names
        ]
        return functional + [
            rule_sentence(name, part, context, self.levels[0])
            for name, parts in self.grasps.items()
            for context, part in parts.items()
        ]

    def best(self, affordance: str, scene: Collection[str]) -> frozenset[str]:
        """Return the right choices for an affordance in a scene; empty if there are none."""
        levels = self.affordances[affordance]
        present = (frozenset(levels.get(level, ())) & frozenset(scene) for level in self.levels)
        return next((names for names in present if names), frozenset())

    def mirrored(self, name: str) -> "LearningScenario":
        """Return the scenario with its levels reversed."""
        opposite: dict[str, str] = dict(zip(self.levels, reversed(self.levels), strict=True))
        turned = {
            affordance: {opposite[level]: names for level, names in levels.items()}
            for affordance, levels in self.affordances.items()
        }
        return replace(self, name=name, affordances=turned)


def rule_sentence(name: str, argument: str, context: str = "", level: str = LEVELS[0]) -> str:
    """Return the sentence that teaches an affordance, or in a context the part to grasp."""
    if context:
        return f"To {_INFINITIVES[context]} a {name} {level} grab the {name} by the {argument}"
    return f"{'an' if name[0] in 'aeiou' else 'a'} {name} is {level} used for {argument}"


def command(action: str, affordance: str) -> str:
    """Return the sentence that commands an action on something with an affordance."""
    return f"{ACTIONS[action]} something used for {affordance}"


@cache
def load_scenarios() -> tuple[LearningScenario, LearningScenario]:
    """Return Scenario A, which the file contains, and Scenario B, its mirror image."""
    scenario = LearningScenario("A", **yaml.safe_load(SCENARIOS_FILE.read_text(encoding="utf-8")))
    return scenario, scenario.mirrored("B")
