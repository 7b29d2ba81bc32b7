from .experiment import Case, CaseResult, Experiment, TimedResult
from .learning_scenarios import LearningScenario, load_scenarios

__all__ = ["Case", "CaseResult", "Experiment", "LearningScenario", "TimedResult", "load_scenarios"]
