"""The registry of experiments by name."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from importlib import import_module

from ....ontology.errors import DataError, UnknownNameError
from ..experiment import Experiment

# Name -> module and class. Modules are imported on demand: some take a second to load.
EXPERIMENTS: Mapping[str, str] = {
    "paper": ".paper:PaperExperiment",
    "situations": ".paper:SituationsExperiment",
    "grasps": ".paper:GraspExperiment",
    "all-scenarios": ".all_scenarios:AllScenariosExperiment",
    "random": ".all_scenarios:RandomScenariosExperiment",
    "noise": ".noise_robustness:NoiseExperiment",
    "facts": ".facts:FactsExperiment",
    "custom": ".custom:CustomExperiment",
}


def make_experiment(name: str, options: Mapping[str, object]) -> Experiment:
    """Return the experiment of a name, with the given options.

    The name is one of `EXPERIMENTS`, or "package.module:Class" for a class of your own, whose
    `name` is the same text.

    Raises:
        UnknownNameError: there is no experiment, or no option, of that name.
        DataError: the module or class cannot be imported.
    """
    kind = _experiment_class(name)
    known = [each.name for each in fields(kind)]
    for option in options:
        if option not in known:
            raise UnknownNameError(f"option of {name}", option, known)
    return kind(**options)  # pyright: ignore[reportArgumentType] - JSON; its class knows the types


def _experiment_class(name: str) -> type[Experiment]:
    module, _, class_name = EXPERIMENTS.get(name, name).partition(":")
    if not class_name:
        raise UnknownNameError("experiment", name, EXPERIMENTS)
    try:
        return getattr(import_module(module, __package__), class_name)
    except ModuleNotFoundError as error:
        raise DataError(f"cannot be imported: {error}.", source=name) from error
    except AttributeError as error:
        raise DataError(f'it contains no class "{class_name}".', source=name) from error
