"""Forward and inverse kinematics of an arm, vectorised over postures and targets.

A `KinematicChain` is read from the URDF file of a robot. `solve` is damped least squares (Wampler
1986) from several starts: a step is dq = J^T (J J^T + d^2 I)^-1 e, with the pose error e =
(position, rotation vector) and a damping d that grows with the error, so that steps stay short near
singular postures. Every solution is checked against its target and the joint limits.
"""

from dataclasses import dataclass
from functools import cached_property, partial
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from ...ontology.errors import DataError
from .. import poses
from ..models.urdf import child_attribute, child_triple, origin_pose, read_urdf
from ..poses import Array

POSITION_TOLERANCE = 2e-4  # [m], far below what a grasp needs, reached in 10 to 30 steps
ROTATION_TOLERANCE = 2e-3  # [rad]
MAX_STEPS = 50  # from a distant start; targets that need more are mostly out of reach
TRACK_STEPS = 15  # from the previous pose of a path
MAX_STEP = 0.4  # [rad] of a joint, within which the linearisation holds
MAX_JUMP = 0.5  # [rad] between two poses of a path; more is another branch of solutions
DAMPING = 0.03  # of a distant target; near the target it falls to a tenth
ERROR_SCALE = 0.3  # [m], an error of this size is a distant target


@dataclass(frozen=True)
class IkSolutions:
    """Solutions of inverse kinematics for m targets."""

    joints: Array  #: the best postures (m, k) within the limits [rad]; (m, t, k) for paths
    found: np.ndarray  #: whether each posture reaches its target within the tolerances (m,), bool


@dataclass(frozen=True, eq=False)
class KinematicChain:
    """The n joints from a robot's base to its tip, of which k move, as in the URDF."""

    links: tuple[str, ...]  #: names of the links behind the joints
    names: tuple[str, ...]  #: names of the joints that move
    moves: np.ndarray  #: whether each joint moves (n,)
    turns: Array  #: 1 for each revolute joint, 0 for each prismatic one (k, 1)
    parent_from_joint: Array  #: pose of each joint on the link before it (n, 4, 4)
    axes: Array  #: unit axes of the joints that move, in their own frames (k, 3)
    low: Array  #: lower limits (k,) [rad] or [m]
    high: Array  #: upper limits
    speed: Array  #: highest speeds (k,) [rad/s] or [m/s]
    acceleration: Array  #: highest accelerations (k,) [rad/s^2] or [m/s^2]

    @cached_property
    def _terms(self) -> tuple[Array, Array, Array, Array]:
        """The factors (n, 4, 4) in `frames` of 1, the sine, 1 - cosine, and the joint value."""
        constant = self.parent_from_joint
        sine, cosine, value = (np.zeros_like(constant) for _ in range(3))
        rotation = constant[self.moves, :3, :3]
        cross = self.turns[..., None] * np.cross(np.eye(3), self.axes[:, None])
        sine[self.moves, :3, :3] = rotation @ cross
        cosine[self.moves, :3, :3] = rotation @ cross @ cross
        value[self.moves, :3, 3] = np.einsum("kij,kj->ki", rotation, (1 - self.turns) * self.axes)
        return constant, sine, cosine, value

    def frames(self, joints: Array) -> Array:
        """`base_from_link` (m, n, 4, 4) of each link, for joints (m, k)."""
        constant, sine, cosine, value = self._terms
        values = np.zeros((len(joints), len(self.links), 1, 1))
        values[:, self.moves, 0, 0] = joints
        # Rodrigues for all joints at once: R = 1 + sin K + (1 - cos) K^2.
        result = constant + np.sin(values) * sine + (1 - np.cos(values)) * cosine + values * value
        for index in range(1, len(self.links)):
            result[:, index] = result[:, index - 1] @ result[:, index]
        return result

    def forward(self, joints: Array) -> Array:
        """`base_from_tip` (m, 4, 4) for joints (m, k)."""
        return self.frames(joints)[:, -1]

    def jacobian(self, frames: Array) -> Array:
        """The Jacobian (m, 6, k) of tip position and rotation, from `frames`."""
        moving = frames[:, self.moves]
        axes = np.einsum("nkij,kj->nki", moving[..., :3, :3], self.axes)
        sweep = np.cross(axes, frames[:, -1:, :3, 3] - moving[..., :3, 3])
        linear = self.turns * sweep + (1 - self.turns) * axes
        return np.swapaxes(np.concatenate([linear, self.turns * axes], axis=-1), 1, 2)

    def solve(self, base_from_tip: Array, starts: Array) -> IkSolutions:
        """Solve for targets (m, 4, 4) from postures (s, k): what is nearest to the first."""
        m, s = len(base_from_tip), len(starts)
        joints = np.clip(np.tile(starts, (m, 1)), self.low, self.high)
        error = self._descend(joints, np.repeat(base_from_tip, s, axis=0))
        found = _is_small(error).reshape(m, s)
        far = np.abs(joints - starts[0]).max(axis=1).reshape(m, s)
        best = np.argmin(np.where(found, far, 1e3 + np.linalg.norm(error, axis=1).reshape(m, s)), 1)
        rows = np.arange(m)
        return IkSolutions(joints.reshape(m, s, starts.shape[1])[rows, best], found[rows, best])

    def _descend(self, joints: Array, targets: Array, *, steps: int = MAX_STEPS) -> Array:
        """Improve `joints` (n, k) in place; return the remaining errors (n, 6)."""
        error = np.empty((len(joints), 6))
        busy = np.arange(len(joints))
        for _ in range(steps):
            frames = self.frames(joints[busy])
            error[busy] = pose_error(frames[:, -1], targets[busy])
            unfinished = ~_is_small(error[busy])
            busy, frames = busy[unfinished], frames[unfinished]
            if not len(busy):
                break
            step = _damped_step(self.jacobian(frames), error[busy])
            joints[busy] = np.clip(joints[busy] + step, self.low, self.high)
        return error

    def track(self, base_from_tip: Array, starts: Array) -> IkSolutions:
        """Solve along m paths of t poses (m, t, 4, 4), from `starts` (m, k) [rad], pose after pose.

        A path is found when all its poses are, without a jump.
        """
        joints, path = starts.copy(), []
        found = np.ones(len(starts), dtype=bool)
        for step in range(base_from_tip.shape[1]):
            rows = np.flatnonzero(found)  # lost paths are not followed any longer
            after = joints[rows]
            error = self._descend(after, base_from_tip[rows, step], steps=TRACK_STEPS)
            near = np.abs(after - joints[rows]).max(axis=1, initial=0.0) < MAX_JUMP
            found[rows] = _is_small(error) & near
            joints[rows] = after
            path.append(joints.copy())
        return IkSolutions(np.stack(path, axis=1), found)


