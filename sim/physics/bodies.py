# SPDX-License-Identifier: Apache-2.0
"""Bodies by name: loaded from URDF files, surveyed once, and put where they should be.

A body's frame is the frame of its URDF, not the centre of mass that PyBullet uses.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from ...ontology.errors import SimulationError, UnknownNameError
from .. import poses
from ..poses import Array
from .client import Simulator
from .silence import quiet
from .types import JointState

BASE = -1  # PyBullet's number of a body's first link
_JOINT_KINDS = {0: "revolute", 1: "prismatic", 4: "fixed"}


@dataclass
class RigidBodies:
    """What is known of a body: PyBullet's numbers of it and of its links and joints.

    Attributes:
        number: of the body.
        links: name -> number.
        joints: name -> number.
        facts: name -> the joint as its URDF describes it.
        com_from_base: where its frame is, seen from its centre of mass (4, 4).
    """

    number: int
    links: dict[str, int]
    joints: dict[str, int]
    facts: dict[str, JointState]
    com_from_base: Array = field(default_factory=lambda: np.eye(4))


class Bodies(Simulator):
    """A simulator whose bodies, links and joints have names."""

    def __init__(self, *, gui: bool = False) -> None:
        super().__init__(gui=gui)
        self._bodies: dict[str, RigidBodies] = {}
        self._names: dict[int, str] = {}

    def load(
        self,
        name: str,
        urdf: Path,
        world_from_base: Array | None = None,
        *,
        fixed: bool = False,
        inertia_of_shape: bool = False,
    ) -> None:
        """Put a body described by a URDF file into the world.

        Args:
            name: by which it is known from now on.
            urdf: its description.
            world_from_base: where its URDF frame is; the origin when None.
            fixed: whether it stays where it is, whatever pushes it.
            inertia_of_shape: whether how hard its links are to turn follows from their masses and
                shapes, and not from what the file says.
        """
        if name in self._bodies:
            raise SimulationError(f'There already is a body "{name}".')
        flags = 0 if inertia_of_shape else self._p.URDF_USE_INERTIA_FROM_FILE
        with quiet():
            number: int = self._call("loadURDF", str(urdf), useFixedBase=fixed, flags=flags)
        self._bodies[name] = self._survey(number)
        self._names[number] = name
        self.place(name, np.eye(4) if world_from_base is None else world_from_base)

    def _survey(self, number: int) -> RigidBodies:
        base = self._call("getBodyInfo", number)[0].decode()
        inertial = self._call("getDynamicsInfo", number, BASE)
        body = RigidBodies(
            number,
            {base: BASE},
            {},
            {},
            poses.inverse(poses.from_quaternion(inertial[3], inertial[4])),
        )
        names = {BASE: base}
        for index in range(self._call("getNumJoints", number)):
            info = self._call("getJointInfo", number, index)
            joint, link = info[1].decode(), info[12].decode()
            names[index] = link
            body.links[link], body.joints[joint] = index, index
            body.facts[joint] = JointState(
                joint,
                link,
                names[info[16]],
                _JOINT_KINDS.get(info[2], "other"),
                (info[8], info[9]),
                info[11],
                info[10],
                info[13],
            )
        return body

    def remove(self, name: str) -> None:
        """Take a body out of the world."""
        self._call("removeBody", self._body(name).number)
        del self._names[self._bodies.pop(name).number]

    @property
    def bodies(self) -> tuple[str, ...]:
        """The names of all bodies, in the order in which they were loaded."""
        return tuple(self._bodies)

    def links(self, body: str) -> tuple[str, ...]:
        """The names of a body's links, the base first."""
        return tuple(self._body(body).links)

    def joints(self, body: str) -> tuple[JointState, ...]:
        """A body's joints, fixed ones included, in the order of its URDF."""
        return tuple(self._body(body).facts.values())

    def _body(self, name: str) -> RigidBodies:
        if name not in self._bodies:
            raise UnknownNameError("body", name, self._bodies)
        return self._bodies[name]

    def _link(self, body: str, link: str | None) -> tuple[int, int]:
        found = self._body(body)
        if link is None:
            return found.number, BASE
        if link not in found.links:
            raise UnknownNameError(f"link of {body}", link, found.links)
        return found.number, found.links[link]

    def _joint(self, body: str, joint: str) -> tuple[int, int]:
        found = self._body(body)
        if joint not in found.joints:
            raise UnknownNameError(f"joint of {body}", joint, found.joints)
        return found.number, found.joints[joint]

    def pose(self, body: str, link: str | None = None) -> Array:
        """`world_from_link` of a link's URDF frame; of the base when `link` is None."""
        number, index = self._link(body, link)
        if index == BASE:
            position, quaternion = self._call("getBasePositionAndOrientation", number)
            return poses.from_quaternion(position, quaternion) @ self._body(body).com_from_base
        state = self._call("getLinkState", number, index, computeForwardKinematics=1)
        return poses.from_quaternion(state[4], state[5])

    def place(self, body: str, world_from_base: Array) -> None:
        """Put a body somewhere, at rest."""
        found = self._body(body)
        world_from_com = world_from_base @ poses.inverse(found.com_from_base)
        quaternion = poses.quaternion(world_from_com[:3, :3])
        self._call(
            "resetBasePositionAndOrientation", found.number, world_from_com[:3, 3], quaternion
        )
        self._call("resetBaseVelocity", found.number, (0, 0, 0), (0, 0, 0))

    def speed(self, body: str) -> tuple[float, float]:
        """How fast a body's base moves [m/s] and turns [rad/s]."""
        linear, angular = self._call("getBaseVelocity", self._body(body).number)
        return float(np.linalg.norm(linear)), float(np.linalg.norm(angular))

    def _centre(self, body: str) -> Array:
        """`world_from_com` of a body's base: PyBullet's own frame of it."""
        return self.pose(body) @ poses.inverse(self._body(body).com_from_base)

    def _link_name(self, body: str, index: int) -> str:
        links = self._bodies[body].links
        return next(name for name, each in links.items() if each == index)
