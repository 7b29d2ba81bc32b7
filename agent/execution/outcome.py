"""The result of a command: the steps of its execution, the decision, and the state of the world.

`hilt do --json` prints these values, and episodes keep them. They hold no sentences but the reasons
of candidates: `nlu.generation` words an answer from its `key` and `slots`.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from math import degrees
from typing import Literal, TypeAlias

from ...inference.norms import NormVerdict
from ...inference.proof import Json, Proof
from ...inference.types import Candidate, Inference
from ...kb.episodes import GraspTrial
from ...kb.rule import Rule
from .doubt import Doubt

Slot = str | tuple[str, ...]  # a name or a list of names
Ending = Literal["done", "failed", "asked", "refused", "not_understood"]


@dataclass(frozen=True)
class AnswerContent:
    """An answer before it is put into words."""

    key: str  #: the template among the answers of the language
    slots: Mapping[str, Slot] = field(default_factory=dict[str, Slot])
    ending: Ending = "done"
    cause: str = ""  #: the cause of a failure, as the branches of action trees name it


Failure: TypeAlias = "AnswerContent | None"  # the answer to what failed, None where nothing did


@dataclass(frozen=True)
class WalkStep:
    """One node of the execution and its four operations."""

    node: str  #: its path ("pass/graspObject")
    features: tuple[str, ...]  #: what getFeatures returned, as text
    percepts: Mapping[str, float]  #: what the visual search found: name -> confidence
    inference: Inference  #: what getAffordance concluded
    #: the result of the action itself: "walked", "executed", "not executed", or the reason of its
    #: failure; empty before it is done
    action: str = ""

    @property
    def constraint(self) -> Candidate | None:
        """The constraint on the action, if any: this object, and this part or other argument."""
        return self.inference.best

    def as_json(self) -> Json:
        """As `hilt do --json` shows it."""
        best, constraint = self.constraint, None
        if best:
            constraint = {"object": best.object, "part": best.part, **_bounds(best)}
            if best.argument and not best.part:
                constraint["argument"] = str(best.argument)
        seen = self.percepts.items()
        return {
            "node": self.node,
            "features": [feature.partition(":")[2] for feature in self.features],
            "percepts": [{"name": name, "confidence": round(sure, 6)} for name, sure in seen],
            "constraint": constraint,
            "action": self.action,
        }


def _bounds(of: Candidate) -> Json:
    return {"lower": round(of.interval.lower, 6), "upper": round(of.interval.upper, 6)}


@dataclass(frozen=True)
class Decision:
    """Why this object, and why this part."""

    object: Inference  #: the inference at the find node
    #: the inference at the grasp node; None when the action does not grasp
    part: Inference | None = None
    named_part: str | None = None  #: the part that the command itself named, which needs no rule
    patient: str | None = None  #: what a tool is used on
    #: the candidates that were tried before it; their reasons say how that failed
    rejected: tuple[Candidate, ...] = ()
    allowed_part: str | None = None  #: the part that is taken because others are forbidden

    @property
    def chosen_part(self) -> str | None:
        """The part to act on; None when none is named, concluded, or left by a prohibition."""
        best = self.part.best if self.part else None
        return self.named_part or self.allowed_part or (best and best.part)

    @property
    def rules(self) -> tuple[Rule, ...]:
        """The rules that the choice rests on: those of the object, then those of the part."""
        part = self.part.best if self.part and not self.named_part else None
        forbidden = self.part.denied if self.part and self.allowed_part else ()
        chosen = [candidate for candidate in (self.object.best, part, *forbidden) if candidate]
        return tuple(dict.fromkeys(rule for candidate in chosen for rule in candidate.rules))

    @property
    def inferences(self) -> tuple[Inference, ...]:
        """The inference of the object, then that of the part if there is one."""
        return (self.object, self.part) if self.part else (self.object,)

    def proofs(self) -> tuple[Proof, ...]:
        """The proofs of the object and of the part, or of the likeliest candidates."""
        first = ((*each.candidates, *each.absent)[:1] for each in self.inferences)
        return tuple(candidate.proof for shown in first for candidate in shown)

    def explained(self) -> Iterator[tuple[str, list[str]]]:
        """Yield a line about every candidate of every node, with the lines of its proof."""
        for node in self.inferences:
            for candidate in (*node.candidates, *node.absent):
                about = f"{candidate.name} {candidate.argument or ''}".strip()
                line = f"{about}: {candidate.verdict}, {candidate.reason}"
                yield line, [f"  {each}" for each in candidate.proof.lines()]

    def proofs_as_json(self) -> list[Json]:
        """Every candidate of every node with its proof."""
        return [
            _candidate(candidate) | {"node": node.node, "proof": candidate.proof.as_json()}
            for node in self.inferences
            for candidate in (*node.candidates, *node.absent)
        ]

    def as_json(self) -> Json:
        """The `decision` of `hilt do --json`."""
        best = self.object.best
        first = best or next(iter(self.object.candidates), None)
        rejected = [_candidate(each) | {"accepted": False} for each in self.rejected]
        result: Json = {
            "object": best.object if best else None,
            "part": self.chosen_part,
            **(_bounds(first) if first else {"lower": None, "upper": None}),
            "lambda": round(first.certainty, 6) if first else None,
            "threshold": self.object.threshold,
            "candidates": [*map(_candidate, self.object.candidates), *rejected],
            "ties": [c.object for c in self.object.ties],
            "rules": [rule.id for rule in self.rules],
        }
        return result | ({"patient": self.patient} if self.patient else {})


def _candidate(candidate: Candidate) -> Json:
    return {
        "object": candidate.object,
        "name": candidate.name,
        **_bounds(candidate),
        "lambda": round(candidate.certainty, 6),
        "accepted": candidate.accepted,
        "verdict": candidate.verdict,
        "reason": candidate.reason,
        **({"inherited": candidate.inherited} if candidate.inherited else {}),
        **({"overruled": [rule.id for rule in candidate.overruled]} if candidate.overruled else {}),
    }


@dataclass(frozen=True)
class WorldOutcome:
    """What happened in the (simulated) world."""

    #: whether the robot was asked to act. If its planner found no way, the hand never closed, and
    #: `attempts` is 0.
    executed: bool = False
    touched: tuple[str, ...] = ()  #: the parts that the fingers touched when they closed
    lifted_m: float = 0.0
    held_s: float = 0.0
    handed_over: bool = False  #: whether it was still held at the hand-over pose
    #: that pose of the grip: x, y, z [m] and the unit quaternion x, y, z, w; empty when nothing was
    #: handed over
    handed_over_at: tuple[float, ...] = ()
    #: the level angle from its free part to the receiver then, None where it has none aside, and
    #: `clearance_m` the gap between that part and the fingers [m]
    facing_rad: float | None = None
    clearance_m: float | None = None
    moved: tuple[str, ...] = ()  #: the kinds of objects that were in the way and were put aside
    attempts: int = 0  #: the number of grasps
    score: float = 0.0  #: of the last one, at most about 1
    #: how far the object moved in the hand at the grip, and `slip_rad` how far it turned
    slip_m: float = 0.0
    slip_rad: float = 0.0
    #: the depth of the nail in its block [mm]; None when nothing was pounded
    nail_depth_mm: float | None = None
    driven_mm: float = 0.0  #: by how much it was driven in [mm]
    pictures: tuple[str, ...] = ()

    def as_json(self) -> Json:
        """The `world` of `hilt do --json`."""
        if not self.executed:
            return {"executed": False}
        result: Json = {
            "executed": True,
            "touched": list(self.touched),
            "lifted_m": round(self.lifted_m, 4),
            "held_s": round(self.held_s, 3),
            "handed_over": self.handed_over,
            "moved": list(self.moved),
            "attempts": self.attempts,
            "score": round(self.score, 3),
            "slip_m": round(self.slip_m, 4),
            "turn_deg": round(degrees(self.slip_rad), 1),
            "pictures": list(self.pictures),
        }
        if self.handed_over_at:
            pose = [round(value, 4) + 0.0 for value in self.handed_over_at]
            result["handed_over_at"] = {"position_m": pose[:3], "quaternion_xyzw": pose[3:]}
        if self.clearance_m is not None:
            result["clearance_m"] = round(self.clearance_m, 4)
        if self.facing_rad is not None:
            result["facing_deg"] = round(degrees(self.facing_rad), 1)
        if self.nail_depth_mm is not None:
            result["nail_depth_mm"] = round(self.nail_depth_mm, 2)
            result["driven_mm"] = round(self.driven_mm, 2)
        return result


@dataclass(frozen=True)
class GoalResult:
    """The result of one goal."""

    answer: AnswerContent  #: what to say in the end
    decision: Decision | None  #: which object and part, if the tree looks for any
    steps: tuple[WalkStep, ...]  #: the nodes in the order of execution
    world: WorldOutcome
    #: failures that a branch of the tree handled, and what is doubted, to be said before the answer
    setbacks: tuple[AnswerContent, ...] = ()
    trials: tuple[GraspTrial, ...] = ()  #: what each grasp came to
    doubt: Doubt | None = None  #: the part that experience speaks against, if that is asked about
    #: what norms said of it, where they forbade something or were in conflict
    verdicts: tuple[NormVerdict, ...] = ()

    @property
    def forbidding(self) -> NormVerdict | None:
        """The verdict because of which it was refused, or asked about; None where it was not."""
        norm = self.answer.slots.get("norm")
        found = (each for each in self.verdicts if each.forbidding and each.forbidding.id == norm)
        return next(found, None)

    def after(self, before: "GoalResult") -> "GoalResult":
        """Return this result and that of the goal before it as one."""
        return GoalResult(
            self.answer,
            self.decision or before.decision,
            (*before.steps, *self.steps),
            self.world if self.world.executed else before.world,
            (*before.setbacks, before.answer, *self.setbacks),
        )

    def as_json(self) -> Json:
        """The keys of `hilt do --json` on what was decided and done."""
        return {
            "decision": self.decision.as_json() if self.decision else None,
            "steps": [step.as_json() for step in self.steps],
            "world": self.world.as_json(),
            **({"norms": [each.as_json() for each in self.verdicts]} if self.verdicts else {}),
        }
