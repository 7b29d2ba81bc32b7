from .case import Case, CaseResult, TimedResult
from .experiment import Experiment
from .learning_scenarios import LearningScenario, load_scenarios

__all__ = ["Case", "CaseResult", "Experiment", "LearningScenario", "TimedResult", "load_scenarios"]
