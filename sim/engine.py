# SPDX-License-Identifier: Apache-2.0
"""The physics engine behind names: the only module that knows PyBullet.

An `Engine` owns one simulator. It speaks of bodies, links and joints by name, of poses as 4 x 4
matrices (`world_from_link`), and of lengths, angles and forces in [m], [rad], [N]. A body's frame
is the frame of its URDF, not the centre of mass that PyBullet uses.
"""

from __future__ import annotations

import ctypes
import os
from collections import Counter
from collections.abc import Generator, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from types import TracebackType
from typing import Any

import numpy as np

from ..ontology.errors import MissingExtraError, SimulationError, UnknownNameError
from . import poses
from .display import refuse_no_display
from .poses import Array
from .readings import Contact, Hit, Image, Joint, Light

TIME_STEP = 1 / 240  # [s]
SOLVER_ITERATIONS = 200  # fewer let a grasped object creep (measured: 2 mm instead of 8)
SOLVED = 1e-6  # an error of speed [m/s] below which the iterations end sooner
CONTACT_BREAKING = 0.004  # [m] from which on there is a contact to solve; 0.02 doubles their number
GRAVITY = 9.81  # [m/s^2]
BASE = -1  # PyBullet's number of a body's first link
NO_BODY = -1
LINK_SHIFT = 24  # the mask packs body + ((link + 1) << 24) into one number


@dataclass
class _Body:
    number: int
    links: dict[str, int]
    joints: dict[str, int]
    facts: dict[str, Joint]
    com_from_base: Array = field(default_factory=lambda: np.eye(4))


_JOINT_KINDS = {0: "revolute", 1: "prismatic", 4: "fixed"}


