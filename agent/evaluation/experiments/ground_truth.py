"""Ground truth of commands, and results of what the agent decided and did.

The ground truth is read from the scenario alone, by the four principles of section 4.1: (1) the
top-ranked object is present and must be chosen; (2) it is not, and the next lower one must be
chosen; (3) several are equally high, and any of them may be chosen; (4) there is none, and the
robot says so. The first choice is judged by them. If the robot moved, its actions are judged too:
which part the fingers touched, how high and how long the object was held. A robot that cannot take
what it chose and takes the next best object has decided right but not succeeded.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass

from ....inference.types import Candidate
from ...dialogue.reply import Reply
from ...execution.outcome import GoalResult, Json
from ..experiment import Case, CaseResult, Kind
from ..learning_scenarios import LearningScenario

HELD_S = 1.0  # how long a grasped object must be held [s]
LIFTED_M = 0.10  # how high it must be lifted [m]


@dataclass(frozen=True)
class CorrectChoices:
    """The right choices for a command in a scene."""

    objects: frozenset[str]  # empty if the right answer is that there is none
    principle: int  # of section 4.1, 1 to 4; 0 for an object by name
    # object -> the parts by which it may be grasped; empty if any will do, or none
    parts: Mapping[str, frozenset[str]]

    @classmethod
    def from_scenario(
        cls, scenario: LearningScenario, action: str, affordance: str, scene: Collection[str]
    ) -> "CorrectChoices":
        """Return the ground truth for a command, from the tables of a scenario."""
        best = scenario.best(affordance, scene)
        is_top = best <= scenario.best(affordance, scenario.grasps)
        principle = 4 if not best else 3 if len(best) > 1 else 1 if is_top else 2
        parts = {name: scenario.parts(name, action) for name in scenario.grasps}
        return cls(best, principle, parts)

    @property
    def kind(self) -> Kind:
        """The number of right choices as a kind of result."""
        return "none" if not self.objects else "unique" if len(self.objects) == 1 else "tie"

    def allows(self, chosen: str | None, part: str | None) -> bool:
        """Whether a choice is right; None stands for no choice."""
        if not self.objects or chosen is None:
            return not self.objects and chosen is None
        return chosen in self.objects and part in (self.parts[chosen] or {None})

    def describe(self) -> str:
        """Return the right choices as text."""
        parts = {name: " or ".join(sorted(self.parts[name])) for name in self.objects}
        return " or ".join(describe_choice(*each) for each in sorted(parts.items())) or "nothing"


def describe_choice(chosen: str | None, part: str | None) -> str:
    """Return a choice as text."""
    return f"{chosen or 'nothing'}{f' by the {part}' if part else ''}"


def judge_command(case: Case, truth: CorrectChoices, reply: Reply) -> CaseResult:
    """Return the result of a command: its decision and, if the robot moved, its execution."""
    found, grasp = _first_choice(reply, "findObject"), _first_choice(reply, "graspObject")
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
    found_words = describe_choice(chosen, part)
    if (achieved := reply.result) and achieved.world.executed:
        facts |= _execution_facts(achieved, truth, is_done=reply.is_done)
        if not facts["success"]:
            right, found_words = False, f"{found_words}, not carried out"
    expected = truth.describe()
    return CaseResult(case.key, right, truth.kind, truth.principle, found_words, expected, facts)


def _first_choice(reply: Reply, action: str) -> Candidate | None:
    steps = reply.result.steps if reply.result else ()
    return next((step.inference.best for step in steps if step.node.endswith(f"/{action}")), None)


def _execution_facts(achieved: GoalResult, truth: CorrectChoices, *, is_done: bool) -> Json:
    world = achieved.world
    best = achieved.decision.object.best if achieved.decision else None
    taken = best.object if best else ""
    right = is_done and taken in truth.objects
    if not truth.parts.get(taken):  # if no part was taught, any will do
        return {"success": right}
    right_part = len(world.touched) == 1 and world.touched[0] in truth.parts[taken]
    held = world.lifted_m >= LIFTED_M and world.held_s >= HELD_S
    facts: Json = {
        "success": right and right_part and held,
        "taken": taken,
        "touched": list(world.touched),
        "lifted_m": round(world.lifted_m, 4),
        "held_s": round(world.held_s, 3),
        "attempts": world.attempts,
        "handed_over": world.handed_over,
    }
    return facts | {"right_part": right_part} if world.touched else facts


def explain_reply(reply: Reply) -> list[str]:
    """Return the command and its answer, then every candidate with its verdict and proof."""
    explained = reply.decision.explained() if reply.decision else ()
    lines = (line for about, proof in explained for line in (about, *proof))
    return [reply.text, reply.said, *lines]
