"""Execution of the primitives of action trees by the motion of a robot.

Each is one call of `Motion` or `ExtraPrimitives`. A report of a failure becomes an answer.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any

from ...inference.types import Candidate
from ...kb.episodes import HELD, GraspTrial
from ...ontology.logs import timed
from ...sim.manipulation.motion_report import MotionReport
from ...sim.vision.percept import Percept
from ..protocols import ExtraPrimitives, Motion, ReleasingMotion, Vision
from . import outcome_answer
from .outcome import AnswerContent, Failure, WorldOutcome
from .request import Arguments, named

DRIVEN = "driven"  # what the robot senses when something is in all the way
MM = 1e3  # in a metre
_FIRMNESS = ("score", "slip_m", "slip_rad")  # of reports and of the outcome
_GRASPED = ("touched", "attempts", *_FIRMNESS)
_OUTCOMES = {"nothing_held": "dropped"} | {
    reason: reason for reason in ("slipped", "dropped", "wrong_part", "missed")
}
EMPTYING = {"placeObject": "put_down", "returnObject": "put_back", "letGo": "release"}
"""The primitives that empty the hand, and the methods of a `ReleasingMotion` for them."""


class GraspLog:
    """Collects the trials of grasps: each grasp is begun, and followed until the next."""

    def __init__(self) -> None:
        self._before: tuple[GraspTrial, ...] = ()  # those of earlier grasps
        self._trial: GraspTrial | None = None  # the grasp that the hand is at
        self._failures: tuple[str, ...] = ()  # of its attempts
        self._ended: str | None = None  # how it stands, if that is known

    def begin(self, of: str, part: str | None, context: str, report: MotionReport) -> None:
        """Note a grasp of an object; without a part it is by the only one that was touched."""
        touched = report.touched[0] if len(report.touched) == 1 else ""
        self._before, self._failures, self._ended = self.trials, (), None
        self._trial = GraspTrial(of, part or touched, context, HELD)
        self.follow(report)

    def follow(self, report: MotionReport, *, is_offered: bool = False) -> None:
        """Note a motion with the object in the hand, which may be offered to somebody."""
        self._failures = report.failures or self._failures
        if report.ok:
            self._ended = HELD
        elif report.reason in _OUTCOMES:
            self._ended = _OUTCOMES[report.reason]
        elif report.reason == outcome_answer.INTERRUPTED:
            self._ended = None
        elif is_offered:
            self._ended = "refused"

    @property
    def trials(self) -> tuple[GraspTrial, ...]:
        """All trials so far, in order, of which the part is known; failed attempts, too."""
        trial, outcomes = self._trial, [_OUTCOMES[e] for e in self._failures if e in _OUTCOMES]
        if trial is None or not trial.part:
            return self._before
        if self._ended and self._ended not in outcomes:
            outcomes.append(self._ended)
        return (*self._before, *(replace(trial, outcome=each) for each in outcomes))


@dataclass(frozen=True)
class PrimitiveTask:
    """One primitive to perform."""

    action: str  #: its name ("graspObject")
    arguments: Arguments
    percept: Percept | None  #: the object it is about, if one was found
    part: str | None = None
    constraint: Candidate | None = None  #: what was concluded at the node
    #: parameter -> the percept that was found for it
    found: Mapping[str, Percept] = field(default_factory=dict[str, Percept])
    context: str = ""  #: the action that it is part of ("pass")


class PrimitiveExecutor:
    """Performs primitives with a motion stack, and keeps what happened."""

    def __init__(self, motion: Motion, vision: Vision, goal: str = "use") -> None:
        self.world, self.grasps, self.goal = WorldOutcome(), GraspLog(), goal
        self.holding: str | None = None  #: the name of the object in the hand, if any
        self.sensed: set[str] = set()  #: the events that the robot has sensed ("driven")
        self.tool: str | None = None  #: the type of what is used, for answers
        self.patient: str | None = None  #: that of what it is used on
        self._motion, self._vision = motion, vision
        self._part: str | None = None
        self._depth_before_mm = 0.0
        self._primitives: Mapping[str, Callable[[PrimitiveTask], Failure]] = {
            "graspObject": self._grasp,
            "moveTo": self._move_to,
            "handOver": self._hand_over,
            "pointAt": self._point_at,
            "moveAbove": self._move_above,
            "raise": lambda _: self._struck(motion.raise_()),
            "lower": lambda _: self._struck(motion.lower()),
            **dict.fromkeys(EMPTYING, self._empty_hand),
        }

    def perform(self, task: PrimitiveTask) -> Failure:
        """Perform a primitive; return the failure, if any."""
        with timed(__name__, "perform %s", task.action):
            return self._primitives.get(task.action, self._skill)(task)

    def not_sensed(self, event: str) -> AnswerContent:
        """Return the answer when a loop ended without sensing its event."""
        if event == DRIVEN:
            return self._not_driven("not_driven")
        return outcome_answer.failed(f"not {event}", self.tool or "thing", "not_driven")

    def _grasp(self, task: PrimitiveTask) -> Failure:
        if task.percept is None:
            return _nothing_seen(None)
        self._part = task.part
        report = self._motion.grasp(task.percept, task.part)
        self.grasps.begin(task.percept.object, task.part, task.context, report)
        self.world = WorldOutcome(moved=self.world.moved)
        self.holding = task.percept.name if report.ok else None
        return self._moved(report, task, *_GRASPED)

    def _move_to(self, task: PrimitiveTask) -> Failure:
        report = self._motion.lift()
        self.grasps.follow(report)
        return self._moved(report, task, *_GRASPED, "lifted_m", "held_s")

    def _hand_over(self, task: PrimitiveTask) -> Failure:
        report = self._motion.hand_over()
        self.grasps.follow(report, is_offered=True)
        handed = {"handed_over": report.ok, "handed_over_at": report.at}
        return self._moved(report, task, *_FIRMNESS, "facing_rad", "clearance_m", **handed)

    def _empty_hand(self, task: PrimitiveTask) -> Failure:
        failure = empty_hand(self._motion, task.action, named(task.arguments.get("object")))
        # To point at something the robot puts down what it holds, so that it is down already.
        is_down = failure.key == "nothing_held" and self.holding is not None
        if failure.ending == "failed" and not is_down:
            return failure
        self.holding = None
        self.world = replace(self.world, executed=True)
        return None

    def _point_at(self, task: PrimitiveTask) -> Failure:
        if task.percept is None:
            return _nothing_seen(None)
        return self._moved(self._motion.point_at(task.percept), task)

    def _move_above(self, task: PrimitiveTask) -> Failure:
        name = named(task.arguments.get("patient"))
        if not (seen := self._vision.search([f"object:{name}"])):
            return _nothing_seen(name)
        report = self._motion.move_above(seen[0])
        self._depth_before_mm = report.depth_m * MM
        return self._struck(report)

    def _skill(self, task: PrimitiveTask) -> Failure:
        if not isinstance(motion := self._motion, ExtraPrimitives):
            slots = {"goal": task.action, "object": self.tool or "thing", "ability": task.action}
            return AnswerContent("not_able", slots, "failed", "unable")
        meant: dict[str, Percept | str] = dict(task.found)
        for parameter, argument in task.arguments.items():
            if parameter not in meant:
                name = named(argument) or "thing"
                meant[parameter] = next(iter(self._vision.search([f"object:{name}"])), name)
        return self._moved(motion.perform(task.action, meant, task.constraint), task)

    def _struck(self, report: MotionReport) -> Failure:
        self.grasps.follow(report)
        depth_mm = report.depth_m * MM
        driven_mm = depth_mm - self._depth_before_mm
        self.world = replace(self.world, nail_depth_mm=depth_mm, driven_mm=driven_mm)
        if report.driven:
            self.sensed.add(DRIVEN)
            return None  # driven in: another failure of the last blow does not matter
        return None if report.ok else self._not_driven(report.reason)

    def _not_driven(self, reason: str) -> AnswerContent:
        tool = self.tool or "thing"
        if _OUTCOMES.get(reason) == "dropped":
            return AnswerContent("dropped", {"object": tool}, "failed", reason)
        key = "not_driven" if reason == "not_driven" else "cannot_strike"
        slots = {"goal": self.goal, "patient": self.patient or "thing", "tool": tool}
        return AnswerContent(key, slots, "failed", reason)

    def _moved(self, report: MotionReport, task: PrimitiveTask, *same: str, **new: Any) -> Failure:
        new |= {name: getattr(report, name) for name in same}
        new["moved"] = self.world.moved + report.moved
        self.world = replace(self.world, executed=True, **new)
        name = task.percept.object if task.percept else self.tool or "thing"
        return None if report.ok else outcome_answer.motion_failed(report, name, self._part)


def empty_hand(motion: Motion | None, primitive: str, kind: str | None) -> AnswerContent:
    """Empty the hand of a robot by one of `EMPTYING`; return the answer.

    `kind` is the kind of object that the hand should hold, None for any.
    """
    held = motion.held if isinstance(motion, ReleasingMotion) else None
    if not isinstance(motion, ReleasingMotion) or held is None:
        return AnswerContent("nothing_held", {}, "failed", "nothing_held")
    if kind not in {None, held.object}:
        return AnswerContent("not_held", {"object": str(kind)}, "failed", "nothing_held")
    report: MotionReport = getattr(motion, EMPTYING[primitive])()
    return outcome_answer.hand_emptied(primitive, held.object, "" if report.ok else report.reason)


def _nothing_seen(name: str | None) -> AnswerContent:
    return AnswerContent("nothing_seen", {"object": name or "thing"}, "failed", "nothing_seen")
