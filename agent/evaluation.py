# SPDX-License-Identifier: Apache-2.0
"""The paper's evaluation, from spoken rules to decisions and to grasps.

`paper` teaches Scenario A and B of Table 2 by sentence and gives the 15 commands with all objects
on the table (section 4.1); `grasps` teaches the 16 grasp rules by sentence and has the simulated
robot carry out each from several random poses. What is right comes from the scenario alone.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from time import process_time

from rich.console import Console
from rich.progress import track
from rich.table import Table

from ..ontology.errors import UnknownNameError
from .agent import Agent
from .outcome import Json
from .reply import Reply
from .scenarios import ACTIONS, Scenario, grasp_sentence, load_scenarios

HELD_S = 1.0  # how long a grasped object must be held [s]
LIFTED_M = 0.10  # how high it must be lifted [m]


@dataclass(frozen=True)
class Case:
    """One command and what came of it.

    Attributes:
        label: what was asked, for the table.
        right: whether it is what the scenario says.
        found: what was chosen or done.
        expected: what the scenario allows.
        kind: "unique", "tie" or "none" for decisions, "grasp" for grasps.
        principle: of section 4.1, 1 to 4; 0 for grasps.
        right_part: whether the fingers touched the required part only; None where none closed.
        seconds: processor time [s].
    """

    label: str
    right: bool
    found: str
    expected: str
    kind: str
    principle: int = 0
    right_part: bool | None = None
    seconds: float = 0.0


@dataclass(frozen=True)
class Report:
    """The cases of one evaluation."""

    name: str
    cases: tuple[Case, ...]
    seed: int

    @property
    def is_right(self) -> bool:
        """Whether every case is right."""
        return all(case.right for case in self.cases)

    def as_json(self) -> Json:
        """As `hilt evaluate --json` prints it."""
        kinds = [case.kind for case in self.cases]
        closed = [case for case in self.cases if case.right_part is not None]
        return {
            "name": self.name,
            "runs": len(self.cases),
            "right": sum(case.right for case in self.cases),
            "by_principle": self._by_principle(),
            "unique": kinds.count("unique"),
            "ties": kinds.count("tie"),
            "none": kinds.count("none"),
            "grasps": len(closed),
            "right_part": sum(bool(case.right_part) for case in closed),
            "cpu_s": round(sum(case.seconds for case in self.cases), 3),
            "wrong": [f"{c.label}: {c.found}, not {c.expected}" for c in self.cases if not c.right],
            "seed": self.seed,
        }

    def _by_principle(self) -> dict[str, dict[str, int]]:
        numbers = sorted({case.principle for case in self.cases} - {0})
        groups = {n: [case.right for case in self.cases if case.principle == n] for n in numbers}
        return {str(n): {"runs": len(g), "right": sum(g)} for n, g in groups.items()}

    def table(self) -> Table:
        """The cases as a table, with the total below."""
        right = sum(case.right for case in self.cases)
        table = Table(
            "asked", "chosen", "expected", "right",
            title=f"{self.name}: {right} of {len(self.cases)} right (seed {self.seed})",
            title_justify="left",
        )  # fmt: skip
        for case in self.cases:
            mark = "[green]yes" if case.right else "[red]no"
            table.add_row(case.label, case.found, case.expected, mark)
        return table


def run(what: str, *, poses: int, seed: int, console: Console) -> Report:
    """Run one evaluation with a progress bar.

    Args:
        what: its name, one of `EVALUATIONS`.
        poses: random poses for each combination, where it grasps.
        seed: of the scenes.
        console: where the progress is shown.

    Raises:
        UnknownNameError: there is no evaluation of that name.
    """
    if what not in EVALUATIONS:
        raise UnknownNameError("evaluation", what, EVALUATIONS)
    count, cases = EVALUATIONS[what](poses, seed)
    shown = track(cases, description=what, total=count, console=console, transient=True)
    return Report(what, tuple(shown), seed)


# --- Decisions (Table 2) -------------------------------------------------------------------


def _paper(_: int, seed: int) -> tuple[int, Iterable[Case]]:
    scenarios = load_scenarios()
    count = sum(len(scenario.affordances) * len(ACTIONS) for scenario in scenarios)
    return count, (case for scenario in scenarios for case in _decisions(scenario, seed))


def _decisions(scenario: Scenario, seed: int) -> Iterator[Case]:
    scene = sorted(scenario.grasps)
    with Agent.open("memory:", scene=f"objects:{','.join(scene)}", seed=seed, simulate=False) as it:
        for sentence in scenario.sentences():
            it.hear(sentence, only="tell")
        for affordance in scenario.affordances:
            for action, words in ACTIONS.items():
                reply = it.hear(f"{words} something used for {affordance}", only="do")
                yield _judged_decision(scenario, affordance, action, scene, reply)


def _judged_decision(
    scenario: Scenario, affordance: str, action: str, scene: list[str], reply: Reply
) -> Case:
    best = scenario.best(affordance, scene)
    decision = reply.achievement.decision if reply.achievement else None
    chosen = decision.object.best.object if decision and decision.object.best else None
    part = decision.chosen_part if decision else None
    parts = {scenario.grasps[name].get(action) for name in best} if best else {None}
    expected = " or ".join(sorted(best)) or "nothing"
    return Case(
        label=f"{scenario.name}: {action} something used for {affordance}",
        right=(chosen in best and part in parts) if best else chosen is None,
        found=f"{chosen or 'nothing'}{f' by the {part}' if part else ''}",
        expected=expected,
        kind="none" if not best else "unique" if len(best) == 1 else "tie",
        principle=4 if not best else 1 if len(best) == 1 else 3,
    )


# --- Grasps --------------------------------------------------------------------------------


def _grasps(poses: int, seed: int) -> tuple[int, Iterable[Case]]:
    grasps = load_scenarios()[0].grasps
    count = poses * sum(len(parts) for parts in grasps.values())
    cases = (
        _grasped(name, context, part, seed + pose)
        for name, parts in grasps.items()
        for context, part in parts.items()
        for pose in range(poses)
    )
    return count, cases


def _grasped(name: str, context: str, part: str, seed: int) -> Case:
    """Teach one grasp rule, ask for the object alone on the table, and look at the world."""
    began = process_time()
    with Agent.open("memory:", scene=f"objects:{name}", seed=seed, simulate=True) as agent:
        agent.hear(grasp_sentence(name, context, part), only="tell")
        reply = agent.hear(f"{ACTIONS[context]} the {name}", only="do")
    world = reply.achievement.world if reply.achievement else None
    touched = world.touched if world else ()
    lifted, held = (world.lifted_m, world.held_s) if world else (0.0, 0.0)
    return Case(
        label=f"{context} {name} (seed {seed})",
        right=touched == (part,) and lifted >= LIFTED_M and held >= HELD_S,
        found=f"{', '.join(touched) or reply.said}, {lifted:.3f} m, {held:.1f} s",
        expected=part,
        kind="grasp",
        right_part=touched == (part,) if touched else None,
        seconds=process_time() - began,
    )


EVALUATIONS: Mapping[str, Callable[[int, int], tuple[int, Iterable[Case]]]] = {
    "paper": _paper,
    "grasps": _grasps,
}
