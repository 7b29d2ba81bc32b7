# SPDX-License-Identifier: Apache-2.0
from .motion import FingerContacts, HandMotion, HeldObject
from .pick_and_place import PickAndPlace
from .report import REASONS, MotionReport
from .striking import StrikePose, StrikeTarget, Striking, find_strike_poses

__all__ = [
    "REASONS",
    "FingerContacts",
    "HandMotion",
    "HeldObject",
    "MotionReport",
    "PickAndPlace",
    "StrikePose",
    "StrikeTarget",
    "Striking",
    "find_strike_poses",
]
