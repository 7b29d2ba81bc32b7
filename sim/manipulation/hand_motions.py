"""Motions of the hand: grasp, lift, hold, carry, hand over, put down and point at objects.

Success is judged by sight and touch, never by what was commanded: by what the fingers feel, how far
they are open, and where the object is seen in the hand. A motion that fails returns the reason.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
import shapely

from .. import poses
from ..grasping.context import GraspContext
from ..physics.engine import GRAVITY, TIME_STEP
from ..poses import Array, voxel_downsample
from ..robot.collision import finger_spheres
from ..robot.path_planner import MAX_PACE, GraspPath, PathPlanner, hand_orientations
from ..robot.robot import Robot
from ..vision.object_detector import ObjectDetector
from ..vision.registration import motion_between

TRANSIT_PACE = MAX_PACE  # shares of the joints' speed limits
APPROACH_PACE = 0.45
LIFT_PACE = 0.45
CARRY_PACE = MAX_PACE
CAREFUL_TORQUE = 0.25  # [N m] of gravity in the hand at which objects are carried at half the pace
CHECK_INTERVAL = 12  # steps between two checks of the finger contacts
LOST_CHECKS = 2  # without contact, after which an object is lost
ALIGNED = 0.004  # [m], fingers that close by this much more or less than planned have turned it
PAD_MARGINS = (-0.001, 0.003, -0.001)  # [m], of the space between the pads in which parts are held
OFF_HAND = 0.008  # [m] from the spheres of the hand, for its depths and shape are not exact
PRESSED, MIN_POINTS = 0.002, 3  # [m] below the outermost point there; of a part that is touched
NOTHING = np.zeros((0, 3))
HELD_CELL = 0.015  # [m], voxel size of the points that stand for a held object
HELD_GAP = 0.006  # [m] between a held object and obstacles
RELEASE_HEIGHT = 0.003  # [m] above where it was taken up, an object is released
PLACES = ((0.35, 0.66), (-0.36, 0.37))  # [m], x and y of the grip where objects are put down
PLACE_STEP = 0.05  # [m] between two places
PLACE_GAPS = (0.10, 0.03)  # [m] to other objects: with room for a hand, where there is such a place
PLACE_HEIGHT = 0.10  # [m] above a place, from where an object is lowered
RELEASE_TIME = 0.4  # [s]
BACKWARDS = poses.translation(0, 0, -0.08)  # [m], where the open hand goes, seen from its grip
POINTING_GAP = 0.05  # [m] between the finger tips and the object pointed at
POINTING_TILTS_DEG = ((30.0, 8, 1), (45.0, 8, 1), (15.0, 8, 1), (0.0, 8, 1))  # headings, rolls
MEETING = (0.58, 0.0, 0.40)  # [m], where objects are handed over
AHEAD = (1.0, 0.0, 0.0)  # from there to the person who receives them, across the table
MIN_FREE_LENGTH = 0.01  # [m] from the grip to the free part, else it has no direction
HEADINGS = 24  # turns about the vertical that are tried for handing over
FACING = (-0.5, 0.0, 0.7, 0.9)  # cosines to the receiver; between two of them all are as good
IN_THE_WAY = 0.3  # sine of the slope of a hand that comes from the receiver's side: tried later
PULL, FELT = 20.0, 5.0  # [N], of the receiver at the object, and from which on the hand opens
TWIST = 1.0  # [N m], by which the receiver keeps it from turning
PULL_SPEED, PULL_TIME = 0.25, 1.0  # [m/s], [s] of that pull
TAKEN = 0.5  # [m] that the receiver takes it away
OFFSETS = (0.0, -0.06, 0.06, -0.12)  # [m] from the meeting point towards the receiver


@dataclass(frozen=True)
class HeldObject:
    """The object in the hand."""

    context: GraspContext  #: the object and its surroundings as seen before the grasp
    planner: PathPlanner  #: of paths among these surroundings
    path: GraspPath  #: the path to the grasp
    hand_from_grip: Array  #: the grip frame in the hand frame (4, 4)
    hand_from_closed: Array  #: `hand_from_seen` when the fingers had closed (4, 4)
    hand_from_seen: Array  #: the world before the grasp, moved as the object since then (4, 4)
    is_offered: bool = False  #: whether it was brought to the receiver last

    @property
    def name(self) -> str:
        """The name of the object."""
        return self.context.percept.name

    @cached_property
    def points(self) -> Array:
        """Its point cloud (n, 3) in the hand frame [m]."""
        cloud = self.context.percept.cloud
        return poses.transform(self.hand_from_seen, cloud[voxel_downsample(cloud, HELD_CELL)])

    @cached_property
    def others(self) -> Array:
        """Points of the other parts (n, 3) in the hand frame [m]."""
        return poses.transform(self.hand_from_seen, self.context.other_parts)

    @property
    def free(self) -> Array:
        """From the grip to the middle of the other parts (3,), in the hand; or zero [m]."""
        grip = self.hand_from_grip[:3, 3]
        return self.others.mean(axis=0) - grip if len(self.others) else np.zeros(3)

    @property
    def torque(self) -> float:
        """The largest torque of gravity about the line between the fingers [N m]."""
        centre = self.context.centre_of_mass[None]
        arm = poses.transform(self.hand_from_seen, centre)[0] - self.hand_from_grip[:3, 3]
        return GRAVITY * self.context.kind.mass * float(np.hypot(arm[0], arm[2]))

    @property
    def slip(self) -> tuple[float, float]:
        """How far it has moved at the grip [m] and turned [rad] since the fingers closed."""
        now_from_then = self.hand_from_seen @ poses.inverse(self.hand_from_closed)
        grip = self.hand_from_grip[None, :3, 3]
        moved = np.linalg.norm(poses.transform(now_from_then, grip) - grip)
        return float(moved), float(poses.angle_between(np.eye(3), now_from_then[:3, :3]))


@dataclass(frozen=True)
class HandMotion:
    """Moves a robot with a gripper among objects on a table, and sees what it holds."""

    robot: Robot
    vision: ObjectDetector

    def grasp(self, path: GraspPath, *, force: float) -> None:
        """Follow a path to a grasp, and close with at most a force [N]."""
        self.robot.open(path.grasp.opening)
        self.robot.follow(path.transit, pace=TRANSIT_PACE)
        self.robot.follow(path.approach, pace=APPROACH_PACE)
        self.robot.close(force)

    def held_object(self, grasp: GraspContext, planner: PathPlanner, path: GraspPath) -> HeldObject:
        """Describe an object on which the gripper has closed."""
        at = poses.inverse(self.robot.world_from_hand)
        held = HeldObject(grasp, planner, path, self.robot.hand_from_grip, at, at)
        if abs(self.robot.opening - path.grasp.width) > ALIGNED:  # the fingers have turned it
            held = self.seen(held)
        touched = self.touched(held)
        grasp = replace(grasp, part=touched[0] if len(touched) == 1 else grasp.part)
        return replace(held, context=grasp, hand_from_closed=held.hand_from_seen)

    def seen(self, held: HeldObject) -> HeldObject:
        """The held object where it is seen in the hand now; where it was if it is not seen."""
        world_from_hand, percept = self.robot.world_from_hand, held.context.percept
        guess = world_from_hand @ held.hand_from_seen
        moved = {name: poses.transform(guess, cloud) for name, cloud in percept.parts.items()}
        after = self.vision.look(replace(percept, parts=moved))
        seen = [(n, self._off_hand(cloud)) for n, cloud in after.parts.items()] if after else []
        if not (free := {name: cloud for name, cloud in seen if len(cloud)}):
            return held
        motion = motion_between(percept, replace(percept, parts=free), guess)
        return replace(held, hand_from_seen=poses.inverse(world_from_hand) @ motion)

    def _off_hand(self, cloud: Array) -> Array:
        """Those of the points (n, 3) in the world that are not the hand's own [m]."""
        spheres = self.robot.body_spheres(self.robot.opening)
        own = spheres.link == len(self.robot.chain.links) - 1
        centres = poses.transform(self.robot.world_from_hand, spheres.centre[own])
        gaps = np.linalg.norm(cloud[:, None] - centres, axis=-1) - spheres.radius[own]
        return cloud[(gaps > OFF_HAND).all(axis=1)]

    def touched(self, held: HeldObject, others: Array = NOTHING) -> tuple[str, ...]:
        """The parts that the pads press on, from where the object was seen last.

        "" is among them where that is one of `others`, points (n, 3) in the world [m].
        """
        grip_from_seen = poses.inverse(held.hand_from_grip) @ held.hand_from_seen
        parts = held.context.percept.parts.items()
        clouds = {name: poses.transform(grip_from_seen, cloud) for name, cloud in parts}
        clouds[""] = poses.transform(poses.inverse(self.robot.world_from_grip), others)
        gripper = self.robot.gripper
        half = np.array([gripper.pad_width, self.robot.opening, gripper.pad_length]) / 2
        between = {n: c[(np.abs(c) < half + PAD_MARGINS).all(axis=1), 1] for n, c in clouds.items()}
        found = set[str]()
        for side in (-1, 1):
            outermost = max((side * y).max(initial=-np.inf) for y in between.values())
            pressed = {n: (side * y > outermost - PRESSED).sum() for n, y in between.items()}
            found |= {name for name, count in pressed.items() if count >= MIN_POINTS}
        return tuple(sorted(found))

    def release(self, planner: PathPlanner, opening: float) -> None:
        """Open the gripper to `opening` [m], retreat, and go home if there is a free path."""
        self._let_loose(planner, opening)
        if (home := planner.plan_transit(self.robot.kind.home, self.robot.opening)) is not None:
            self.robot.follow(home, pace=TRANSIT_PACE)

    def _let_loose(self, planner: PathPlanner, opening: float) -> None:
        self.robot.open(opening)
        self.robot.advance(round(RELEASE_TIME / TIME_STEP))
        if (path := planner.plan_straight(self.robot.world_from_grip @ BACKWARDS)) is not None:
            self.robot.follow(path, pace=APPROACH_PACE)

    def lift(self, held: HeldObject, height: float) -> bool:
        """Lift the held object by `height` [m]; return False as soon as it is lost."""
        above = poses.translation(0, 0, height) @ self.robot.world_from_grip
        path = held.planner.plan_straight(above)
        path = held.path.lift if path is None else path
        return self.robot.follow(path, pace=LIFT_PACE, stop=self.loss_check())

    def height_gained(self, held: HeldObject) -> float:
        """How far the middle of the object is above where it lay [m]."""
        middle = held.context.percept.centre[None]
        now = poses.transform(self.robot.world_from_hand @ held.hand_from_seen, middle)
        return float((now - middle)[0, 2])

    def loss_check(self) -> Callable[[], bool]:
        """A function for each step: whether the hand is empty. One check may miss contacts."""
        step = missing = 0

        def is_lost() -> bool:
            nonlocal step, missing
            step += 1
            if step % CHECK_INTERVAL == 0:
                missing = 0 if self.robot.is_holding else missing + 1
            return missing >= LOST_CHECKS

        return is_lost

    def plan_carry(self, held: HeldObject, goal: Array) -> Array | None:
        """Plan a path to a posture on which neither the arm nor the held object hits anything."""
        return held.planner.plan_transit(goal, self.robot.opening, gap=HELD_GAP, held=held.points)

    def carry(self, held: HeldObject, path: Array) -> str:
        """Follow a path, slower where the object could turn; return "dropped" if it is, or ""."""
        pace = CARRY_PACE / (1 + held.torque / CAREFUL_TORQUE)
        return "" if self.robot.follow(path, pace=pace, stop=self.loss_check()) else "dropped"

    def hand_over(self, held: HeldObject) -> str:
        """Carry the held object to the receiver; return the reason of failure, or ""."""
        for goal in self._hand_over_postures(held):
            if (path := self.plan_carry(held, goal)) is not None:
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
        at_rest = self.robot.force_on_hand()
        tether = joints.tether(held.name, start, force=PULL, torque=TWIST)
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
        return not self.robot.is_touching()

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
        down = poses.translation(*np.add(shift, (0, 0, RELEASE_HEIGHT)))
        # As the object is in the hand now: it may have slipped.
        goal = down @ poses.inverse(held.hand_from_seen) @ held.hand_from_grip
        path, opening = held.planner.plan_straight(goal), held.path.grasp.opening
        if path is None or not held.planner.is_clear(path, opening, gap=-RELEASE_HEIGHT):
            return "unreachable"  # the spheres of the tips may reach the table
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
        cloud, others = (each[voxel_downsample(each, HELD_CELL)] for each in clouds)
        taken = shapely.MultiPoint(others[:, :2])
        drop = held.planner.table - cloud[:, 2].min()
        for gap, shift in product(PLACE_GAPS, places[np.argsort(far, kind="stable")] - start):
            if not shapely.dwithin(taken, shapely.MultiPoint(cloud[:, :2] + shift), gap):
                yield np.array([*shift, drop])

    def _hand_over_postures(self, held: HeldObject) -> Iterator[Array]:
        turns = poses.rotation_about((0, 0, 1), np.arange(HEADINGS) * 2 * np.pi / HEADINGS)
        towards = np.array(AHEAD)
        rotations = turns @ self.robot.world_from_grip[:3, :3]
        free = rotations @ held.free * (1, 1, 0)
        length = np.linalg.norm(free, axis=1, keepdims=True)
        ahead = np.where(length > MIN_FREE_LENGTH, free / np.maximum(length, MIN_FREE_LENGTH), 0.0)
        is_between = rotations[:, :, 2] @ towards < -IN_THE_WAY
        worse = is_between - 2 * np.digitize(ahead @ towards, FACING)
        for offset in OFFSETS:
            for level in np.unique(worse):
                goals = poses.pose(rotations[worse == level], MEETING + offset * towards)
                answer = held.planner.inverse_kinematics(goals)
                found, reached = goals[answer.found], answer.joints[answer.found]
                for i in np.argsort(held.planner.travel_time(reached), kind="stable"):
                    at, joints = found[i], reached[i]
                    back = held.planner.plan_straight(at @ BACKWARDS, start=at, joints=joints)
                    if back is not None:  # the hand can leave what it has given
                        yield joints

    def point_at(self, cloud: Array, planner: PathPlanner) -> str:
        """Point at the middle of a cloud (n, 3), touching nothing; return why it failed, or ""."""
        if self.robot.kind.gripper:
            self.robot.open(0.0)
        middle = cloud.mean(axis=0)
        rotations = hand_orientations(POINTING_TILTS_DEG)
        along = rotations[..., 2]
        # The nearest point of the cloud along the approach direction keeps its distance.
        depth = np.min((cloud - middle) @ along.T, axis=0) - POINTING_GAP
        at = middle + (depth - self.robot.tip)[:, None] * along
        answer = planner.inverse_kinematics(poses.pose(rotations, at))
        for goal in answer.joints[answer.found]:
            if (path := planner.plan_transit(goal, 0.0, gap=POINTING_GAP / 2)) is not None:
                free = self.robot.follow(path, pace=TRANSIT_PACE, stop=self.robot.is_touching)
                return "" if free else "bumped"
        return "unreachable"
