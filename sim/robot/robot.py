"""A robot in the simulator: its arm follows paths, its gripper closes and senses contacts.

A path is a list of postures. `time_path` executes it with a speed that starts and ends at zero
(s = 3 t^2 - 2 t^3) within a share of the joints' speed limits, and rounds its corners. The gripper
holds by friction alone; a gear couples its fingers, as in the real hand.
"""

from collections.abc import Callable

import numpy as np

from ...ontology.errors import SimulationError
from .. import poses
from ..physics.engine import TIME_STEP, PhysicsEngine
from ..poses import Array
from .collision import CollisionSpheres, arm_spheres, finger_spheres
from .interruption import Interruption
from .models import Gripper, RobotType
from .trajectory import pack

NAME = "robot"
MIN_FORCE = 0.01  # [N], weaker contacts are ignored
CLOSED = 5e-4  # [m], a gripper that is open by less holds nothing
FINGER_SPEED = 0.05  # [m/s] of each finger, as the real hand's
CLOSING_TIME = 1.6  # [s], longer than the fingers ever need
STILL = 2e-4  # [m/s], a slower finger has met something or its end
STILL_STEPS = 30  # after which closing is over
SQUEEZE_STEPS = 36  # in which the force builds up
FRICTION, SPINNING = 1.0, 0.002  # of the fingers: rubber pads; [m] of a small contact patch
GEAR_FORCE, GEAR_STIFFNESS = 200.0, 0.3
OPENING_FORCE = 40.0  # [N]
PEAK = 1.5  # the highest speed of s = 3 t^2 - 2 t^3, in units of the mean one
REACTION_STEPS = 6  # between two looks at the interruption while nothing is commanded: 25 ms
BRAKE_STEPS, AT_REST = 60, 0.02  # at most, until the arm is slower [rad/s] when it is interrupted
SAMPLE_STEPS = 5  # at most, between two samples of a trajectory: 48 a second
MIN_DURATION = 0.12  # [s], of a path
ROUNDING = 0.1  # [s] over which corners, starts and ends are rounded, which bounds the jerk
LEAST_STRETCH = 1.02  # of a path that asks for too much acceleration


