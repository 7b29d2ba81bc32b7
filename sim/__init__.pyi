from .body import Body
from .grasping.cloud_grasps import grasps_on_cloud, read_cloud
from .grasping.planner import RankedGrasps
from .manipulation.motion_report import MotionReport
from .robot.models import RobotType, find_robot, load_robots
from .scene.scene import Placement, Scene, parse_scene
from .scene.world import World
from .vision.percept import Percept

__all__ = [
    "Body",
    "MotionReport",
    "Percept",
    "Placement",
    "RankedGrasps",
    "RobotType",
    "Scene",
    "World",
    "find_robot",
    "grasps_on_cloud",
    "load_robots",
    "parse_scene",
    "read_cloud",
]
