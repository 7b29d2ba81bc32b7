"""The base class of experiments, their cases and the results of these; the experiments by name.

An experiment is a frozen dataclass of plain JSON options. It lists its cases and runs any one of
them independently, in any order and in any process: a worker constructs the experiment again from
its name and options. Cases and results are plain JSON, and contain nothing that differs from run to
run: a case gives the same bytes with any runner.
"""

import json
from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from importlib import import_module
from typing import Any, ClassVar, Literal

from ...ontology.errors import DataError, UnknownNameError

Json = dict[str, Any]  # what an experiment wrote, and reads again
Kind = Literal["unique", "tie", "none", "grasp", "check", "error", "lost"]
"""For decisions the number of right choices; else a grasp, or anything else that is checked; or the
case raised an exception, or no worker finished it."""


@dataclass(frozen=True)
class Case:
    """A case of an experiment: a question with a known answer."""

    experiment: str
    key: str  # identifies the case within the experiment, in any run
    spec: Json  # everything needed to run it, including its seed


@dataclass(frozen=True)
class CaseResult:
    """The result of a case."""

    key: str
    right: bool  # whether it agrees with the ground truth
    kind: Kind
    principle: int  # of section 4.1 of the paper, 1 to 4; 0 if none applies
    found: str  # what was chosen or done
    expected: str  # what the ground truth allows
    facts: Json = field(default_factory=dict[str, object])


@dataclass(frozen=True)
class TimedResult:
    """A result with its processor time [s] and how often the case was started."""

    result: CaseResult
    cpu_s: float
    attempts: int = 1

    @classmethod
    def from_json(cls, document: Mapping[str, Any]) -> "TimedResult":
        """Return the result that `to_json_line` wrote; KeyError or TypeError if it is none."""
        return cls(CaseResult(**document["result"]), document["cpu_s"], document["attempts"])


def to_json_line(data: object) -> str:
    """Return a document, a case or a result as a line of JSON: equal bytes for equal content."""
    return json.dumps(data, default=vars, ensure_ascii=False, sort_keys=True, separators=(",", ":"))


@dataclass(frozen=True)
class Experiment(ABC):
    """An experiment, registered by its name; its fields are its options, each plain JSON."""

    name: ClassVar[str]
    seed: int = 0

    @property
    def options(self) -> Json:
        """The options from which it can be constructed again."""
        return {each.name: getattr(self, each.name) for each in fields(self)}

    @abstractmethod
    def cases(self) -> Sequence[Case]:
        """Return all cases, always in the same order."""

    @abstractmethod
    def run(self, case: Case) -> CaseResult:
        """Run one case; the result depends on the case and the options only."""

    def explain(self, case: Case, result: CaseResult) -> str:
        """Return an explanation of a result; empty if there is none."""
        return "\n".join(result.facts.get("why", []))

    def summary(self, results: Sequence[CaseResult]) -> Json:
        """Return the values that are reported besides the counts; none by default."""
        return {}

    def files(self, results: Sequence[CaseResult]) -> Mapping[str, Json]:
        """Return further documents to write, by file name; none by default."""
        return {}


# Name -> module and class. Modules are imported on demand: some take a second to load.
EXPERIMENTS: Mapping[str, str] = {
    "paper": ".experiments.decisions:PaperExperiment",
    "situations": ".experiments.decisions:SituationsExperiment",
    "grasps": ".experiments.decisions:GraspExperiment",
    "all-scenarios": ".experiments.all_scenarios:AllScenariosExperiment",
    "random": ".experiments.all_scenarios:RandomScenariosExperiment",
    "noise": ".experiments.noise_robustness:NoiseExperiment",
    "facts": ".experiments.facts:FactsExperiment",
    "custom": ".experiments.custom:CustomExperiment",
}


def make_experiment(name: str, options: Mapping[str, object]) -> Experiment:
    """Return the experiment of a name, with the given options.

    The name is one of `EXPERIMENTS`, or "package.module:Class" for a class of your own, whose
    `name` is the same text. UnknownNameError if there is no experiment, or no option, of that name;
    DataError if the module or class cannot be imported.
    """
    module, _, class_name = EXPERIMENTS.get(name, name).partition(":")
    if not class_name:
        raise UnknownNameError("experiment", name, EXPERIMENTS)
    try:
        kind: type[Experiment] = getattr(import_module(module, __package__), class_name)
    except ModuleNotFoundError as error:
        raise DataError(f"cannot be imported: {error}.", source=name) from error
    except AttributeError as error:
        raise DataError(f'it contains no class "{class_name}".', source=name) from error
    known = [each.name for each in fields(kind)]
    for option in options:
        if option not in known:
            raise UnknownNameError(f"option of {name}", option, known)
    return kind(**options)  # pyright: ignore[reportArgumentType] - JSON; its class knows the types
