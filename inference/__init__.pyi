from .affordance import Affordances, RuleSource
from .interval_operators import Operators
from .settings import Settings
from .types import Candidate, Conclusion, Goal, Inference, Observation, Target

__all__ = [
    "Affordances",
    "Candidate",
    "Conclusion",
    "Goal",
    "Inference",
    "Observation",
    "Operators",
    "RuleSource",
    "Settings",
    "Target",
]