class Robot:
    """A robot of one `kind` in a physics engine.

    It stands at the origin. A `MotionInterruptedError` ends motions that the `interruption` stops.
    """

    def __init__(
        self, engine: PhysicsEngine, kind: RobotType, *, interruption: Interruption | None = None
    ) -> None:
        self.engine, self.kind = engine, kind
        self.interruption = interruption or Interruption()
        self.chain = kind.arm
        self.spheres = arm_spheres(self.chain, kind.spheres)
        self._joints = self.chain.names
        # Robot files have inertias that no link of that mass can have (0.1 kg m^2 of each finger of
        # the Panda): the wrist's motors could not follow, and the arm would be off by 0.3 rad.
        engine.bodies.load(NAME, kind.file, fixed=True, inertia_of_shape=True)
        self._efforts = engine.joints.efforts(NAME, self._joints)
        engine.joints.reset(NAME, self._joints, kind.home)
        self._hold_arm(kind.home)
        if kind.gripper:
            engine.joints.add_gear(
                NAME, *kind.gripper.joints, ratio=-1.0, force=GEAR_FORCE, stiffness=GEAR_STIFFNESS
            )
            for link in kind.gripper.links:
                engine.bodies.set_friction(NAME, link, lateral=FRICTION, spinning=SPINNING)
            engine.joints.reset(NAME, kind.gripper.joints, [kind.gripper.opening / 2] * 2)
            self.open(kind.gripper.opening)
        self._all_joints = (*self._joints, *(kind.gripper.joints if kind.gripper else ()))
        self._samples = [self._sample()]

    @property
    def gripper(self) -> Gripper:
        """Its gripper; a `SimulationError` when the robot has none."""
        if self.kind.gripper is None:
            raise SimulationError(f"The {self.kind.label} has no gripper.")
        return self.kind.gripper

    @property
    def joints(self) -> Array:
        """The present posture of the arm (k,) [rad]."""
        return self.engine.joints.positions(NAME, self._joints)

    @property
    def opening(self) -> float:
        """How far the gripper is open [m]."""
        return float(self.engine.joints.positions(NAME, self.gripper.joints).sum())

    @property
    def world_from_hand(self) -> Array:
        """The pose of the hand (4, 4)."""
        return self.engine.bodies.pose(NAME, self.kind.hand)

    @property
    def world_from_grip(self) -> Array:
        """The pose of the grip frame, midway between the pads (4, 4)."""
        return self.world_from_hand @ self.hand_from_grip

    @property
    def hand_from_grip(self) -> Array:
        """The grip frame in the hand frame (4, 4); equal to it without a gripper."""
        return self.kind.gripper.hand_from_grip if self.kind.gripper else np.eye(4)

    @property
    def tip(self) -> float:
        """Z of the finger tips in the grip frame, or of the end of an arm without gripper [m]."""
        ends = self.kind.spheres.get(self.kind.hand, np.zeros((1, 4)))
        return self.kind.gripper.tip if self.kind.gripper else float(ends[:, 2:].sum(axis=1).max())

    def base_from_hand(self, world_from_grip: Array) -> Array:
        """`base_from_hand` for grip poses (..., 4, 4), as targets of inverse kinematics."""
        return world_from_grip @ poses.inverse(self.hand_from_grip)

    def body_spheres(self, opening: float) -> CollisionSpheres:
        """The spheres of arm and hand when the gripper is open by `opening` [m]."""
        if self.kind.gripper is None:
            return self.spheres
        return poses.joined(self.spheres, finger_spheres(self.chain, self.gripper, opening))

    def follow(self, path: Array, *, pace: float, stop: Callable[[], bool] | None = None) -> bool:
        """Execute a path of postures (n, k) [rad] that starts where the arm is.

        The arm moves at `pace`, a share in (0, 1] of the joints' speed limits, and stops when
        `stop`, called at every step, returns true. Returns whether it came to the path's end.
        """
        positions, speeds = self.timed(path, pace=pace)
        for index, (position, speed) in enumerate(zip(positions, speeds, strict=True)):
            if self.interruption.is_requested:
                self.halt()
                rest = np.vstack([self.joints, positions[index:]])
                return self.follow(rest, pace=pace, stop=stop)
            self._hold_arm(position, speed)
            self._step(1)
            if stop is not None and stop():
                self._hold_arm(self.joints)
                return False
        return True

    def timed(self, path: Array, *, pace: float) -> tuple[Array, Array]:
        """Positions and speeds (t, k) of a path (n, k) at each step, as `follow` executes it."""
        return time_path(path, self.chain.speed, self.chain.acceleration, step=TIME_STEP, pace=pace)

    def advance(self, count: int) -> None:
        """Let `count` steps pass while the arm stands still."""
        for done in range(0, count, REACTION_STEPS):
            self.interruption.wait()
            self._step(min(REACTION_STEPS, count - done))

    def halt(self) -> None:
        """Bring the arm to rest, and wait while the interruption is a pause."""
        self._hold_arm(self.joints)
        for _ in range(BRAKE_STEPS):
            self._step(1)
            if np.abs(self.engine.joints.states(NAME, self._joints)[1]).max() < AT_REST:
                break
        self.interruption.wait()

    def open(self, opening: float) -> None:
        """Open the gripper [m]; takes effect as time passes."""
        half = float(np.clip(opening, 0.0, self.gripper.opening)) / 2
        self.engine.bodies.renew_contacts(NAME)  # some would hold the fingers
        self._drive_fingers(FINGER_SPEED, OPENING_FORCE, to=half)

    def close(self, force: float = np.inf) -> None:
        """Close the gripper until it meets something or its end; squeeze by at most `force` [N]."""
        squeeze = -FINGER_SPEED, min(force, self.gripper.force)
        self._drive_fingers(*squeeze)
        still = 0
        for step in range(round(CLOSING_TIME / TIME_STEP)):
            if self.interruption.is_requested:
                self.open(self.opening)
                self.halt()
                self._drive_fingers(*squeeze)
            self._step(1)
            speeds = self.engine.joints.states(NAME, self.gripper.joints)[1]
            still = still + 1 if step > STILL_STEPS and np.abs(speeds).max() < STILL else 0
            if still == STILL_STEPS:
                break
        self.advance(SQUEEZE_STEPS)

    def _drive_fingers(self, speed: float, force: float, to: float | None = None) -> None:
        for joint in self.gripper.joints:
            self.engine.joints.drive_at(NAME, joint, speed, force=force, to=to)

    @property
    def is_holding(self) -> bool:
        """Whether both fingers press on something between them."""
        return self.opening > CLOSED and all(map(self._feels, self.gripper.links))

    def is_touching(self) -> bool:
        """Whether the fingers, or the hand without gripper, touch anything."""
        return any(map(self._feels, self.gripper.links if self.kind.gripper else (self.kind.hand,)))

    def _feels(self, link: str) -> bool:
        found = self.engine.bodies.contacts(NAME, link)
        return any(each.force > MIN_FORCE and each.other != NAME for each in found)

    def force_on_hand(self) -> Array:
        """The force (3,) that the hand exerts, with the arm's own weight, by its motors [N]."""
        torques = self.engine.joints.states(NAME, self._joints)[2]
        jacobian = self.chain.jacobian(self.chain.frames(self.joints[None]))[0, :3]
        return np.linalg.lstsq(jacobian.T, torques, rcond=None)[0]

    def take_trajectory(self) -> str | None:
        """Return where the joints were since the last call, packed; None if no time has passed."""
        now = self._sample()
        table = np.unique([*self._samples, now], axis=0)  # by time, each once
        self._samples = [now]
        return pack(self.kind.name, self._all_joints, table) if len(table) > 1 else None

    def _sample(self) -> Array:
        positions = self.engine.joints.positions(NAME, self._all_joints)
        return np.append(self.engine.steps * TIME_STEP, positions)

    def _step(self, count: int) -> None:
        self.engine.step(count)
        if self.engine.steps % SAMPLE_STEPS < count:
            self._samples.append(self._sample())

    def _hold_arm(self, position: Array, speed: Array | None = None) -> None:
        forces = self._efforts
        self.engine.joints.drive_to(NAME, self._joints, position, forces=forces, speeds=speed)


