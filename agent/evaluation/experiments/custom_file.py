# SPDX-License-Identifier: Apache-2.0
"""Experiments of one's own, read from YAML.

    household     objects that Hilt does not have, in the form of `ontology/objects.yaml`; optional
    levels        words of confidence, the surest first; the paper's four when left out
    affordances   affordance -> level -> the objects of that level
    grasps        object -> context (pass, pickUp) -> the part to grasp; optional
    mirrored      whether a second scenario with its levels reversed is run too; false when left out
    scenes        lists of objects; "all"; or {random: how many}, of any size, drawn from the seed
    actions       what is commanded; pass, pickUp and pointTo when left out

The objects of the experiment are those that `affordances` and `grasps` speak of. Every sentence
that teaches is tried on the language when the file is read: what it does not understand is wrong.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from random import Random

from ....nlu.language import Language
from ....nlu.semantics import meaning
from ....ontology.objects import Household, read_household
from ....ontology.yaml_reader import Field, read_yaml
from ....sim.scene.scene import graspable
from ...config import household, load_language
from ..scenarios import (
    ACTIONS,
    LEVELS,
    Scenario,
    functional_sentence,
    grasp_sentence,
)
from ..verification.space import CONTEXTS

MAX_SCENES = 10_000

Levels = Mapping[str, tuple[str, ...]]


@dataclass(frozen=True)
class CustomFile:
    """What a file says.

    Attributes:
        kinds: the types of objects there are.
        scenarios: one, or it and its mirror image.
        scenes: the objects of each.
        actions: what is commanded.
    """

    kinds: Household
    scenarios: tuple[Scenario, ...]
    scenes: tuple[tuple[str, ...], ...]
    actions: tuple[str, ...]


def load_custom(path: Path, *, seed: int = 0) -> CustomFile:
    """Read an experiment.

    Args:
        path: the file.
        seed: of its random scenes.

    Raises:
        DataError: the file is wrong; says where and what was expected.
    """
    top = read_yaml(path).entries(
        required={"affordances", "scenes"},
        optional={"household", "levels", "grasps", "mirrored", "actions"},
    )
    kinds = household()
    if "household" in top:
        kinds = read_household(top["household"], added_to=kinds)
    scenario = _Reader(kinds, load_language(kinds)).scenario(top)
    objects = tuple(scenario.grasps)
    mirrored = "mirrored" in top and top["mirrored"].truth()
    actions = top["actions"].texts(choices=ACTIONS) if "actions" in top else tuple(ACTIONS)
    return CustomFile(
        kinds,
        (scenario, scenario.mirrored("B")) if mirrored else (scenario,),
        tuple(_scenes(top["scenes"], objects, seed)),
        actions,
    )


@dataclass(frozen=True)
class _Reader:
    """Reads what is taught, against the objects and the language there are."""

    kinds: Household
    language: Language

    def scenario(self, top: Mapping[str, Field]) -> Scenario:
        levels = self._levels(top["levels"]) if "levels" in top else LEVELS
        uses = top["affordances"].entries()
        affordances = {name: self._uses(name, spec, levels) for name, spec in uses.items()}
        grasps = top["grasps"].entries() if "grasps" in top else {}
        used = [each for use in affordances.values() for at in use.values() for each in at]
        parts = {name: self._parts(name, spec, levels) for name, spec in grasps.items()}
        return Scenario("A", affordances, {**{name: {} for name in used}, **parts}, levels)

    def _levels(self, spec: Field) -> tuple[str, ...]:
        """The words of confidence, each surer than the next."""
        name = graspable(self.kinds.objects)[0]
        before = 2.0
        for item in spec.items():
            said = self._understood(item, functional_sentence(name, "cutting", item.text()))
            lower, upper = said.confidence
            if not 1 - lower < upper:
                raise item.fail(f'"{item.value}" does not speak for a rule.')
            if lower >= before:
                raise item.fail(f'"{item.value}" is not less sure than the level before it.')
            before = lower
        if not spec.items():
            raise spec.fail("expected at least one level.")
        return spec.texts()

    def _uses(self, affordance: str, spec: Field, levels: Sequence[str]) -> Levels:
        found = spec.entries(optional=levels)
        seen: set[str] = set()
        for level, names in found.items():
            for item in names.items():
                name = item.text(choices=graspable(self.kinds.objects))
                if name in seen:
                    raise item.fail(f'"{name}" stands at two levels of {affordance}.')
                seen.add(name)
                said = self._understood(item, functional_sentence(name, affordance, level))
                if not isinstance(said, meaning.FunctionalRule) or said.affordance != affordance:
                    raise item.fail(f'"{affordance}" is not understood as a use of things.')
        return {level: names.texts() for level, names in found.items()}

    def _parts(self, name: str, spec: Field, levels: Sequence[str]) -> dict[str, str]:
        if name not in self.kinds.objects:
            raise spec.fail(f'there is no object "{name}".')
        for context, part in spec.entries(optional=CONTEXTS).items():
            part.text(choices=self.kinds.objects[name].parts)
            self._understood(part, grasp_sentence(name, context, part.value, levels[0]))
        return {context: part.text() for context, part in spec.entries().items()}

    def _understood(self, where: Field, sentence: str) -> meaning.Rule:
        """The rule that a sentence teaches."""
        said = self.language.understand(sentence).meaning
        if isinstance(said, meaning.Statement):
            return said.rules[0]
        if isinstance(said, meaning.Misunderstanding):
            raise where.fail(f'"{sentence}" is not understood: {said.message}')
        question = f" {said.question}" if isinstance(said, meaning.AskBack) else ""
        raise where.fail(f'"{sentence}" is not understood as a statement.{question}')


def _scenes(spec: Field, objects: Sequence[str], seed: int) -> Iterator[tuple[str, ...]]:
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
                raise item.fail("an object stands here twice; it would be unclear which is meant.")
            yield names
