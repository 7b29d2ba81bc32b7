"""Execution of goals: from a request to what the robot did.

A request names an action tree, whose executor searches, infers and acts at each node: perception
turns percepts into evidence, and primitives call the motion of the robot.
"""
