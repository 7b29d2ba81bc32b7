# SPDX-License-Identifier: Apache-2.0
from .placement import Spot, place_objects
from .scene import Placement, Scene, parse_scene
from .world import SleepManager, World

__all__ = [
    "Placement",
    "Scene",
    "SleepManager",
    "Spot",
    "World",
    "parse_scene",
    "place_objects",
]
