from .action_tree_executor import ExecutionContext, TreeExecutor
from .embodiment import Embodiment
from .goal_manager import GoalManager
from .outcome import AnswerContent, Decision, GoalResult, WalkStep, WorldOutcome
from .perception import PerfectVision
from .request import Request

__all__ = [
    "AnswerContent",
    "Decision",
    "Embodiment",
    "ExecutionContext",
    "GoalManager",
    "GoalResult",
    "PerfectVision",
    "Request",
    "TreeExecutor",
    "WalkStep",
    "WorldOutcome",
]
