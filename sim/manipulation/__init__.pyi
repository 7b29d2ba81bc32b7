from .hand_motions import HandMotion, HeldObject
from .motion_report import REASONS, MotionReport
from .pick_and_place import PickAndPlace
from .striking import StrikePose, Striking, find_strike_poses

__all__ = [
    "REASONS",
    "HandMotion",
    "HeldObject",
    "MotionReport",
    "PickAndPlace",
    "StrikePose",
    "Striking",
    "find_strike_poses",
]
