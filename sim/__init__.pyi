from .body import Body
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
    "RobotType",
    "Scene",
    "World",
    "find_robot",
    "load_robots",
    "parse_scene",
]
