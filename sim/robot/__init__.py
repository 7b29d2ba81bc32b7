"""The robot: its model, kinematics, collision checks and paths."""
