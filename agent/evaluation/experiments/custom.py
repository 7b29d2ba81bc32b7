"""Experiments defined in a YAML file: objects, affordances, levels, grasps and scenes.

    household     objects that Hilt does not have, in the form of `ontology/objects.yaml`; optional
    levels        words of confidence in descending order; default: the four of the paper
    affordances   affordance -> level -> the objects of that level
    grasps        object -> context (pass, pickUp) -> the part to grasp; optional
    mirrored      whether a second scenario with reversed levels is run too; default: false
    scenes        lists of objects; "all"; or {random: number of scenes}, drawn from the seed
    actions       the actions of the commands; default: pass, pickUp and pointTo

The objects of the experiment are those named in `affordances` and `grasps`. Each teaching sentence
is parsed when the file is read: a sentence that is not understood is an error.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from random import Random
from typing import ClassVar

from ....nlu.language import Language
from ....nlu.semantics import meaning
from ....ontology.errors import DataError
from ....ontology.objects import Household, read_household
from ....ontology.yaml_reader import YamlNode, read_yaml
from ....sim.scene.scene import Scene, graspable
from ...agent import Agent
from ...config import actions_with, household, load_language, open_base
from ...execution.embodiment import Embodiment
from ..experiment import Case
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS, LearningScenario, rule_sentence
from .decisions import DecisionExperiment

MAX_SCENES = 10_000


@dataclass(frozen=True)
class CustomExperiment(DecisionExperiment):
    """The experiment of a file; every worker reads it."""

    name: ClassVar[str] = "custom"
    file: str = ""

    def cases(self) -> Sequence[Case]:
        """Return the cases by scenario, scene and command."""
        scenes = enumerate(self._spec.scenes)
        return self.cases_in([(str(n), scene, self.seed + n) for n, scene in scenes])

    @property
    def actions(self) -> Sequence[str]:
        """The actions of the file."""
        return self._spec.actions

    @cached_property
    def scenarios(self) -> Mapping[str, LearningScenario]:
        """The scenario of the file, and its mirror image if requested."""
        return {scenario.name: scenario for scenario in self._spec.scenarios}

    def new_agent(self) -> Agent:
        """Return an untaught agent that knows the objects of the file."""
        kinds = self._spec.kinds
        body = Embodiment(Scene((), seed=self.seed), kinds, simulate=False)
        return Agent(open_base("memory:", kinds), load_language(kinds), actions_with(None), body)

    @cached_property
    def _spec(self) -> "CustomSpec":
        if not self.file:
            raise DataError("expected --file, the YAML of the experiment.", source="custom")
        return load_custom(Path(self.file), seed=self.seed)


@dataclass(frozen=True)
class CustomSpec:
    """The content of a file: object types, scenarios, the objects of each scene, and actions."""

    kinds: Household
    scenarios: tuple[LearningScenario, ...]
    scenes: tuple[tuple[str, ...], ...]
    actions: tuple[str, ...]


def load_custom(path: Path, *, seed: int = 0) -> CustomSpec:
    """Read a file, drawing random scenes from the seed; a DataError says where it is wrong."""
    top = read_yaml(path).entries(
        required={"affordances", "scenes"},
        optional={"household", "levels", "grasps", "mirrored", "actions"},
    )
    kinds = household()
    if "household" in top:
        kinds = read_household(top["household"], added_to=kinds)
    scenario = _ScenarioReader(kinds, load_language(kinds)).scenario(top)
    scenes = tuple(_scenes(top["scenes"], tuple(scenario.grasps), seed))
    is_mirrored = "mirrored" in top and top["mirrored"].truth()
    scenarios = (scenario, scenario.mirrored("B")) if is_mirrored else (scenario,)
    actions = top["actions"].texts(choices=ACTIONS) if "actions" in top else tuple(ACTIONS)
    return CustomSpec(kinds, scenarios, scenes, actions)


@dataclass(frozen=True)
class _ScenarioReader:
    """Reads the scenario, checked against the objects and the language."""

    kinds: Household
    language: Language

    def scenario(self, top: Mapping[str, YamlNode]) -> LearningScenario:
        levels = self._levels(top["levels"]) if "levels" in top else LEVELS
        uses = top["affordances"].entries()
        affordances = {name: self._uses(name, spec, levels) for name, spec in uses.items()}
        grasps = top["grasps"].entries() if "grasps" in top else {}
        used = [each for use in affordances.values() for at in use.values() for each in at]
        parts = {name: self._parts(name, spec, levels) for name, spec in grasps.items()}
        return LearningScenario("A", affordances, {**{name: {} for name in used}, **parts}, levels)

    def _levels(self, spec: YamlNode) -> tuple[str, ...]:
        name = graspable(self.kinds.objects)[0]
        before = 2.0
        for item in spec.items():
            rule = self._taught_rule(item, rule_sentence(name, "cutting", "", item.text()))
            lower, upper = rule.confidence
            if not 1 - lower < upper:
                raise item.fail(f'"{item.value}" does not support a rule.')
            if lower >= before:
                raise item.fail(f'"{item.value}" is not less certain than the level before it.')
            before = lower
        if not spec.items():
            raise spec.fail("expected at least one level.")
        return spec.texts()

    def _uses(self, use: str, spec: YamlNode, levels: Sequence[str]) -> Mapping[str, Sequence[str]]:
        found = spec.entries(optional=levels)
        seen: set[str] = set()
        for level, names in found.items():
            for item in names.items():
                if (name := item.text(choices=graspable(self.kinds.objects))) in seen:
                    raise item.fail(f'"{name}" has two levels of {use}.')
                seen.add(name)
                rule = self._taught_rule(item, rule_sentence(name, use, "", level))
                if not isinstance(rule, meaning.FunctionalRule) or rule.affordance != use:
                    raise item.fail(f'"{use}" is not understood as an use.')
        return {level: names.texts() for level, names in found.items()}

    def _parts(self, name: str, spec: YamlNode, levels: Sequence[str]) -> dict[str, str]:
        if name not in self.kinds.objects:
            raise spec.fail(f'there is no object "{name}".')
        for context, part in spec.entries(optional=CONTEXTS).items():
            part.text(choices=self.kinds.objects[name].parts)
            self._taught_rule(part, rule_sentence(name, part.value, context, levels[0]))
        return {context: part.text() for context, part in spec.entries().items()}

    def _taught_rule(self, where: YamlNode, sentence: str) -> meaning.Rule:
        if isinstance(said := self.language.understand(sentence).meaning, meaning.Statement):
            return said.rules[0]
        if isinstance(said, meaning.Misunderstanding):
            raise where.fail(f'"{sentence}" is not understood: {said.message}')
        question = f" {said.question}" if isinstance(said, meaning.AskBack) else ""
        raise where.fail(f'"{sentence}" is not understood as a statement.{question}')


def _scenes(spec: YamlNode, objects: Sequence[str], seed: int) -> Iterator[tuple[str, ...]]:
    rng = Random(seed)  # noqa: S311 - scenes, not secrets
    if not spec.items():
        raise spec.fail("expected at least one scene.")
    for item in spec.items():
        if item.value == "all":
            yield tuple(objects)
        elif isinstance(item.value, dict):
            wanted = item.entries(required={"random"}, optional=())["random"]
            for _ in range(wanted.integer(low=1, high=MAX_SCENES)):
                yield tuple(rng.sample(objects, rng.randint(1, len(objects))))
        else:
            names = item.texts(choices=objects)
            if len({*names}) < len(names):
                raise item.fail("an object is listed twice; references to it would be ambiguous.")
            yield names
