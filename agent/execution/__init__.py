"""Execution of goals: from a request to what the robot did.

A request names an action tree; the goal manager executes it with a tree executor, which searches,
infers and acts at each node. Perception turns percepts into evidence, primitives call the motion
of the robot, and the outcome module has the values that result: decision, steps, answer.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