class Engine:
    """One physics simulator, spoken to by names.

    Use it in a `with` block, or `close` it. Several can live in one process.
    """

    def __init__(self, *, gui: bool = False) -> None:
        self._p: Any = _import_pybullet()
        if gui:
            refuse_no_display()
        with _quiet():
            self._client: int = self._p.connect(self._p.GUI if gui else self._p.DIRECT)
        if self._client < 0:
            raise SimulationError("PyBullet cannot open a window. Run without --gui.")
        self.gui = gui
        self._bodies: dict[str, _Body] = {}
        self._names: dict[int, str] = {}
        self.steps = 0
        self._configure()

    def _configure(self) -> None:
        self._call("setGravity", 0, 0, -GRAVITY)
        self._call(
            "setPhysicsEngineParameter",
            fixedTimeStep=TIME_STEP,
            numSolverIterations=SOLVER_ITERATIONS,
            solverResidualThreshold=SOLVED,
            contactBreakingThreshold=CONTACT_BREAKING,
            deterministicOverlappingPairs=1,
        )
        if self.gui:
            self._call("configureDebugVisualizer", self._p.COV_ENABLE_GUI, 0)
            self._call("resetDebugVisualizerCamera", 1.35, 60, -28, (0.35, 0.0, 0.05))

    def _call(self, function: str, *args: Any, **options: Any) -> Any:
        if self._client < 0:
            raise SimulationError("The simulator is closed.")
        try:
            return getattr(self._p, function)(*args, **options, physicsClientId=self._client)
        except self._p.error as error:
            raise SimulationError(f"PyBullet refuses {function}: {error}") from error

    def close(self) -> None:
        """Stop the simulator; closing twice is allowed."""
        if self._client >= 0:
            self._call("disconnect")
            self._client = -1

    def __enter__(self) -> Engine:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    # --- bodies -------------------------------------------------------------------------------

    def load(
        self, name: str, urdf: Path, world_from_base: Array | None = None, *, fixed: bool = False
    ) -> None:
        """Put a body described by a URDF file into the world.

        Args:
            name: by which it is known from now on.
            urdf: its description.
            world_from_base: where its URDF frame is; the origin when None.
            fixed: whether it stays where it is, whatever pushes it.
        """
        if name in self._bodies:
            raise SimulationError(f'There already is a body "{name}".')
        with _quiet():
            number: int = self._call(
                "loadURDF", str(urdf), useFixedBase=fixed, flags=self._p.URDF_USE_INERTIA_FROM_FILE
            )
        self._bodies[name] = self._survey(number)
        self._names[number] = name
        self.place(name, np.eye(4) if world_from_base is None else world_from_base)

    def _survey(self, number: int) -> _Body:
        base = self._call("getBodyInfo", number)[0].decode()
        inertial = self._call("getDynamicsInfo", number, BASE)
        body = _Body(number, {base: BASE}, {}, {}, poses.inverse(_pose(inertial[3], inertial[4])))
        names = {BASE: base}
        for index in range(self._call("getNumJoints", number)):
            info = self._call("getJointInfo", number, index)
            joint, link = info[1].decode(), info[12].decode()
            names[index] = link
            body.links[link], body.joints[joint] = index, index
            body.facts[joint] = Joint(
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

    def joints(self, body: str) -> tuple[Joint, ...]:
        """A body's joints, fixed ones included, in the order of its URDF."""
        return tuple(self._body(body).facts.values())

    def _body(self, name: str) -> _Body:
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

    # --- poses --------------------------------------------------------------------------------

    def pose(self, body: str, link: str | None = None) -> Array:
        """`world_from_link` of a link's URDF frame; of the base when `link` is None."""
        number, index = self._link(body, link)
        if index == BASE:
            position, quaternion = self._call("getBasePositionAndOrientation", number)
            return _pose(position, quaternion) @ self._body(body).com_from_base
        state = self._call("getLinkState", number, index, computeForwardKinematics=1)
        return _pose(state[4], state[5])

    def place(self, body: str, world_from_base: Array) -> None:
        """Put a body somewhere, at rest."""
        found = self._body(body)
        world_from_com = world_from_base @ poses.inverse(found.com_from_base)
        quaternion = _quaternion(world_from_com[:3, :3])
        self._call(
            "resetBasePositionAndOrientation", found.number, world_from_com[:3, 3], quaternion
        )
        self._call("resetBaseVelocity", found.number, (0, 0, 0), (0, 0, 0))

    def speed(self, body: str) -> tuple[float, float]:
        """How fast a body's base moves [m/s] and turns [rad/s]."""
        linear, angular = self._call("getBaseVelocity", self._body(body).number)
        return float(np.linalg.norm(linear)), float(np.linalg.norm(angular))

    # --- joints and motors --------------------------------------------------------------------

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
        indices = [self._joint(body, joint)[1] for joint in joints]
        states = self._call("getJointStates", self._body(body).number, indices)
        return np.array([state[column] for state in states])

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
            self._body(body).number,
            [self._joint(body, joint)[1] for joint in joints],
            self._p.POSITION_CONTROL,
            targetPositions=[float(v) for v in positions],
            targetVelocities=[0.0] * count if speeds is None else [float(v) for v in speeds],
            forces=[float(v) for v in forces],
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
            parentFrameOrientation=_quaternion(other_from_body[:3, :3]),
        )
        self._call("changeConstraint", constraint, maxForce=force)

    def _centre(self, body: str) -> Array:
        """`world_from_com` of a body's base: PyBullet's own frame of it."""
        return self.pose(body) @ poses.inverse(self._body(body).com_from_base)

    # --- matter -------------------------------------------------------------------------------

    def set_surface(
        self,
        body: str,
        link: str | None = None,
        *,
        friction: float | None = None,
        spinning: float | None = None,
        rolling: float | None = None,
        bounce: float | None = None,
    ) -> None:
        """Set how a link's surface behaves; of all links when `link` is None.

        Args:
            body: whose.
            link: which one.
            friction: lateral coefficient; the product of both surfaces counts.
            spinning: resistance against turning on the spot [m].
            rolling: resistance against rolling [m].
            bounce: restitution in [0, 1].
        """
        wanted = {
            "lateralFriction": friction,
            "spinningFriction": spinning,
            "rollingFriction": rolling,
            "restitution": bounce,
        }
        options = {key: value for key, value in wanted.items() if value is not None}
        for each in self.links(body) if link is None else (link,):
            self._call("changeDynamics", *self._link(body, each), **options)

    def set_damping(self, body: str, *, linear: float, angular: float) -> None:
        """Set how much a body's motion is damped, as shares of its speed per second."""
        self._call(
            "changeDynamics",
            self._body(body).number,
            BASE,
            linearDamping=linear,
            angularDamping=angular,
        )

    def ignore_contacts(self, body: str, link: str, other: str, other_link: str) -> None:
        """Let two links pass through each other from now on."""
        number, index = self._link(body, link)
        other_number, other_index = self._link(other, other_link)
        self._call("setCollisionFilterPair", number, other_number, index, other_index, 0)

    def reckon_contacts(self, body: str, other: str, *, wanted: bool) -> None:
        """Reckon with contacts between two bodies from now on, or no longer."""
        first, second = self._body(body), self._body(other)
        for index in first.links.values():
            for other_index in second.links.values():
                self._call(
                    "setCollisionFilterPair",
                    first.number,
                    second.number,
                    index,
                    other_index,
                    int(wanted),
                )

    def let_sleep(self, body: str) -> None:
        """Reckon with a body that lies still only once something that moves touches it.

        It is woken by what bumps into it, and sleeps again when it has lain still for a while.
        """
        number = self._body(body).number
        for state in (self._p.ACTIVATION_STATE_ENABLE_SLEEPING, self._p.ACTIVATION_STATE_SLEEP):
            self._call("changeDynamics", number, BASE, activationState=state)

    def keep_awake(self, body: str) -> None:
        """Reckon with a body at every step, from now on."""
        number = self._body(body).number
        for state in (self._p.ACTIVATION_STATE_WAKE_UP, self._p.ACTIVATION_STATE_DISABLE_SLEEPING):
            self._call("changeDynamics", number, BASE, activationState=state)

    # --- time ---------------------------------------------------------------------------------

    def step(self, count: int = 1) -> None:
        """Let `count` steps of `TIME_STEP` pass."""
        for _ in range(count):
            self._call("stepSimulation")
        self.steps += count

    @contextmanager
    def tentatively(self) -> Generator[None]:
        """Inside this block anything may be moved; afterwards all is as it was before."""
        state = self.save()
        try:
            yield
        finally:
            self.restore(state)
            self.forget(state)

    def save(self) -> int:
        """Remember all poses, speeds and contacts; the answer is a ticket for `restore`."""
        return self._call("saveState")

    def restore(self, state: int) -> None:
        """Go back to what was remembered."""
        self._call("restoreState", stateId=state)

    def forget(self, state: int) -> None:
        """Free what was remembered."""
        self._call("removeState", state)

    # --- touch --------------------------------------------------------------------------------

    def contacts(
        self, body: str, link: str | None = None, *, other: str | None = None
    ) -> tuple[Contact, ...]:
        """What a body (or one of its links) touched in the last step, and with which force."""
        options: dict[str, int] = {"bodyA": self._body(body).number}
        if link is not None:
            options["linkIndexA"] = self._link(body, link)[1]
        if other is not None:
            options["bodyB"] = self._body(other).number
        return tuple(self._contact(raw) for raw in self._call("getContactPoints", **options))

    def near(
        self, body: str, other: str, *, within: float, link: str | None = None
    ) -> tuple[Contact, ...]:
        """Where two bodies are nearer to each other than `within` [m], without a step."""
        options = {} if link is None else {"linkIndexA": self._link(body, link)[1]}
        raw = self._call(
            "getClosestPoints",
            self._body(body).number,
            self._body(other).number,
            within,
            **options,
        )
        return tuple(self._contact(each) for each in raw)

    def _contact(self, raw: Sequence[Any]) -> Contact:
        body, other = self._names[raw[1]], self._names[raw[2]]
        return Contact(
            body,
            self._link_name(body, raw[3]),
            other,
            self._link_name(other, raw[4]),
            raw[5],
            raw[7],
            raw[8],
            raw[9],
        )

    def _link_name(self, body: str, index: int) -> str:
        links = self._bodies[body].links
        return next(name for name, each in links.items() if each == index)

    def rays(self, starts: Array, ends: Array) -> tuple[Hit, ...]:
        """What each ray from a start (n, 3) to an end (n, 3) meets first."""
        raw = self._call("rayTestBatch", starts.tolist(), ends.tolist())
        return tuple(self._hit(each) for each in raw)

    def _hit(self, raw: Sequence[Any]) -> Hit:
        if raw[0] == NO_BODY:
            return Hit(None, None, raw[3])
        body = self._names[raw[0]]
        return Hit(body, self._link_name(body, raw[1]), raw[3])

    # --- looks --------------------------------------------------------------------------------

    def render(
        self, view: Array, projection: Array, width: int, height: int, *, light: Light
    ) -> Image:
        """What a camera sees.

        Args:
            view: OpenGL view matrix, camera_from_world (4, 4).
            projection: OpenGL projection matrix (4, 4).
            width: of the picture in pixels.
            height: of the picture in pixels.
            light: how it is lit.
        """
        raw = self._call(
            "getCameraImage",
            width,
            height,
            viewMatrix=view.T.ravel().tolist(),  # OpenGL stores columns
            projectionMatrix=projection.T.ravel().tolist(),
            lightDirection=light.direction,
            lightAmbientCoeff=light.ambient,
            lightDiffuseCoeff=light.diffuse,
            lightSpecularCoeff=light.specular,
            shadow=int(light.shadow),
            flags=self._p.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX,
            renderer=self._p.ER_TINY_RENDERER,
        )
        colour = np.asarray(raw[2], dtype=np.uint8).reshape(height, width, 4)[..., :3]
        depth = np.asarray(raw[3], dtype=np.float32).reshape(height, width)
        labels = np.asarray(raw[4], dtype=np.int32).reshape(height, width)
        return Image(colour, depth, labels, self._labels())

    def _labels(self) -> dict[int, tuple[str, str]]:
        return {
            body.number + ((index + 1) << LINK_SHIFT): (name, link)
            for name, body in self._bodies.items()
            for link, index in body.links.items()
        }

    def paint(self, body: str, link: str | None, colour: Sequence[float]) -> None:
        """Give a link one colour (red, green, blue, opacity in [0, 1]); all links when None."""
        for each in self.links(body) if link is None else (link,):
            self._call("changeVisualShape", *self._link(body, each), rgbaColor=list(colour))

    @contextmanager
    def tinted(
        self, body: str, link: str, colour: Sequence[float], *, share: float = 0.6
    ) -> Generator[None]:
        """Inside this block a link is tinted.

        Args:
            body: whose link.
            link: which one.
            colour: red, green, blue in [0, 1].
            share: of the tint in what is seen, in [0, 1].
        """
        number, index = self._link(body, link)
        shapes = [s for s in self._call("getVisualShapeData", number) if s[1] == index]
        own = [np.array(shape[7]) for shape in shapes]
        tint = np.array([*colour[:3], 1.0])
        try:
            self._recolour(number, index, [(1 - share) * each + share * tint for each in own])
            yield
        finally:
            self._recolour(number, index, own)

    @contextmanager
    def unseen(self, bodies: Sequence[str]) -> Generator[None]:
        """Inside this block some bodies are not drawn, which saves the time of drawing them.

        In a window they stay, or they would flicker there.

        Args:
            bodies: their names.
        """
        shapes = [] if self.gui else [shape for name in bodies for shape in self._drawn(name)]
        try:
            for number, link, index, colour in shapes:
                self._paint_shape(number, link, index, (*colour[:3], 0.0))
            yield
        finally:
            for shape in shapes:
                self._paint_shape(*shape)

    def _drawn(self, name: str) -> Iterator[tuple[int, int, int, Sequence[float]]]:
        """What is drawn of a body: its number, the link, the shape's number there, its colour."""
        count = Counter[int]()
        for shape in self._call("getVisualShapeData", self._body(name).number):
            yield shape[0], shape[1], count[shape[1]], shape[7]
            count[shape[1]] += 1

    def _paint_shape(self, number: int, link: int, index: int, colour: Sequence[float]) -> None:
        self._call("changeVisualShape", number, link, shapeIndex=index, rgbaColor=list(colour))

    def _recolour(self, number: int, index: int, colours: Sequence[Array]) -> None:
        for shape, colour in enumerate(colours):
            self._paint_shape(number, index, shape, colour.tolist())