def pose_error(base_from_tip: Array, base_from_target: Array) -> Array:
    """Position [m] and rotation vector [rad] (n, 6) from the tip to the target."""
    turn = base_from_target[:, :3, :3] @ np.swapaxes(base_from_tip[:, :3, :3], 1, 2)
    shift = base_from_target[:, :3, 3] - base_from_tip[:, :3, 3]
    return np.concatenate([shift, poses.rotation_vector(turn)], axis=1)


def read_chain(path: Path, tip: str) -> KinematicChain:
    """Read the chain of a URDF file from its root to the link `tip`; `DataError` without one."""
    root = read_urdf(path)
    above = {child_attribute(each, "child", "link"): each for each in root.findall("joint")}
    elements, link = list[ElementTree.Element](), tip
    while link in above:
        elements.insert(0, above[link])
        link = child_attribute(above[link], "parent", "link")
    if not elements:
        raise DataError(f'expected a joint that leads to a link "{tip}".', source=str(path))
    kinds = [each.get("type", "fixed") for each in elements]
    moving = [each for each, kind in zip(elements, kinds, strict=True) if kind != "fixed"]
    axes = np.array([child_triple(each, "axis", "xyz", default="1 0 0") for each in moving])
    low, high, speed = np.array([_limits(each) for each in moving]).T
    return KinematicChain(
        links=tuple(child_attribute(each, "child", "link") for each in elements),
        names=tuple(each.get("name", "") for each in moving),
        moves=np.array([kind != "fixed" for kind in kinds]),
        turns=np.array([[float(each.get("type") != "prismatic")] for each in moving]),
        parent_from_joint=np.stack([origin_pose(each) for each in elements]),
        axes=axes / np.linalg.norm(axes, axis=1, keepdims=True),
        low=low,
        high=high,
        speed=speed,
        acceleration=np.full(len(moving), np.inf),  # URDF has none
    )


def _damped_step(jacobian: Array, error: Array) -> Array:
    size = np.minimum(np.linalg.norm(error, axis=1) / ERROR_SCALE, 1.0)
    damping = DAMPING * np.maximum(size, 0.1)
    normal = jacobian @ np.swapaxes(jacobian, 1, 2)  # (n, 6, 6)
    normal += (damping**2)[:, None, None] * np.eye(6)
    step = np.einsum("nik,ni->nk", jacobian, np.linalg.solve(normal, error[..., None])[..., 0])
    longest = np.abs(step).max(axis=1, keepdims=True)
    return step * np.minimum(1.0, MAX_STEP / np.maximum(longest, 1e-12))


def _is_small(error: Array) -> np.ndarray:
    sizes = np.linalg.norm(error.reshape(-1, 2, 3), axis=2)
    return (sizes < (POSITION_TOLERANCE, ROTATION_TOLERANCE)).all(axis=1)


def _limits(joint: ElementTree.Element) -> tuple[float, float, float]:
    limit, safety = (partial(child_attribute, joint, c) for c in ("limit", "safety_controller"))
    low = safety("soft_lower_limit") or limit("lower") or -np.pi
    high = safety("soft_upper_limit") or limit("upper") or np.pi
    return float(low), float(high), float(limit("velocity") or 1.0)
