"""One command of Hilt's, carried out again in MuJoCo: an independent witness of the physics.

Hilt's robot passes a thing in PyBullet. Then the arm of the same URDF file follows the exported
trajectory in MuJoCo by position actuators, and squeezes by the force of the gripper once the
fingers have closed. The thing has the convex pieces, masses and friction of Hilt's model, and lies
where it lay; whether it is held, MuJoCo alone decides. Needs the packages of the extra `bench`.
Run: python examples/mujoco_witness.py [THING PART [ROBOT]]
"""

import sys
from dataclasses import dataclass
from typing import Any

import mujoco
import numpy as np

from hilt.agent import Agent, AgentConfig
from hilt.ontology import ObjectType, load_objects
from hilt.sim import RobotType, find_robot, poses
from hilt.sim.models.solids import build_solid
from hilt.sim.robot.trajectory import unpack

COMPILER = '<mujoco><compiler strippath="false" fusestatic="false"/></mujoco>'
ARM_STIFFNESS, FINGER_STIFFNESS = 20_000.0, 10_000.0  # [N m/rad], [N/m]
ARMATURE = 0.1  # [kg m^2], [kg] of the motors and their gears
LEAD = 0.02  # [s], by which the targets are ahead, as the actuators lag
STIFF = (0.005, 1.0)  # time constant [s] and damping ratio of contacts
SPINNING = 0.004  # [m], torsional friction of a finger pad on a thing
MOVING = 0.01  # [m/s], fingers that move faster have not closed yet
SQUEEZE_TIME = 0.15  # [s], in which the force builds up


@dataclass(frozen=True)
class Testimony:
    """What MuJoCo saw of a thing.

    Attributes:
        height_m: how much higher it is in the end.
        slip_m, turn_deg: how far it moved and turned between the fingers since they had closed.
        held: whether both fingers touch it in the end.
    """

    height_m: float
    slip_m: float
    turn_deg: float
    held: bool


def build(robot: RobotType, thing: ObjectType, world_from_thing: np.ndarray) -> mujoco.MjModel:
    """A robot of Hilt's with its feet on a table, and a thing at a pose on it."""
    text = robot.file.read_text(encoding="utf-8").replace("</robot>", f"{COMPILER}</robot>")
    spec = mujoco.MjSpec.from_string(text)
    spec.option.timestep, spec.option.integrator = 0.001, mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10.0
    for body in spec.bodies:
        body.gravcomp = 1.0  # as the controller of the real arm does
        for geom in body.geoms:  # only the fingers touch; their friction is that of what they hold
            geom.contype = geom.conaffinity = int(body.name in robot.gripper.links)
            geom.friction, geom.solref = (0.0, 0.0, 0.0), STIFF
    for name in (*robot.arm.names, *robot.gripper.joints):
        force = robot.gripper.force if name in robot.gripper.joints else np.inf
        gain = ARM_STIFFNESS if force == np.inf else FINGER_STIFFNESS
        spec.joint(name).armature = ARMATURE
        servo = spec.add_actuator(name=name, target=name, trntype=mujoco.mjtTrn.mjTRN_JOINT)
        servo.set_to_position(kp=gain, kv=LEAD * gain)
        servo.forcelimited, servo.forcerange = force < np.inf, (-force, force)
    plane = mujoco.mjtGeom.mjGEOM_PLANE
    spec.worldbody.add_geom(type=plane, size=(2, 2, 0.1), friction=(0, 0, 0))
    add_thing(spec, thing, world_from_thing)
    return spec.compile()


def add_thing(spec: mujoco.MjSpec, thing: ObjectType, world_from_thing: np.ndarray) -> None:
    """Add a loose body of the convex pieces of Hilt's model."""
    x, y, z, w = poses.quaternion(world_from_thing[:3, :3])
    body = spec.worldbody.add_body(name="thing", pos=world_from_thing[:3, 3], quat=(w, x, y, z))
    body.add_freejoint()
    for part in thing.parts.values():
        pieces = [corners for solid in part.shape for corners in build_solid(solid).collision]
        for number, corners in enumerate(pieces):
            mesh = spec.add_mesh(name=f"{part.name} {number}", uservert=corners.ravel())
            geom = body.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=mesh.name)
            geom.mass, geom.condim, geom.solref = part.mass / len(pieces), 4, STIFF
            geom.friction = (part.material.friction, SPINNING, 0.0)