def _pose(position: Sequence[float], quaternion: Sequence[float]) -> Array:
    """The pose at a position, turned by a unit quaternion in PyBullet's order x, y, z, w."""
    x, y, z, w = quaternion
    rotation = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return poses.pose(rotation, position)


def _quaternion(rotation: Array) -> tuple[float, float, float, float]:
    vector = poses.rotation_vector(rotation)
    angle = float(np.linalg.norm(vector))
    # np.sinc(t) is sin(pi t) / (pi t): defined at 0, where the axis is not.
    x, y, z = 0.5 * np.sinc(angle / (2 * np.pi)) * vector
    return float(x), float(y), float(z), float(np.cos(angle / 2))


def _import_pybullet() -> Any:
    try:
        with _quiet():
            import pybullet
    except ImportError as error:
        raise MissingExtraError("sim", "pybullet") from error
    return pybullet


@contextmanager
def _quiet() -> Generator[None]:
    """Keep what PyBullet prints from C out of the user's terminal."""
    with ExitStack() as stack, open(os.devnull, "wb") as nothing:
        for number in (1, 2):
            stack.enter_context(_redirected(number, nothing.fileno()))
        yield


@contextmanager
def _redirected(number: int, target: int) -> Generator[None]:
    try:
        saved = os.dup(number)
    except OSError:  # the stream is closed: there is nothing to hide
        yield
        return
    os.dup2(target, number)
    try:
        yield
    finally:
        # What C has printed waits in its own buffer; let it out while nobody reads it.
        ctypes.CDLL(None).fflush(None)
        os.dup2(saved, number)
        os.close(saved)
