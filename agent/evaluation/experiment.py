"""The base class of experiments.

An experiment is a frozen dataclass of plain JSON options. It lists its cases and runs any one of
them independently, in any order and in any process: a worker constructs the experiment again from
its name and options. What is expensive to set up is a `cached_property` of the experiment.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import ClassVar, cast

from ..execution.outcome import Json
from .case import Case, CaseResult


@dataclass(frozen=True)
class Experiment(ABC):
    """An experiment, registered by its name; its fields are its options, each plain JSON."""

    name: ClassVar[str]
    seed: int = 0

    @property
    def options(self) -> Json:
        """The options from which it can be constructed again."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @property
    def simulates(self) -> bool:
        """Whether a simulated robot carries out commands; without an option `sim` none does."""
        return bool(self.options.get("sim"))

    @abstractmethod
    def cases(self) -> Sequence[Case]:
        """Return all cases, always in the same order."""

    @abstractmethod
    def run(self, case: Case) -> CaseResult:
        """Run one case; the result depends on the case and the options only."""

    def explain(self, case: Case, result: CaseResult) -> str:
        """Return an explanation of a result; empty if there is none."""
        return "\n".join(cast("list[str]", result.facts.get("why", [])))

    def summary(self, results: Sequence[CaseResult]) -> Json:
        """Return the values that are reported besides the counts; none by default."""
        return {}

    def files(self, results: Sequence[CaseResult]) -> Mapping[str, Json]:
        """Return further documents to write, by file name; none by default."""
        return {}
