from .all_scenarios import AllScenariosExperiment
from .command_experiment import DecisionExperiment
from .custom import CustomExperiment
from .grasps import GraspExperiment
from .noise_robustness import NoiseExperiment
from .paper import PaperExperiment, SituationsExperiment
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