def time_path(
    points: Array, speed: Array, acceleration: Array, *, step: float, pace: float
) -> tuple[Array, Array]:
    """Parametrise a path of postures (n, k) [rad] by time.

    It uses a share `pace` in (0, 1] of the joints' highest speeds (k,) [rad/s], and no more than
    their accelerations (k,) [rad/s^2]. Returns positions (t, k) [rad] and speeds (t, k) [rad/s] at
    intervals of `step` [s]; the last speeds are zero.
    """
    lengths = np.max(np.abs(np.diff(points, axis=0)) / speed, axis=1)
    along = np.concatenate([[0.0], np.cumsum(lengths)])
    duration = max(MIN_DURATION, PEAK * along[-1] / pace)
    while True:
        t = np.linspace(0.0, 1.0, max(2, int(np.ceil(duration / step))) + 1)[1:]
        where = along[-1] * t * t * (3 - 2 * t)
        exact = np.column_stack([np.interp(where, along, column) for column in points.T])
        positions = _rounded(exact, points[0], max(1, round(ROUNDING / step / 2)))
        speeds = np.diff(positions, axis=0, prepend=points[:1]) / step
        speeds[-1] = 0.0
        changes = np.diff(speeds, axis=0, prepend=0 * points[:1]) / step
        if (excess := float(np.max(np.abs(changes) / acceleration))) <= 1:
            return positions, speeds
        duration *= max(LEAST_STRETCH, excess**0.5)


def _rounded(positions: Array, start: Array, half: int) -> Array:
    before, after = (np.repeat(end[None], 2 * half, axis=0) for end in (start, positions[-1]))
    total = np.cumsum(np.vstack([0 * start[None], before, positions, after]), axis=0)
    window = 2 * half + 1
    return np.vstack([(total[window:] - total[:-window]) / window, positions[-1:]])


def resample(positions: Array, spacing: float) -> Array:
    """Those of the positions (t, k) that a joint is `spacing` [rad] apart, and both ends."""
    turned = np.append(0.0, np.cumsum(np.abs(np.diff(positions, axis=0)).max(axis=1)))
    return positions[[*np.searchsorted(turned, np.arange(0.0, turned[-1], spacing)), -1]]
