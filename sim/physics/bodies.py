"""Rigid bodies and their joints by name: loaded, placed, driven, and asked what they touch.

A body's frame is the frame of its URDF, not the centre of mass that PyBullet uses.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeVar

import numpy as np

from ...ontology.errors import SimulationError, UnknownNameError
from .. import poses
from ..poses import Array
from .pybullet_client import PhysicsClient, quiet

BASE = -1  # PyBullet's index of a body's first link
GAIN = 0.3  # of the error of position, corrected in one step: below a millimetre at full pace
_T = TypeVar("_T")


@dataclass(frozen=True)
class Contact:
    """What the body touches that was asked for, and with which force along the normal [N]."""

    other: str
    other_link: str
    force: float


@dataclass(frozen=True)
class _BodyRecord:
    number: int
    links: dict[str, int]
    joints: dict[str, int]
    com_from_base: Array  # (4, 4), its frame seen from its centre of mass


class Bodies:
    """The bodies in one simulator; `links` has the names by PyBullet's numbers of body and link."""

    def __init__(self, client: PhysicsClient) -> None:
        self._client = client
        self._records: dict[str, _BodyRecord] = {}
        self.links: dict[tuple[int, int], tuple[str, str]] = {}

    def load(
        self,
        name: str,
        urdf: Path,
        world_from_base: Array | None = None,
        *,
        fixed: bool = False,
        inertia_of_shape: bool = False,
    ) -> None:
        """Put a body described by a URDF file into the world, at the origin unless a pose is given.

        The pose is that of its URDF frame. What is `fixed` stays, whatever pushes it. With
        `inertia_of_shape`, inertias follow from masses and shapes of the links, not from the file.
        """
        if name in self._records:
            raise SimulationError(f'There already is a body "{name}".')
        flags = 0 if inertia_of_shape else self._client.constant("URDF_USE_INERTIA_FROM_FILE")
        with quiet():
            number: int = self._client.call("loadURDF", str(urdf), useFixedBase=fixed, flags=flags)
        self._records[name] = record = self._read_record(number)
        self.links |= {(number, index): (name, link) for link, index in record.links.items()}
        self.place(name, np.eye(4) if world_from_base is None else world_from_base)

    def _read_record(self, number: int) -> _BodyRecord:
        base = self._client.call("getBodyInfo", number)[0].decode()
        inertial = self._client.call("getDynamicsInfo", number, BASE)
        links, joints = {base: BASE}, dict[str, int]()
        for index in range(self._client.call("getNumJoints", number)):
            info = self._client.call("getJointInfo", number, index)
            joints[info[1].decode()] = links[info[12].decode()] = index
        base_from_com = self.world_pose(inertial[3], inertial[4])
        return _BodyRecord(number, links, joints, poses.inverse(base_from_com))

    def world_pose(self, position: Sequence[float], quaternion: Sequence[float]) -> Array:
        """Return the pose at a position (3,) [m] with a unit quaternion in the order x, y, z, w."""
        rotation = self._client.call("getMatrixFromQuaternion", quaternion)
        return poses.pose(np.reshape(rotation, (3, 3)), position)

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all bodies, in the order in which they were loaded."""
        return tuple(self._records)

    def pose(self, body: str, link: str | None = None) -> Array:
        """`world_from_link` of a link's URDF frame; of the base when `link` is None."""
        number, index = self.link_id(body, link)
        if index == BASE:
            return self.centre_of_mass(body) @ self._record(body).com_from_base
        state = self._client.call("getLinkState", number, index, computeForwardKinematics=1)
        return self.world_pose(state[4], state[5])

    def place_of(self, body: str, link: str) -> tuple[float, ...]:
        """Return x y z [m] and quaternion x y z w of a link's URDF frame in the world."""
        number, index = self.link_id(body, link)
        if index == BASE:
            base = self.pose(body)
            return *base[:3, 3], *poses.quaternion(base[:3, :3])
        state = self._client.call("getLinkState", number, index, computeForwardKinematics=1)
        return *state[4], *state[5]

    def place(self, body: str, world_from_base: Array) -> None:
        """Move a body to a pose, at rest."""
        record = self._record(body)
        world_from_com = world_from_base @ poses.inverse(record.com_from_base)
        at = world_from_com[:3, 3], poses.quaternion(world_from_com[:3, :3])
        self._client.call("resetBasePositionAndOrientation", record.number, *at)
        self._client.call("resetBaseVelocity", record.number, (0, 0, 0), (0, 0, 0))

    def bounds(self, body: str, link: str) -> Array:
        """The lowest and the highest corner (2, 3) of a link's axis-aligned bounding box [m]."""
        return np.array(self._client.call("getAABB", *self.link_id(body, link)))

    def contacts(self, body: str, link: str | None = None) -> tuple[Contact, ...]:
        """A body's contacts in the last step: of one link, if it is given."""
        number, index = self.link_id(body, link)
        options = {} if link is None else {"linkIndexA": index}
        found = self._client.call("getContactPoints", number, **options)
        return tuple(Contact(*self.links[raw[2], raw[4]], raw[9]) for raw in found)

    def set_friction(self, body: str, link: str | None = None, **coefficients: float) -> None:
        """Set friction coefficients of a link, or of all links when `link` is None.

        `lateral` is that of sliding; between two surfaces the product counts. `spinning` and
        `rolling` are the resistances against turning on the spot and rolling [m].
        """
        options = {f"{kind}Friction": value for kind, value in coefficients.items()}
        for number, index in self.link_ids(body, link):
            self._client.call("changeDynamics", number, index, **options)

    def ignore_contacts(self, body: str, other: str) -> None:
        """Let two bodies pass through each other from now on."""
        for number, link in self.link_ids(body):
            for another, its_link in self.link_ids(other):
                self._client.call("setCollisionFilterPair", number, another, link, its_link, 0)

    def renew_contacts(self, body: str) -> None:
        """Find the contacts of a body anew: PyBullet keeps some that pull in place of pushing."""
        for raw in self._client.call("getContactPoints", self.link_id(body)[0]):
            if raw[1] != raw[2]:
                self._client.call("setCollisionFilterPair", *raw[1:5], 1)

    def put_to_sleep(self, body: str) -> None:
        """Leave a body out while it is still and untouched; what a hand holds never sleeps."""
        for state in ("ENABLE_SLEEPING", "SLEEP"):
            constant = self._client.constant(f"ACTIVATION_STATE_{state}")
            self._client.call("changeDynamics", *self.link_id(body), activationState=constant)

    def link_id(self, body: str, link: str | None = None) -> tuple[int, int]:
        """PyBullet's numbers of a body and one of its links; the base when `link` is None."""
        record = self._record(body)
        return record.number, BASE if link is None else _find(link, record.links, f"link of {body}")

    def link_ids(self, body: str, link: str | None = None) -> Iterable[tuple[int, int]]:
        """PyBullet's numbers of a body and a link; of each of its links when `link` is None."""
        links = self._record(body).links if link is None else (link,)
        return [self.link_id(body, each) for each in links]

    def joint_ids(self, body: str, joints: Sequence[str]) -> tuple[int, list[int]]:
        """PyBullet's numbers of a body and of some of its joints."""
        record = self._record(body)
        return record.number, [_find(each, record.joints, f"joint of {body}") for each in joints]

    def centre_of_mass(self, body: str) -> Array:
        """`world_from_com` of a body's base: PyBullet's own frame of it."""
        number = self._record(body).number
        return self.world_pose(*self._client.call("getBasePositionAndOrientation", number))

    def _record(self, name: str) -> _BodyRecord:
        return _find(name, self._records, "body")


