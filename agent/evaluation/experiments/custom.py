# SPDX-License-Identifier: Apache-2.0
"""An experiment of one's own: objects, affordances, levels, grasps and scenes from a YAML file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import ClassVar

from ....ontology.actions import load_actions
from ....ontology.errors import DataError
from ....sim.scene.scene import scene_of
from ...agent import Agent
from ...config import load_language, open_base
from ...execution.embodiment import Embodiment
from ..case import Case
from ..scenarios import Scenario
from .custom_file import CustomFile, load_custom
from .decisions import Decisions


@dataclass(frozen=True)
class Custom(Decisions):
    """The experiment of a file.

    Attributes:
        file: where it is; every worker reads it.
    """

    name: ClassVar[str] = "custom"
    file: str = ""

    def cases(self) -> Sequence[Case]:
        """Scenario by scenario, scene by scene, command by command."""
        return [
            case
            for scenario in self.scenarios.values()
            for number, scene in enumerate(self._said.scenes)
            for case in self.commands(scenario, str(number), scene, self.seed + number)
        ]

    @property
    def actions(self) -> Sequence[str]:
        """What the file says."""
        return self._said.actions

    @cached_property
    def scenarios(self) -> Mapping[str, Scenario]:
        """What the file says, and its mirror image if it wants one."""
        return {scenario.name: scenario for scenario in self._said.scenarios}

    def mind(self) -> Agent:
        """One that knows the objects of the file."""
        kinds, actions = self._said.kinds, load_actions()
        nothing = scene_of((), seed=self.seed, objects=kinds.objects)
        base = open_base("memory:", kinds, actions)
        return Agent(
            base, load_language(kinds), actions, Embodiment(nothing, kinds, simulate=False)
        )

    @cached_property
    def _said(self) -> CustomFile:
        if not self.file:
            raise DataError("expected --file, the YAML of the experiment.", source="custom")
        return load_custom(Path(self.file), seed=self.seed)
