from .placement import DropPose, place_objects
from .scene import Placement, Scene, parse_scene
from .world import SleepManager, World

__all__ = [
    "DropPose",
    "Placement",
    "Scene",
    "SleepManager",
    "World",
    "parse_scene",
    "place_objects",
]
