# SPDX-License-Identifier: Apache-2.0
"""The body: a robot at a table, in a simulated world.

scene     which objects are on the table, and where as far as anybody has said
world     the table, what stands on it, and time
engine    the physics engine behind names; of what it is made only `simulator` imports PyBullet
percept   what has been seen of an object, part by part, and how sure that is
vision    searches for the features it is asked for, in camera images only
attention draws no more of those images than things, and what may hide them
grasp     a pose of the hand from which its fingers close on one part, and how well they would hold
reach     a way of the arm to a grasp that hits nothing
motion    takes, lifts, carries, gives, puts back, points; nothing is ever fixed to the hand
striking  brings a face of what is held above something, and down on it
report    what came of a motion: whether it worked, why not, what was touched, how high
handling  takes by the part, lifts, gives; what is lost is taken again
body      eyes, arm and hand together, as the agent uses them

The body knows nothing of rules. It is told which object and which part:

    with Body(scene, objects, seed=7) as body:
        knife = body.search(["object:knife"])[0]
        body.grasp(knife, "blade")
        body.lift()
        body.hand_over()

A scene needs no simulator yet:

>>> from hilt.ontology.objects import load_objects
>>> from hilt.sim import parse_scene
>>> parse_scene("objects:knife,mug", seed=7, objects=load_objects()).types
('knife', 'mug')
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .body import Body
    from .manipulation.report import REASONS, MotionReport
    from .robot.models import RobotType, find_robot, load_robots
    from .scene.scene import Placement, Scene, parse_scene
    from .scene.world import World
    from .vision.detector import MaskDetector
    from .vision.percept import PartPercept, Percept

__all__ = [
    "REASONS",
    "Body",
    "MaskDetector",
    "MotionReport",
    "PartPercept",
    "Percept",
    "Placement",
    "RobotType",
    "Scene",
    "World",
    "find_robot",
    "load_robots",
    "parse_scene",
]

_HOMES = {
    "body": ("Body",),
    "vision.percept": ("PartPercept", "Percept"),
    "manipulation.report": ("REASONS", "MotionReport"),
    "robot.models": ("RobotType", "find_robot", "load_robots"),
    "scene.scene": ("Placement", "Scene", "parse_scene"),
    "vision.detector": ("MaskDetector",),
    "scene.world": ("World",),
}


def __getattr__(name: str) -> object:
    # numpy and the simulator cost time that those who only read a scene need not pay.
    for module, names in _HOMES.items():
        if name in names:
            return getattr(import_module(f".{module}", __name__), name)
    raise AttributeError(name)
