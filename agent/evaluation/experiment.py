# SPDX-License-Identifier: Apache-2.0
"""What an experiment is, and which ones there are.

An experiment is a frozen value made of plain JSON options. It lists its cases and runs any one of
them by itself, in any order and in any process: a worker makes the experiment again from its name
and options. What is costly to set up is kept on the experiment with `cached_property`.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from importlib import import_module
from typing import ClassVar, cast

from ...ontology.errors import DataError, UnknownNameError
from ..execution.outcome import Json
from .case import Case, Result


@dataclass(frozen=True)
class Experiment(ABC):
    """An experiment; its fields are its options, each plain JSON.

    Attributes:
        name: under which it is registered.
        seed: of everything random in it.
    """

    name: ClassVar[str]
    seed: int = 0

    @property
    def options(self) -> Json:
        """What it was made with, and can be made with again."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @abstractmethod
    def cases(self) -> Sequence[Case]:
        """All cases, always the same ones in the same order."""

    @abstractmethod
    def run(self, case: Case) -> Result:
        """Run one case; what comes out depends on the case and the options only."""

    def explain(self, case: Case, result: Result) -> str:
        """Why a case came out as it did; empty where there is nothing to say."""
        return "\n".join(cast("list[str]", result.facts.get("why", [])))

    def summary(self, results: Sequence[Result]) -> Json:
        """What the results come to besides their counts; nothing by default."""
        return {}

    def files(self, results: Sequence[Result]) -> Mapping[str, Json]:
        """What is written beside the results: name of the file -> document; nothing by default."""
        return {}


# Name -> where its class is. Modules are imported when they are needed: some take a second to load.
EXPERIMENTS: Mapping[str, str] = {
    "paper": ".experiments.paper:PaperRun",
    "situations": ".experiments.situations:Situations",
    "grasps": ".experiments.grasps:Grasps",
    "all-scenarios": ".experiments.all_scenarios:AllScenarios",
    "noise": ".experiments.noise:NoiseRun",
    "custom": ".experiments.custom:Custom",
}


def make_experiment(name: str, options: Mapping[str, object]) -> Experiment:
    """The experiment of that name.

    Args:
        name: one of `EXPERIMENTS`, or "package.module:Class" for one of your own, whose `name` is
            the same text.
        options: values for its fields; the others keep their defaults.

    Raises:
        UnknownNameError: there is no experiment, or no option, of that name.
        DataError: the module of that name cannot be imported.
    """
    kind = _class_of(name)
    known = [each.name for each in fields(kind)]
    for option in options:
        if option not in known:
            raise UnknownNameError(f"option of {name}", option, known)
    return kind(**options)  # pyright: ignore[reportArgumentType] - JSON; its class knows the types


def _class_of(name: str) -> type[Experiment]:
    module, _, class_name = EXPERIMENTS.get(name, name).partition(":")
    if not class_name:
        raise UnknownNameError("evaluation", name, EXPERIMENTS)
    try:
        return getattr(import_module(module, __package__), class_name)
    except ModuleNotFoundError as error:
        raise DataError(f"cannot be imported: {error}.", source=name) from error
    except AttributeError as error:
        raise DataError(f'there is no class "{class_name}" in it.', source=name) from error
