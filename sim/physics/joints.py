# SPDX-License-Identifier: Apache-2.0
"""Joints and motors: where joints are, what drives them, and what couples them."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from .. import poses
from ..poses import Array
from .bodies import BASE, Bodies


class Motors(Bodies):
    """The joints of bodies, their motors, and joints between bodies."""

    def joint_positions(self, body: str, joints: Sequence[str]) -> Array:
        """Positions of joints [rad] or [m], shape (len(joints),)."""
        return self._joint_states(body, joints, 0)

    def joint_speeds(self, body: str, joints: Sequence[str]) -> Array:
        """Speeds of joints [rad/s] or [m/s], shape (len(joints),)."""
        return self._joint_states(body, joints, 1)

    def joint_efforts(self, body: str, joints: Sequence[str]) -> Array:
        """What the motors gave in the last step [Nm] or [N], shape (len(joints),)."""
        return self._joint_states(body, joints, 3)

    def _joint_states(self, body: str, joints: Sequence[str], column: int) -> Array:
        states = self._call("getJointStates", *self._indices(body, joints))
        return np.array([state[column] for state in states])

    def _indices(self, body: str, joints: Sequence[str]) -> tuple[int, list[int]]:
        """PyBullet's numbers of a body and of joints of it."""
        known = self._body(body).joints
        for joint in joints:
            if joint not in known:
                self._joint(body, joint)
        return self._body(body).number, [known[joint] for joint in joints]

    def set_joints(
        self, body: str, joints: Sequence[str], positions: Sequence[float] | Array
    ) -> None:
        """Put joints somewhere at once, at rest, without physics."""
        for joint, position in zip(joints, positions, strict=True):
            number, index = self._joint(body, joint)
            self._call("resetJointState", number, index, float(position), 0.0)

    def drive(
        self,
        body: str,
        joints: Sequence[str],
        positions: Sequence[float] | Array,
        *,
        forces: Sequence[float] | Array,
        gain: float = 0.1,
        damping: float = 1.0,
        speeds: Sequence[float] | Array | None = None,
    ) -> None:
        """Let motors hold joints at positions from now on.

        Args:
            body: whose joints.
            joints: their names.
            positions: targets [rad] or [m].
            forces: most that each motor may give [Nm] or [N].
            gain: share of the position error that is corrected in one step, in [0, 1].
            damping: share of the speed error that is corrected in one step, in [0, 1].
            speeds: target speeds [rad/s] or [m/s]; standing still when None.
        """
        count = len(joints)
        self._call(
            "setJointMotorControlArray",
            *self._indices(body, joints),
            self._p.POSITION_CONTROL,
            targetPositions=np.asarray(positions, float).tolist(),
            targetVelocities=np.zeros(count).tolist()
            if speeds is None
            else np.asarray(speeds, float).tolist(),
            forces=np.asarray(forces, float).tolist(),
            positionGains=[gain] * count,
            velocityGains=[damping] * count,
        )

    def drive_speed(self, body: str, joint: str, speed: float, *, force: float) -> None:
        """Let a motor keep a joint at a speed from now on; force 0 lets it go free."""
        number, index = self._joint(body, joint)
        self._call(
            "setJointMotorControl2",
            number,
            index,
            self._p.VELOCITY_CONTROL,
            targetVelocity=speed,
            force=force,
        )

    def gear(
        self, body: str, joint: str, other: str, *, ratio: float, force: float, stiffness: float
    ) -> None:
        """Couple two joints of one body, as the fingers of a hand are coupled.

        Args:
            body: whose joints.
            joint: the one whose link carries the gear.
            other: the one that it turns.
            ratio: -1 makes two fingers that face each other move alike.
            force: most that the gear transmits [N].
            stiffness: share of the difference that is corrected in one step, in [0, 1].
        """
        number, index = self._joint(body, joint)
        other_index = self._joint(body, other)[1]
        axis = self._body(body).facts[joint].axis
        gear = self._call(
            "createConstraint",
            number,
            index,
            number,
            other_index,
            jointType=self._p.JOINT_GEAR,
            jointAxis=axis,
            parentFramePosition=(0, 0, 0),
            childFramePosition=(0, 0, 0),
        )
        self._call("changeConstraint", gear, gearRatio=ratio, erp=stiffness, maxForce=force)

    def attach(self, body: str, other: str, *, force: float) -> None:
        """Fix a body's base to another one's, as they stand to each other now.

        Args:
            body: what is attached.
            other: what it is attached to.
            force: most that the joint bears [N].
        """
        number, other_number = self._body(body).number, self._body(other).number
        other_from_body = poses.inverse(self._centre(other)) @ self._centre(body)
        constraint = self._call(
            "createConstraint",
            other_number,
            BASE,
            number,
            BASE,
            jointType=self._p.JOINT_FIXED,
            jointAxis=(0, 0, 0),
            parentFramePosition=other_from_body[:3, 3],
            childFramePosition=(0, 0, 0),
            parentFrameOrientation=poses.quaternion(other_from_body[:3, :3]),
        )
        self._call("changeConstraint", constraint, maxForce=force)