def follow(model: mujoco.MjModel, found: dict[str, Any], robot: RobotType) -> Testimony:
    """Follow a trajectory from its first posture to its last, and see what becomes of the thing."""
    data, servos = mujoco.MjData(model), [model.actuator(name).id for name in found["joints"]]
    times, targets = np.array(found["time_s"]) - found["time_s"][0], np.array(found["positions"])
    for name, position in zip(found["joints"], targets[0], strict=True):
        data.joint(name).qpos = position
    mujoco.mj_forward(model, data)
    fingers = [name in robot.gripper.joints for name in found["joints"]]
    speed = np.gradient(targets[:, fingers].sum(axis=1), times)
    closed = int(np.flatnonzero(np.abs(speed) > MOVING)[-1]) + 1
    targets[closed:, fingers] -= robot.gripper.force / FINGER_STIFFNESS  # which gives the force
    start, gripped = pose(data, "thing")[2, 3], np.eye(4)
    while data.time < times[-1]:
        data.ctrl[servos] = [np.interp(data.time + LEAD, times, each) for each in targets.T]
        mujoco.mj_step(model, data)
        if data.time <= times[closed] + SQUEEZE_TIME:
            gripped = in_grip(data, robot)
    now_from_then = in_grip(data, robot) @ poses.inverse(gripped)
    return Testimony(
        height_m=float(pose(data, "thing")[2, 3] - start),
        slip_m=float(np.linalg.norm(now_from_then[:3, 3])),
        turn_deg=float(np.degrees(poses.angle_between(np.eye(3), now_from_then[:3, :3]))),
        held=touching(model, data) >= {*robot.gripper.links},
    )


def pose(data: mujoco.MjData, body: str) -> np.ndarray:
    """The pose of a body in the world (4, 4)."""
    return poses.pose(data.body(body).xmat.reshape(3, 3), data.body(body).xpos)


def in_grip(data: mujoco.MjData, robot: RobotType) -> np.ndarray:
    """The pose of the thing, seen from the place between the fingers (4, 4)."""
    grip = pose(data, robot.hand) @ robot.gripper.hand_from_grip
    return poses.inverse(grip) @ pose(data, "thing")


def touching(model: mujoco.MjModel, data: mujoco.MjData) -> set[str]:
    """The bodies that touch the thing."""
    pairs = [{model.body(model.geom_bodyid[g]).name for g in each.geom} for each in data.contact]
    return set().union(*(pair for pair in pairs if "thing" in pair)) - {"thing"}


def main(thing: str = "knife", part: str = "blade", robot: str = "panda") -> Testimony:
    """Let Hilt pass a thing by a part, and say what both simulators saw."""
    with Agent.open("memory:", AgentConfig(scene=f"objects:{thing}", seed=7, robot=robot)) as agent:
        before = agent.body.world.pose(thing)
        agent.hear(f"To pass a {thing} grab it by the {part}")
        print(agent.hear(f"pass me the {thing}").said)
        height = agent.body.world.pose(thing)[2, 3] - before[2, 3]
        (episode,) = agent.base.episodes()
    print(f"PyBullet: {height:.3f} m up, held in the end: {'yes' if episode.handed_over else 'no'}")
    model = build(find_robot(robot), load_objects()[thing], before)
    seen = follow(model, unpack(episode.trajectory or ""), find_robot(robot))
    print(f"MuJoCo:   {seen.height_m:.3f} m up, held in the end: {'yes' if seen.held else 'no'}")
    print(
        f"          in the hand it slid {seen.slip_m * 1e3:.1f} mm, turned {seen.turn_deg:.1f} deg"
    )
    return seen


if __name__ == "__main__":
    main(*sys.argv[1:])
