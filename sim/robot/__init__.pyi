from .grasp_poses import Grasp
from .kinematics import KinematicChain, read_chain
from .models import Gripper, RobotType, find_robot, load_robots
from .path_planner import GraspPath, PathPlanner
from .robot import FingerContacts, Robot

__all__ = [
    "FingerContacts",
    "Grasp",
    "GraspPath",
    "Gripper",
    "KinematicChain",
    "PathPlanner",
    "Robot",
    "RobotType",
    "find_robot",
    "load_robots",
    "read_chain",
]
