# SPDX-License-Identifier: Apache-2.0
"""What a command came to, judged by a scenario alone.

The four principles of section 4.1: (1) the top-ranked object is there, and must be chosen; (2) it
is not, and the next lower one must be; (3) several are equally high, and either may be; (4) there
is none, and the robot says so. Where a hand moved, the world is judged too: which part the fingers
touched, how high and how long the thing was held.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

from ..outcome import Decision, Json, World
from ..reply import Reply
from .case import Case, Kind, Result
from .scenarios import Scenario

HELD_S = 1.0  # how long a grasped object must be held [s]
LIFTED_M = 0.10  # how high it must be lifted [m]
GRASPING = ("pass", "pickUp")  # the actions that close the hand


@dataclass(frozen=True)
class Truth:
    """What a scenario allows for one command in one scene.

    Attributes:
        objects: the right choices; empty when the right answer is that there is none.
        principle: the one of section 4.1 that decides, 1 to 4.
        parts: object -> the part to grasp, for those that are right and actions that grasp.
    """

    objects: frozenset[str]
    principle: int
    parts: dict[str, str]

    @classmethod
    def of(cls, scenario: Scenario, action: str, affordance: str, scene: Collection[str]) -> Truth:
        """Read it off the table of the scenario."""
        best = scenario.best(affordance, scene)
        grasps = {name: scenario.grasps[name] for name in best if action in GRASPING}
        parts = {name: each[action] for name, each in grasps.items() if action in each}
        is_top = best <= scenario.best(affordance, scenario.grasps)
        principle = 4 if not best else 3 if len(best) > 1 else 1 if is_top else 2
        return cls(best, principle, parts)

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
        return " or ".join(named(name, self.parts.get(name)) for name in sorted(self.objects)) or (
            "nothing"
        )


def named(chosen: str | None, part: str | None) -> str:
    """A choice as a table shows it."""
    return f"{chosen or 'nothing'}{f' by the {part}' if part else ''}"


def judged(case: Case, truth: Truth, reply: Reply) -> Result:
    """The result of a command: its decision and, where a hand moved, what it did in the world."""
    came = reply.achievement
    decision = came.decision if came else None
    chosen = decision.object.best.object if decision and decision.object.best else None
    part = decision.chosen_part if decision else None
    right = truth.allows(chosen, part)
    facts = _decided(decision, reply) | {"decided": right}
    if came and came.world.executed:
        done = _done(came.world, part, reply)
        facts |= done
        right = right and done["success"] is True
    return Result(
        case.key, right, truth.kind, truth.principle, named(chosen, part), truth.in_words(), facts
    )


def _decided(decision: Decision | None, reply: Reply) -> Json:
    found = decision.object if decision else None
    best = found.best if found else None
    return {
        "asked": reply.text,
        "said": reply.said,
        "object": best.object if best else None,
        "part": decision.chosen_part if decision else None,
        "lower": round(best.interval.lower, 6) if best else None,
        "upper": round(best.interval.upper, 6) if best else None,
        "ties": [each.object for each in found.ties] if found else [],
    }


def _done(world: World, part: str | None, reply: Reply) -> Json:
    """What happened in the world; `right_part` only where the fingers closed on something."""
    if part is None:  # pointing
        return {"success": reply.is_done}
    held = world.lifted_m >= LIFTED_M and world.held_s >= HELD_S
    right_part = world.touched == (part,)
    facts: Json = {
        "success": reply.is_done and held and right_part,
        "touched": list(world.touched),
        "lifted_m": round(world.lifted_m, 4),
        "held_s": round(world.held_s, 3),
        "handed_over": world.handed_over,
        "attempts": world.attempts,
    }
    return facts | {"right_part": right_part} if world.touched else facts


def grasped(case: Case, part: str, reply: Reply) -> Result:
    """The result of a grasp that was asked for by the name of the thing."""
    world = reply.achievement.world if reply.achievement else World()
    facts: Json = {"asked": reply.text, "said": reply.said, **_done(world, part, reply)}
    touched = ", ".join(world.touched) or "nothing"
    found = f"{touched}, {world.lifted_m:.3f} m, {world.held_s:.1f} s"
    return Result(case.key, facts["success"] is True, "grasp", 0, found, part, facts)