class Joints:
    """The joints of bodies, their motors, and joints between bodies."""

    def __init__(self, client: PhysicsClient, bodies: Bodies) -> None:
        self._client, self._bodies = client, bodies

    def positions(self, body: str, joints: Sequence[str]) -> Array:
        """Positions of joints [rad] or [m], shape (len(joints),)."""
        return self.states(body, joints)[0]

    def states(self, body: str, joints: Sequence[str]) -> Array:
        """Positions [rad] or [m], speeds [rad/s] or [m/s], torques [N m], shape (3, len(joints)).

        The torques are what the motors of the joints applied in the last step.
        """
        states = self._client.call("getJointStates", *self._bodies.joint_ids(body, joints))
        return np.array([(position, speed, torque) for position, speed, _, torque in states]).T

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
        speeds: Sequence[float] | Array | None = None,
    ) -> None:
        """Let motors hold joints at positions from now on.

        Positions are in [rad] or [m]; `forces` limit each motor [Nm] or [N]. The target speeds are
        zero when None, otherwise in [rad/s] or [m/s]; their error is corrected wholly in one step.
        """
        count = len(joints)
        self._client.call(
            "setJointMotorControlArray",
            *self._bodies.joint_ids(body, joints),
            self._client.constant("POSITION_CONTROL"),
            targetPositions=positions,
            targetVelocities=[0.0] * count if speeds is None else speeds,
            forces=forces,
            positionGains=[GAIN] * count,
            velocityGains=[1.0] * count,
        )

    def drive_at(
        self, body: str, joint: str, speed: float, *, force: float, to: float | None = None
    ) -> None:
        """Let a motor turn a joint at a speed [rad/s] or [m/s], up to a position `to` if given."""
        number, (index,) = self._bodies.joint_ids(body, [joint])
        limit = {"targetPosition": to, "maxVelocity": speed}
        options = {"targetVelocity": speed} if to is None else limit
        mode = self._client.constant("VELOCITY_CONTROL" if to is None else "POSITION_CONTROL")
        self._client.call("setJointMotorControl2", number, index, mode, force=force, **options)

    def add_gear(
        self, body: str, joint: str, other: str, *, ratio: float, force: float, stiffness: float
    ) -> None:
        """Couple two joints of one body, as the fingers of a gripper are coupled.

        The link of `joint` carries the gear, which turns the other one and transmits a force [N] at
        most. A ratio of -1 makes two fingers that face each other move alike. The stiffness is the
        share of the difference that is corrected in one step, in [0, 1].
        """
        number, (index, turned) = self._bodies.joint_ids(body, [joint, other])
        axis = self._client.call("getJointInfo", number, index)[13]
        links, options = (number, index, number, turned), {"gearRatio": ratio, "erp": stiffness}
        self._join("GEAR", links, axis, np.eye(4), np.eye(4), maxForce=force, **options)

    def fix_bodies(self, body: str, other: str, *, force: float) -> None:
        """Join the bases of two bodies by a fixed joint that bears at most `force` [N]."""
        world_from_other = self._bodies.centre_of_mass(other)
        other_from_body = poses.inverse(world_from_other) @ self._bodies.centre_of_mass(body)
        bases = (*self._bodies.link_id(other), *self._bodies.link_id(body))
        self._join("FIXED", bases, (0, 0, 0), other_from_body, np.eye(4), maxForce=force)

    def tether(self, body: str, at: Array, *, force: float, torque: float) -> Sequence[int]:
        """Hold a body at a point (3,) [m] as a person does; return the joints.

        They bear at most `force` [N] there, and `torque` [N m], as its direction is held, too.
        """
        joint, links = poses.translation(*at), (*self._bodies.link_id(body), BASE, BASE)
        places = (0, 0, 0), poses.inverse(self._bodies.centre_of_mass(body)) @ joint, joint
        bears = {"POINT2POINT": force, "FIXED": torque}
        awake = self._client.constant("ACTIVATION_STATE_DISABLE_SLEEPING")
        self._client.call("changeDynamics", *links[:2], activationState=awake)
        return [self._join(kind, links, *places, maxForce=limit) for kind, limit in bears.items()]

    def move_tether(self, tether: Sequence[int], position: Array) -> None:
        """Move a tether to where its point of the body shall be (3,) [m]."""
        for joint in tether:
            self._client.call("changeConstraint", joint, jointChildPivot=position)

    def untie(self, tether: Sequence[int]) -> None:
        """Let go of what a tether holds."""
        for joint in tether:
            self._client.call("removeConstraint", joint)

    def _join(
        self,
        kind: str,
        links: Sequence[int],
        axis: Sequence[float],
        parent_from_joint: Array,
        child_from_joint: Array,
        **options: float,
    ) -> int:
        joint: int = self._client.call(
            "createConstraint",
            *links,
            jointType=self._client.constant(f"JOINT_{kind}"),
            jointAxis=axis,
            parentFramePosition=parent_from_joint[:3, 3],
            childFramePosition=child_from_joint[:3, 3],
            parentFrameOrientation=poses.quaternion(parent_from_joint[:3, :3]),
            childFrameOrientation=poses.quaternion(child_from_joint[:3, :3]),
        )
        self._client.call("changeConstraint", joint, **options)
        return joint


def _find(name: str, known: Mapping[str, _T], kind: str) -> _T:
    if name not in known:
        raise UnknownNameError(kind, name, known)
    return known[name]
