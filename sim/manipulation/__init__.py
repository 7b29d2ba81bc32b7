"""Manipulation: grasping, lifting, handing over, putting back, pointing and striking.

`hand_motions` has the motions of the hand, `pick_and_place` the actions made of them, with retries,
and `striking` drives nails; every action returns a `MotionReport`.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
