# SPDX-License-Identifier: Apache-2.0
"""What a command came to, judged by a scenario alone.

The four principles of section 4.1: (1) the top-ranked object is there, and must be chosen; (2) it
is not, and the next lower one must be; (3) several are equally high, and either may be; (4) there
is none, and the robot says so. What is judged by them is the first choice. Where a hand moved, the
world is judged too: which part the fingers touched, how high and how long the thing was held. A
robot that cannot take what it chose and takes the next best one has decided well and not succeeded.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from ....inference.types import Candidate
from ...dialogue.reply import Reply
from ...execution.outcome import ExecutionResult, GoalResult, Json
from ..case import Case, Kind, Result
from ..scenarios import Scenario
from .explaining import why

HELD_S = 1.0  # how long a grasped object must be held [s]
LIFTED_M = 0.10  # how high it must be lifted [m]
GRASPING = ("pass", "pickUp")  # the actions that close the hand


@dataclass(frozen=True)
class Truth:
    """What a scenario allows for one command in one scene.

    Attributes:
        objects: the right choices; empty when the right answer is that there is none.
        principle: the one of section 4.1 that decides, 1 to 4.
        parts: object -> the part by which it is to be taken; empty for actions that do not grasp.
    """

    objects: frozenset[str]
    principle: int
    parts: Mapping[str, str]

    @classmethod
    def of(cls, scenario: Scenario, action: str, affordance: str, scene: Collection[str]) -> Truth:
        """Read it off the table of the scenario."""
        best = scenario.best(affordance, scene)
        is_top = best <= scenario.best(affordance, scenario.grasps)
        principle = 4 if not best else 3 if len(best) > 1 else 1 if is_top else 2
        grasps = scenario.grasps.items() if action in GRASPING else ()
        return cls(
            best, principle, {name: parts[action] for name, parts in grasps if action in parts}
        )

    @property
    def kind(self) -> Kind:
        """How many choices are right."""
        return "none" if not self.objects else "unique" if len(self.objects) == 1 else "tie"

    def allows(self, chosen: str | None, part: str | None) -> bool:
        """Whether a choice is right; None for none."""
        if not self.objects or chosen is None:
            return not self.objects and chosen is None
        return chosen in self.objects and part == self.parts.get(chosen)

    def in_words(self) -> str:
        """As a table shows it."""
        each = (named(name, self.parts.get(name)) for name in sorted(self.objects))
        return " or ".join(each) or "nothing"


def named(chosen: str | None, part: str | None) -> str:
    """A choice as a table shows it."""
    return f"{chosen or 'nothing'}{f' by the {part}' if part else ''}"


def judged(case: Case, truth: Truth, reply: Reply) -> Result:
    """The result of a command: its decision and, where a hand moved, what it did in the world."""
    found, grasp = _first(reply, "findObject"), _first(reply, "graspObject")
    chosen = found.object if found else None
    part = grasp.argument.name if grasp and grasp.argument else None
    right = truth.allows(chosen, part)
    facts: Json = {
        "asked": reply.text,
        "said": reply.said,
        "object": chosen,
        "part": part,
        "lower": round(found.interval.lower, 6) if found else None,
        "upper": round(found.interval.upper, 6) if found else None,
        "decided": right,
    }
    found_words = named(chosen, part)
    came = reply.achievement
    if came and came.world.executed:
        facts |= _carried_out(came, truth, is_done=reply.is_done)
        if not facts["success"]:
            right, found_words = False, f"{found_words}, not carried out"
    return Result(
        case.key, right, truth.kind, truth.principle, found_words, truth.in_words(), facts
    )


def grasped(case: Case, name: str, part: str, reply: Reply) -> Result:
    """The result of a grasp that was asked for by the name of the thing."""
    world = reply.achievement.world if reply.achievement else ExecutionResult()
    facts: Json = {"asked": reply.text, "said": reply.said, **_grasped(world, name, part)}
    facts["why"] = why(reply)
    facts["success"] = reply.is_done and facts["success"] is True
    touched = ", ".join(world.touched) or "nothing"
    found = f"{touched}, {world.lifted_m:.3f} m, {world.held_s:.1f} s"
    return Result(case.key, facts["success"] is True, "grasp", 0, found, part, facts)


def _first(reply: Reply, action: str) -> Candidate | None:
    """What was concluded where an action came up first, before anything else was tried."""
    steps = reply.achievement.steps if reply.achievement else ()
    best = (step.inference.best for step in steps if step.node.endswith(f"/{action}"))
    return next(best, None)


def _carried_out(came: GoalResult, truth: Truth, *, is_done: bool) -> Json:
    """What happened in the world, to the thing that was taken in the end."""
    world = came.world
    best = came.decision.object.best if came.decision else None
    taken = best.object if best else ""
    facts: Json = {"success": True}
    if taken in truth.parts:  # where nobody said by which part, any will do
        facts = _grasped(world, taken, truth.parts[taken]) | {"handed_over": world.handed_over}
    facts["success"] = is_done and taken in truth.objects and facts["success"] is True
    return facts


def _grasped(world: ExecutionResult, taken: str, part: str) -> Json:
    """How a thing was held; `right_part` only where the fingers closed on something."""
    right_part = world.touched == (part,)
    facts: Json = {
        "success": right_part and world.lifted_m >= LIFTED_M and world.held_s >= HELD_S,
        "taken": taken,
        "touched": list(world.touched),
        "lifted_m": round(world.lifted_m, 4),
        "held_s": round(world.held_s, 3),
        "attempts": world.attempts,
    }
    return facts | {"right_part": right_part} if world.touched else facts
