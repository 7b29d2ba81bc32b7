"""What the fingers of a robot touch in the world, which the robot itself does not know."""

from __future__ import annotations

from hilt.sim.robot.robot import MIN_FORCE, NAME, Robot


def finger_contacts(robot: Robot) -> list[frozenset[tuple[str, str]]]:
    """The bodies and links that each finger touches."""
    found = (robot.engine.bodies.contacts(NAME, link) for link in robot.gripper.links)
    return [
        frozenset((c.other, c.other_link) for c in each if c.force > MIN_FORCE and c.other != NAME)
        for each in found
    ]
