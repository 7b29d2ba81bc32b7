from .finite_cases import VerbalizedSpace
from .scenario_space import RuleKey, ScenarioSpace
from .taught_agent import TaughtAgent, TracedDecision
from .weak_orders import WeakOrderClass

__all__ = [
    "RuleKey",
    "ScenarioSpace",
    "TaughtAgent",
    "TracedDecision",
    "VerbalizedSpace",
    "WeakOrderClass",
]
