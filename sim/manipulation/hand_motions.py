"""Motions of the hand: grasp, lift, hold, carry, hand over, put down and point at objects.

Success is judged by the contacts of the fingers and the height of the object, never by what was
commanded. A motion that fails returns the reason and raises nothing.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import shapely

from .. import poses
from ..grasping.context import GraspContext
from ..models.object_models import object_model
from ..physics.engine import GRAVITY, TIME_STEP
from ..poses import Array, voxel_downsample
from ..robot.collision import finger_spheres, hand_spheres
from ..robot.path_planner import MAX_PACE, GraspPath, PathPlanner, hand_orientations
from ..robot.robot import FingerContacts, Robot

TRANSIT_PACE = MAX_PACE  # shares of the joints' speed limits
APPROACH_PACE = 0.45
LIFT_PACE = 0.45
CARRY_PACE = MAX_PACE
CAREFUL_TORQUE = 0.25  # [N m] of gravity in the hand at which objects are carried at half the pace
CHECK_INTERVAL = 12  # steps between two checks of the finger contacts
LOST_CHECKS = 2  # without contact, after which an object is lost
HELD_CELL, HELD_RADIUS = 0.015, 0.008  # [m], spheres that stand for a held object
HELD_GAP = 0.006  # [m] between a held object and obstacles
RELEASE_HEIGHT = 0.003  # [m] above where it was taken up, an object is released
PLACES = ((0.35, 0.66), (-0.36, 0.37))  # [m], x and y of the grip where objects are put down
PLACE_STEP = 0.05  # [m] between two places
PLACE_GAPS = (0.10, 0.03)  # [m] to other objects: with room for a hand, where there is such a place
PLACE_HEIGHT = 0.10  # [m] above a place, from where an object is lowered
RELEASE_TIME = 0.4  # [s]
RETREAT = 0.08  # [m] the open hand goes back
POINTING_GAP = 0.05  # [m] between the finger tips and the object pointed at
POINTING_TILTS_DEG = ((30.0, 8, 1), (45.0, 8, 1), (15.0, 8, 1), (0.0, 8, 1))  # headings, rolls
MEETING = (0.58, 0.0, 0.40)  # [m], where objects are handed over
AHEAD = (1.0, 0.0, 0.0)  # from there to the person who receives them, across the table
MIN_FREE_LENGTH = 0.01  # [m] from the grip to the free part, else it has no direction
HEADINGS = 24  # turns about the vertical that are tried for handing over
FACING = (-0.5, 0.0, 0.7, 0.9)  # cosines to the receiver; between two of them all are as good
PULL, FELT = 20.0, 5.0  # [N], of the receiver at the object, and from which on the hand opens
PULL_SPEED, PULL_TIME = 0.25, 1.0  # [m/s], [s] of that pull
TAKEN, LOST_GAP = 0.5, 0.05  # [m] that the receiver takes it away; further off it was lost
OFFSETS = (0.0, -0.06, 0.06, -0.12)  # [m] from the meeting point towards the receiver


@dataclass(frozen=True)
class HeldObject:
    """The object in the hand."""

    context: GraspContext  #: the object and its surroundings as seen before the grasp
    planner: PathPlanner  #: of paths among these surroundings
    path: GraspPath  #: the path to the grasp
    world_from_start: Array  #: pose (4, 4) of the object before the grasp
    hand_from_object: Array  #: pose (4, 4) of the object in the hand when the fingers had closed
    points: Array  #: point cloud of the object (n, 3) in the hand frame [m]
    torque: float  #: largest torque of gravity about the line between the fingers [N m]
    others: Array  #: points of the other parts (n, 3) in the hand frame [m]
    free: Array  #: from the grip to their middle (3,), in the hand frame; zero without any [m]
    is_offered: bool = False  #: whether it was brought to the receiver last

    @property
    def name(self) -> str:
        """The name of the object."""
        return self.context.percept.name


@dataclass(frozen=True)
class HandMotion:
    """Moves a robot with a gripper among objects on a table."""

    robot: Robot

    def grasp(self, path: GraspPath, *, force: float) -> FingerContacts:
        """Follow a path to a grasp, close with at most a force [N]; return what is touched."""
        self.robot.open(path.grasp.opening)
        self.robot.follow(path.transit, pace=TRANSIT_PACE)
        self.robot.follow(path.approach, pace=APPROACH_PACE)
        self.robot.close(force)
        return self.robot.finger_contacts()

    def held_object(
        self, context: GraspContext, planner: PathPlanner, path: GraspPath, before: Array
    ) -> HeldObject:
        """Describe an object on which the gripper has closed; `before` was its pose then (4, 4)."""
        touched = self.robot.finger_contacts().parts(context.percept.name)
        context = replace(context, part=touched[0] if len(touched) == 1 else context.part)
        hand_from_object = self.hand_from_object(context.percept.name)
        hand_from_seen = hand_from_object @ poses.inverse(before)
        grip = self.robot.gripper.hand_from_grip[:3, 3]
        other_parts = poses.transform(hand_from_seen, context.other_parts)
        cloud = poses.transform(hand_from_seen, context.percept.cloud)
        arm = poses.transform(hand_from_seen, context.centre_of_mass[None])[0] - grip
        return HeldObject(
            context,
            planner,
            path,
            before,
            hand_from_object,
            cloud[voxel_downsample(cloud, HELD_CELL)],
            GRAVITY * context.kind.mass * float(np.hypot(arm[0], arm[2])),
            other_parts,
            other_parts.mean(axis=0) - grip if len(other_parts) else np.zeros(3),
        )

    def release(self, planner: PathPlanner, opening: float) -> None:
        """Open the gripper to `opening` [m], retreat, and go home if there is a free path."""
        self._let_loose(planner, opening)
        spheres = self.robot.body_spheres(self.robot.opening)
        home = planner.plan_transit(self.robot.kind.home, spheres, planner.scene)
        self._follow_if(home, TRANSIT_PACE)

    def _let_loose(self, planner: PathPlanner, opening: float) -> None:
        self.robot.open(opening)
        self.robot.advance(round(RELEASE_TIME / TIME_STEP))
        back = self.robot.world_from_grip @ poses.translation(0, 0, -RETREAT)
        self._follow_if(planner.plan_straight(back), APPROACH_PACE)

    def lift(self, held: HeldObject, height: float) -> bool:
        """Lift the held object by `height` [m]; return False as soon as it is lost."""
        above = poses.translation(0, 0, height) @ self.robot.world_from_grip
        path = held.planner.plan_straight(above)
        path = held.path.lift if path is None else path
        return self.robot.follow(path, pace=LIFT_PACE, stop=self.loss_check(held.name))

    def slip(self, held: HeldObject) -> tuple[float, float]:
        """How far the object has moved at the grip [m] and turned [rad] since it was grasped."""
        now_from_then = self.hand_from_object(held.name) @ poses.inverse(held.hand_from_object)
        grip = self.robot.hand_from_grip[None, :3, 3]
        moved = np.linalg.norm(poses.transform(now_from_then, grip) - grip)
        return float(moved), float(poses.angle_between(np.eye(3), now_from_then[:3, :3]))

    def height_gained(self, held: HeldObject) -> float:
        """How far the object is above where it lay [m]."""
        return float((self.robot.engine.bodies.pose(held.name) - held.world_from_start)[2, 3])

    def hand_from_object(self, name: str) -> Array:
        """The pose of an object in the hand frame (4, 4)."""
        return poses.inverse(self.robot.world_from_hand) @ self.robot.engine.bodies.pose(name)

    def loss_check(self, name: str) -> Callable[[], bool]:
        """A function for each step: whether an object is lost. One check may miss contacts."""
        step = missing = 0

        def is_lost() -> bool:
            nonlocal step, missing
            step += 1
            if step % CHECK_INTERVAL == 0:
                missing = 0 if self.robot.finger_contacts().holds(name) else missing + 1
            return missing >= LOST_CHECKS

        return is_lost

    def plan_carry(self, held: HeldObject, goal: Array) -> Array | None:
        """Plan a path to a posture on which neither the arm nor the held object hits anything."""
        return held.planner.plan_transit(
            goal,
            self.robot.body_spheres(self.robot.opening),
            held.planner.obstacles,
            gap=HELD_GAP,
            held=hand_spheres(self.robot.chain, held.points, HELD_RADIUS),
        )

    def carry(self, held: HeldObject, path: Array) -> str:
        """Follow a path, slower where the object could turn; return "dropped" if it is, or ""."""
        pace = CARRY_PACE / (1 + held.torque / CAREFUL_TORQUE)
        is_there = self.robot.follow(path, pace=pace, stop=self.loss_check(held.name))
        return "" if is_there else "dropped"

    def hand_over(self, held: HeldObject) -> str:
        """Carry the held object to the receiver; return the reason of failure, or ""."""
        for goal in self._hand_over_postures(held):
            path = self.plan_carry(held, goal)
            if path is not None:
                return self.carry(held, path)
        return "unreachable"

    def offered(self, held: HeldObject) -> tuple[float | None, float | None]:
        """How the free part is offered: its level angle to the receiver, its gap to the fingers.

        In [rad] and [m]; None without a free part, and the angle also where it is not aside.
        """
        if not len(held.others):
            return None, None
        fingers = finger_spheres(self.robot.chain, self.robot.gripper, self.robot.opening)
        gaps = np.linalg.norm(held.others[:, None] - fingers.centre, axis=-1) - fingers.radius
        aside = (self.robot.world_from_hand[:3, :3] @ held.free)[:2]
        cosine = aside @ AHEAD[:2] / max(np.linalg.norm(aside), MIN_FREE_LENGTH)
        is_aside = np.linalg.norm(aside) > MIN_FREE_LENGTH
        return float(np.arccos(np.clip(cosine, -1, 1))) if is_aside else None, float(gaps.min())

    def give(self, held: HeldObject) -> bool:
        """Open the hand when the receiver pulls at the held object; return whether it was taken.

        The receiver is a force at the free part, towards the person. The hand feels it by the
        torques of the arm, as a Panda does (Haddadin et al. 2017).
        """
        joints, ahead = self.robot.engine.joints, np.array(AHEAD)
        grip = self.robot.hand_from_grip[:3, 3] + held.free
        start = poses.transform(self.robot.world_from_hand, grip[None])[0]
        object_from_world = poses.inverse(self.robot.engine.bodies.pose(held.name))
        at_rest, tether = self.robot.force_on_hand(), joints.tether(held.name, start, force=PULL)
        for step in range(round(PULL_TIME / TIME_STEP)):
            joints.move_tether(tether, start + PULL_SPEED * TIME_STEP * step * ahead)
            self.robot.advance(1)
            if (at_rest - self.robot.force_on_hand()) @ ahead > FELT:
                break
        else:
            joints.untie(tether)
            return False
        joints.move_tether(tether, start)
        self._let_loose(held.planner, held.path.grasp.opening)
        for step in range(round(TAKEN / PULL_SPEED / TIME_STEP)):
            joints.move_tether(tether, start + PULL_SPEED * TIME_STEP * step * ahead)
            self.robot.advance(1)
        now_from_start = self.robot.engine.bodies.pose(held.name) @ object_from_world
        moved = poses.transform(now_from_start, start[None])[0] - start
        return bool(np.linalg.norm(moved - TAKEN * ahead) < LOST_GAP)

    def put_back(self, held: HeldObject) -> str:
        """Put the held object down where it lay; return the reason of failure, or ""."""
        above = self.plan_carry(held, held.path.lift[-1])
        return "unreachable" if above is None else self._put_at(held, above, np.zeros(3))

    def put_down(self, held: HeldObject) -> str:
        """Put the held object on the nearest free place; return the reason of failure, or ""."""
        for shift in self._free_places(held):
            raised = poses.translation(*shift) @ poses.translation(0, 0, PLACE_HEIGHT)
            goal = held.planner.inverse_kinematics((raised @ held.path.grasp.world_from_grip)[None])
            above = self.plan_carry(held, goal.joints[0]) if goal.found[0] else None
            reason = "unreachable" if above is None else self._put_at(held, above, shift)
            if reason != "unreachable":
                return reason
        return "no_room"

    def _put_at(self, held: HeldObject, above: Array, shift: Array) -> str:
        if reason := self.carry(held, above):
            return reason
        down = poses.translation(*np.add(shift, (0, 0, RELEASE_HEIGHT))) @ held.world_from_start
        # As the object is in the hand now: it may have slipped.
        goal = down @ poses.inverse(self.hand_from_object(held.name)) @ self.robot.hand_from_grip
        path, opening = held.planner.plan_straight(goal), held.path.grasp.opening
        if path is None or not held.planner.is_clear(path, opening):
            return "unreachable"
        self.robot.follow(path, pace=APPROACH_PACE)
        laid = poses.transform(self.robot.world_from_hand, held.points)
        scene = np.vstack([held.planner.obstacles, laid])
        self.release(replace(held.planner, scene=scene), opening)
        return ""

    def _free_places(self, held: HeldObject) -> Iterator[Array]:
        """Shifts (3,) [m] from where the object lay to places with room, the nearest first."""
        start = held.path.grasp.world_from_grip[:2, 3]
        axes = (np.arange(low, high, PLACE_STEP) for low, high in PLACES)
        places = np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2)
        far = np.linalg.norm(places - self.robot.world_from_grip[:2, 3], axis=1)
        clouds = (held.context.percept.cloud, held.planner.obstacles)
        cloud, others = (each[voxel_downsample(each, HELD_CELL), :2] for each in clouds)
        taken = shapely.MultiPoint(others)
        corners = poses.transform(held.world_from_start, object_model(held.context.kind).points)
        drop = held.planner.table - corners[:, 2].min()
        shifts = places[np.argsort(far, kind="stable")] - start
        for gap, shift in product(PLACE_GAPS, shifts):
            if not shapely.dwithin(taken, shapely.MultiPoint(cloud + shift), gap):
                yield np.array([*shift, drop])

    def _hand_over_postures(self, held: HeldObject) -> Iterator[Array]:
        turns = poses.rotation_about((0, 0, 1), np.arange(HEADINGS) * 2 * np.pi / HEADINGS)
        towards = np.array(AHEAD)
        rotations = turns @ self.robot.world_from_grip[:3, :3]
        free = rotations @ held.free * (1, 1, 0)
        length = np.linalg.norm(free, axis=1, keepdims=True)
        ahead = np.where(length > MIN_FREE_LENGTH, free / np.maximum(length, MIN_FREE_LENGTH), 0.0)
        worse = -np.digitize(ahead @ towards, FACING)
        for offset in OFFSETS:
            for level in np.unique(worse):
                chosen = rotations[worse == level]
                goals = poses.pose(chosen, MEETING + offset * towards)
                answer = held.planner.inverse_kinematics(goals)
                reached = answer.joints[answer.found]
                yield from reached[np.argsort(held.planner.travel_time(reached), kind="stable")]

    def point_at(self, cloud: Array, planner: PathPlanner) -> str:
        """Point at the middle of a cloud (n, 3), touching nothing; return why it failed, or ""."""
        if self.robot.kind.gripper:
            self.robot.open(0.0)
        middle, spheres = cloud.mean(axis=0), self.robot.body_spheres(0.0)
        rotations = hand_orientations(POINTING_TILTS_DEG)
        along = rotations[..., 2]
        # The nearest point of the cloud along the approach direction keeps its distance.
        depth = np.min((cloud - middle) @ along.T, axis=0) - POINTING_GAP
        at = middle + (depth - self.robot.tip)[:, None] * along
        answer = planner.inverse_kinematics(poses.pose(rotations, at))
        for goal in answer.joints[answer.found]:
            path = planner.plan_transit(goal, spheres, planner.scene, gap=POINTING_GAP / 2)
            if path is not None:
                free = self.robot.follow(path, pace=TRANSIT_PACE, stop=self.robot.is_touching)
                return "" if free else "bumped"
        return "unreachable"

    def _follow_if(self, path: Array | None, pace: float) -> None:
        if path is not None:
            self.robot.follow(path, pace=pace)
