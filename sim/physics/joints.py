"""Joints and motors: joint positions, motor targets, gears, and joints between bodies."""

from collections.abc import Sequence

import numpy as np

from .. import poses
from ..poses import Array
from .bodies import Bodies
from .pybullet_client import PhysicsClient


class Joints:
    """The joints of bodies, their motors, and joints between bodies."""

    def __init__(self, client: PhysicsClient, bodies: Bodies) -> None:
        self._client, self._bodies = client, bodies

    def positions(self, body: str, joints: Sequence[str]) -> Array:
        """Positions of joints [rad] or [m], shape (len(joints),)."""
        return self._states(body, joints, 0)

    def speeds(self, body: str, joints: Sequence[str]) -> Array:
        """Speeds of joints [rad/s] or [m/s], shape (len(joints),)."""
        return self._states(body, joints, 1)

    def _states(self, body: str, joints: Sequence[str], column: int) -> Array:
        states = self._client.call("getJointStates", *self._bodies.joint_ids(body, joints))
        return np.array([state[column] for state in states])

    def efforts(self, body: str, joints: Sequence[str]) -> Array:
        """Highest torques [N m] or forces [N] of joints, as the URDF has them (len(joints),)."""
        number, indices = self._bodies.joint_ids(body, joints)
        return np.array([self._client.call("getJointInfo", number, i)[10] for i in indices])

    def reset(self, body: str, joints: Sequence[str], positions: Sequence[float] | Array) -> None:
        """Set joint positions at once, at rest, without physics."""
        number, indices = self._bodies.joint_ids(body, joints)
        for index, position in zip(indices, positions, strict=True):
            self._client.call("resetJointState", number, index, float(position), 0.0)

    def drive_to(
        self,
        body: str,
        joints: Sequence[str],
        positions: Sequence[float] | Array,
        *,
        forces: Sequence[float] | Array,
        gain: float = 0.1,
        speeds: Sequence[float] | Array | None = None,
    ) -> None:
        """Let motors hold joints at positions from now on.

        Positions are in [rad] or [m]; `forces` limit each motor [Nm] or [N]; `gain` is the
        share of the error of position that is corrected in one step, in [0, 1]; that of speed is
        corrected wholly. The target speeds are zero when None, otherwise in [rad/s] or [m/s].
        """
        count = len(joints)
        self._client.call(
            "setJointMotorControlArray",
            *self._bodies.joint_ids(body, joints),
            self._client.constant("POSITION_CONTROL"),
            targetPositions=positions,
            targetVelocities=[0.0] * count if speeds is None else speeds,
            forces=forces,
            positionGains=[gain] * count,
            velocityGains=[1.0] * count,
        )

    def drive_at(self, body: str, joint: str, speed: float, *, force: float) -> None:
        """Let a motor keep a joint at a speed [rad/s] or [m/s] from now on, with a force limit."""
        number, (index,) = self._bodies.joint_ids(body, [joint])
        options = {"targetVelocity": speed, "force": force}
        control = self._client.constant("VELOCITY_CONTROL")
        self._client.call("setJointMotorControl2", number, index, control, **options)

    def add_gear(
        self, body: str, joint: str, other: str, *, ratio: float, force: float, stiffness: float
    ) -> None:
        """Couple two joints of one body, as the fingers of a gripper are coupled.

        The link of `joint` carries the gear, which turns the other one and transmits a force [N] at
        most. A ratio of -1 makes two fingers that face each other move alike. The stiffness is the
        share of the difference that is corrected in one step, in [0, 1].
        """
        number, (index, other_index) = self._bodies.joint_ids(body, [joint, other])
        axis = self._client.call("getJointInfo", number, index)[13]
        gear = self._join("GEAR", (number, index, number, other_index), axis, np.eye(4))
        self._client.call("changeConstraint", gear, gearRatio=ratio, erp=stiffness, maxForce=force)

    def fix_bodies(self, body: str, other: str, *, force: float) -> None:
        """Join the bases of two bodies by a fixed joint that bears at most `force` [N]."""
        world_from_other = self._bodies.centre_of_mass(other)
        other_from_body = poses.inverse(world_from_other) @ self._bodies.centre_of_mass(body)
        bases = (*self._bodies.link_id(other), *self._bodies.link_id(body))
        joint = self._join("FIXED", bases, (0, 0, 0), other_from_body)
        self._client.call("changeConstraint", joint, maxForce=force)

    def _join(
        self, kind: str, links: Sequence[int], axis: Sequence[float], parent_from_child: Array
    ) -> int:
        return self._client.call(
            "createConstraint",
            *links,
            jointType=self._client.constant(f"JOINT_{kind}"),
            jointAxis=axis,
            parentFramePosition=parent_from_child[:3, 3],
            childFramePosition=(0, 0, 0),
            parentFrameOrientation=poses.quaternion(parent_from_child[:3, :3]),
        )
