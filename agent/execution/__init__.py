"""Execution of goals: from a request to what the robot did.

A request names an action tree; the goal manager executes it with a tree executor, which searches,
infers and acts at each node. Perception turns percepts into evidence, primitives call the motion
of the robot, and the outcome module has the values that result: decision, steps, answer.
"""
