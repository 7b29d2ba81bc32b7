from .context import GraspContext, LabelledPointCloud
from .planner import RankedGrasps, plan_grasps
from .sampling import GraspCandidates, sample_grasps
from .scoring import GraspScores, score_grasps
from .selection import GraspAttempts, select_grasp

__all__ = [
    "GraspAttempts",
    "GraspCandidates",
    "GraspContext",
    "GraspScores",
    "LabelledPointCloud",
    "RankedGrasps",
    "plan_grasps",
    "sample_grasps",
    "score_grasps",
    "select_grasp",
]
