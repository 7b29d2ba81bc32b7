from .all_scenarios import AllScenariosExperiment
from .command_experiment import DecisionExperiment
from .custom import CustomExperiment
from .noise_robustness import NoiseExperiment
from .paper import GraspExperiment, PaperExperiment, SituationsExperiment
from .registry import EXPERIMENTS, make_experiment

__all__ = [
    "EXPERIMENTS",
    "AllScenariosExperiment",
    "CustomExperiment",
    "DecisionExperiment",
    "GraspExperiment",
    "NoiseExperiment",
    "PaperExperiment",
    "SituationsExperiment",
    "make_experiment",
]
