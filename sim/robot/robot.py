# SPDX-License-Identifier: Apache-2.0
"""A robot in the simulated world: its arm follows paths, its hand closes with force and feels.

Nothing is ever fixed to the hand: what it holds, it holds by friction. The two fingers are coupled
by a gear, as those of the real hand are.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ...ontology.errors import SimulationError
from .. import poses
from ..physics.engine import TIME_STEP, PhysicsEngine
from ..physics.types import Contact
from ..poses import Array
from .collision import Spheres, arm_spheres, finger_spheres
from .models import Gripper, RobotType
from .paths import timed

NAME = "robot"
FELT = 0.01  # [N], a weaker contact counts for nothing
CLOSING_SPEED = 0.06  # [m/s] of each finger
CLOSING_TIME = 1.6  # [s], longer than the fingers ever need
STILL = 2e-4  # [m/s], a finger slower than this has met something or its end
STILL_STEPS = 30  # for so long, until closing is over
SQUEEZE_STEPS = 36  # then the force builds up
FINGER_FRICTION, FINGER_SPINNING = 1.0, 0.002  # rubber pads; [m] of a small contact patch
GEAR_FORCE, GEAR_STIFFNESS = 200.0, 0.3
GAIN, DAMPING = 0.3, 1.0  # of the arm's motors: errors below a millimetre at full pace
OPENING_FORCE = 40.0  # [N]


class Robot:
    """A robot in an engine.

    Args:
        engine: the world it moves in.
        kind: what robot it is.
        world_from_base: where it stands; the origin when None.
        step: lets so many steps of time pass; the engine's own when None.
    """

    def __init__(
        self,
        engine: PhysicsEngine,
        kind: RobotType,
        *,
        world_from_base: Array | None = None,
        step: Callable[[int], None] | None = None,
    ) -> None:
        self.engine, self.kind = engine, kind
        self.advance = step or engine.step
        self.world_from_base = np.eye(4) if world_from_base is None else world_from_base
        self.chain = kind.arm
        self.spheres = arm_spheres(self.chain, kind.spheres)
        self._joints = [joint.name for joint in self.chain.moving]
        # Robot files tell inertias that no link of that mass can have (0.1 kg m^2 of each finger of
        # the Panda): the wrist's motors then cannot follow, and the arm leaves its way by 0.3 rad.
        engine.bodies.load(NAME, kind.file, self.world_from_base, fixed=True, inertia_of_shape=True)
        facts = {joint.name: joint for joint in engine.bodies.joints(NAME)}
        self._efforts = [facts[name].effort for name in self._joints]
        engine.joints.reset(NAME, self._joints, kind.home)
        self._hold_arm(kind.home)
        if kind.gripper:
            self._prepare_hand(kind.gripper)

    @property
    def gripper(self) -> Gripper:
        """Its hand.

        Raises:
            SimulationError: it has none.
        """
        if self.kind.gripper is None:
            raise SimulationError(f"The {self.kind.label} has no gripper.")
        return self.kind.gripper

    @property
    def joints(self) -> Array:
        """Where the joints of the arm are (k,) [rad]."""
        return self.engine.joints.positions(NAME, self._joints)

    @property
    def opening(self) -> float:
        """How far the hand is open [m]."""
        return float(self.engine.joints.positions(NAME, self.gripper.joints).sum())

    @property
    def world_from_hand(self) -> Array:
        """The hand (4, 4)."""
        return self.engine.bodies.pose(NAME, self.kind.hand)

    @property
    def world_from_grip(self) -> Array:
        """The middle between the pads (4, 4)."""
        return self.world_from_hand @ self.hand_from_grip

    @property
    def hand_from_grip(self) -> Array:
        """Where the grip is in the frame of the hand (4, 4); the same where there is no gripper."""
        return self.kind.gripper.hand_from_grip if self.kind.gripper else np.eye(4)

    @property
    def tip(self) -> float:
        """How far the ends of the fingers are before the grip, or the end of a bare arm [m]."""
        if self.kind.gripper:
            return self.kind.gripper.tip
        return max(
            (z + radius for *_, z, radius in self.kind.spheres.get(self.kind.hand, ())), default=0.0
        )

    def base_from_hand(self, world_from_grip: Array) -> Array:
        """What inverse kinematics needs for grip poses (..., 4, 4)."""
        base_from_world = poses.inverse(self.world_from_base)
        return base_from_world @ world_from_grip @ poses.inverse(self.hand_from_grip)

    def body_spheres(self, opening: float) -> Spheres:
        """What arm and hand fill when the hand is open by `opening` [m]."""
        if self.kind.gripper is None:
            return self.spheres
        return self.spheres.joined(finger_spheres(self.chain, self.gripper, opening))

    def follow(self, path: Array, *, pace: float, stop: Callable[[], bool] | None = None) -> bool:
        """Run through a path of postures (n, k) [rad].

        Args:
            path: begins where the arm is.
            pace: share of the joints' speed limits, in (0, 1].
            stop: asked at every step; when it is true the arm stops there.

        Returns:
            Whether the path was run through to its end.
        """
        positions, speeds = timed(path, self.chain.speed, step=TIME_STEP, pace=pace)
        for position, speed in zip(positions, speeds, strict=True):
            self._hold_arm(position, speed)
            self.advance(1)
            if stop is not None and stop():
                self._hold_arm(self.joints)
                return False
        return True

    def wait(self, seconds: float) -> None:
        """Stand still for a while [s]."""
        self.advance(round(seconds / TIME_STEP))

    def open(self, opening: float) -> None:
        """Open the hand [m]; takes effect as time passes."""
        half = float(np.clip(opening, 0.0, self.gripper.opening)) / 2
        self.engine.joints.drive_to(
            NAME, self.gripper.joints, [half] * 2, forces=[OPENING_FORCE] * 2
        )

    def close(self) -> None:
        """Close the hand until it meets something or its end, and squeeze."""
        for joint in self.gripper.joints:
            self.engine.joints.drive_at(NAME, joint, -CLOSING_SPEED, force=self.gripper.force)
        still = 0
        for step in range(round(CLOSING_TIME / TIME_STEP)):
            self.advance(1)
            speeds = self.engine.joints.speeds(NAME, self.gripper.joints)
            still = still + 1 if step > STILL_STEPS and np.abs(speeds).max() < STILL else 0
            if still == STILL_STEPS:
                break
        self.advance(SQUEEZE_STEPS)

    def felt(self) -> tuple[tuple[Contact, ...], tuple[Contact, ...]]:
        """What each finger touches with more than `FELT`."""
        first, second = (self._felt_by(link) for link in self.gripper.links)
        return first, second

    def bumps(self) -> bool:
        """Whether the hand touches anything, with its fingers where it has some."""
        links = self.gripper.links if self.kind.gripper else (self.kind.hand,)
        return any(self._felt_by(link) for link in links)

    def _felt_by(self, link: str) -> tuple[Contact, ...]:
        contacts = self.engine.contacts.find(NAME, link)
        return tuple(c for c in contacts if c.force > FELT and c.other != NAME)

    def _hold_arm(self, position: Array, speed: Array | None = None) -> None:
        self.engine.joints.drive_to(
            NAME,
            self._joints,
            position,
            forces=self._efforts,
            gain=GAIN,
            damping=DAMPING,
            speeds=speed,
        )

    def _prepare_hand(self, gripper: Gripper) -> None:
        first, second = gripper.joints
        self.engine.joints.add_gear(
            NAME, first, second, ratio=-1.0, force=GEAR_FORCE, stiffness=GEAR_STIFFNESS
        )
        for link in gripper.links:
            self.engine.contacts.set_surface(
                NAME, link, friction=FINGER_FRICTION, spinning=FINGER_SPINNING
            )
        self.engine.joints.reset(NAME, gripper.joints, [gripper.opening / 2] * 2)
        self.open(gripper.opening)
