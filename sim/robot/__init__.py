"""The robot: its model, kinematics, collision checks and paths.

`models` reads robots from data, `kinematics` solves their forward and inverse kinematics, `robot`
moves one in the simulator, `collision` and `path_planner` keep it clear of obstacles.
`gripper_poses` has grasps as values.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
