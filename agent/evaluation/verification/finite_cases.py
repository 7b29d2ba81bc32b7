"""The finite cases of the verification, run with the code under test.

Each function returns its results as plain JSON, and a line for each deviation from the definition.
Cells, objects, parts, actions and levels are given by their indices; sets of objects and of cells
as bit masks.
"""

from collections.abc import Sequence
from dataclasses import astuple

from ....inference.interval_operators import Operators
from ....inference.types import Candidate, Inference, Target
from ....kb.interval import VACUOUS
from ....kb.rule import DEFAULT_SPEAKER
from ....nlu.semantics import meaning
from ....sim.scene.scene import Placement, Scene
from ...config import household
from ...dialogue.translation import request_from_command
from ...execution.outcome import Json
from ...execution.perception import PerfectVision
from ..learning_scenarios import ACTIONS, CONTEXTS
from .scenario_space import CODES, CONFIDENCES, ScenarioSpace, belief, bit_mask, levels_of, sentence
from .taught_agent import RuleKey, TaughtAgent, TracedDecision, acceptable_candidates

CheckResult = tuple[Json, list[str]]  # facts, and a line for each deviation
DIGITS = 9  # precision of written scores; exact for the levels of the paper
FINDING = "pointTo"  # the action that only finds an object


def check_words(space: ScenarioSpace) -> CheckResult:
    """Check the rules of all sentences, the goals of all commands, and perception of all scenes."""
    taught = [
        [sentence(*key), space.index[RuleKey.from_rule(rule)], *astuple(rule.interval)]
        for key, rule in space.rules.items()
    ]
    wanted = [
        [sentence(cell, level), space.index[cell], CONFIDENCES[level], 1.0]
        for cell, level in space.rules
    ]
    commands = [list(each) for each in space.commands()]
    asked = [_command(space, str(text)) for text, *_ in commands]
    seen = [_seen(space, mask) for mask in range(2 ** len(space.objects))]
    pairs = ((taught, wanted), (asked, commands), (seen, range(len(seen))))
    wrong = [line for found, right in pairs for line in differences(found, right)]
    return {"sentences": taught, "commands": asked, "scenes": seen}, wrong


def _command(space: ScenarioSpace, text: str) -> list[str | int]:
    said = space.language.understand(text).meaning
    if not isinstance(said, meaning.Command):
        return [text, -1, -1]
    request = request_from_command(said, DEFAULT_SPEAKER)
    wanted = getattr(request.arguments["object"], "used_for", None)
    number = space.affordances.index(wanted) if wanted in space.affordances else -1
    return [text, [*ACTIONS].index(request.action), number]


def _seen(space: ScenarioSpace, mask: int) -> int:
    things = tuple(Placement(name, name) for name in space.scene(mask))
    vision = PerfectVision(Scene(things, seed=0), household().objects)
    found = vision.search([f"object:{name}" for name in space.objects])
    return space.mask(percept.object for percept in found if percept.confidence == 1.0)


def differences(found: Sequence[object], wanted: Sequence[object]) -> list[str]:
    """Return a line for each pair of items that differ."""
    pairs = zip(found, wanted, strict=True)
    return [f"{one}, not {other}" for one, other in pairs if one != other]


def check_scores(space: ScenarioSpace, shift: int) -> CheckResult:
    """Check the score of each cell at one code, among cells of other codes.

    A row is lower, upper, lambda, accepted, then the cells of the proof, those that were read, and
    those whose rules were met. Each score must be the same, to the last bit, with all objects in
    the scene and if only its own cell was taught; its proof must evaluate to its interval.
    """
    # The 16 shifts together give each cell each code once, always among other codes.
    codes = [(shift + i) % len(CODES) for i in range(len(space.cells))]
    rows: list[list[float]] = []
    wrong: list[str] = []
    with space.taught_agent(codes) as taught:
        for cell, code in zip(space.cells, codes, strict=True):
            decided = decide_about(taught, cell, [cell.object])
            found = candidate_of(cell, decided)
            full = candidate_of(cell, decide_about(taught, cell, space.objects))
            with TaughtAgent(space.rules[cell, level] for level in levels_of(code)) as other:
                alone = candidate_of(cell, decide_about(other, cell, [cell.object]))
            proven = map(RuleKey.from_rule, found.rules if found else ())
            sets = (proven, decided.read, decided.listed)
            rows.append([*score_of(found), *map(space.cell_mask, sets)])
            is_same = _bounds(found) == _bounds(full) == _bounds(alone)
            is_proven = not found or found.proof.evaluate(Operators()) == found.interval
            if not is_same or rows[-1][0] != belief(code) or not is_proven:
                wrong.append(f"{cell} at code {code} has {rows[-1]}")
    return {"rows": rows}, wrong


def score_of(candidate: Candidate | None) -> list[float]:
    """Return lower, upper, lambda and accepted of a candidate; None if no rule applies."""
    if candidate is None:
        return [0.0, 1.0, 0.0, 0]
    numbers = (round(n, DIGITS) for n in (*_bounds(candidate), candidate.certainty))
    return [*numbers, int(candidate.accepted)]


def decide_about(taught: TaughtAgent, cell: RuleKey, scene: Sequence[str]) -> TracedDecision:
    """Return the decision about a command that asks for the conclusion of a cell."""
    if cell.context:
        return taught.decide(cell.context, Target(object=cell.object), scene)
    return taught.decide(FINDING, Target(used_for=cell.argument), scene)


def candidate_of(cell: RuleKey, decided: TracedDecision) -> Candidate | None:
    """Return the candidate of a cell in a decision; None if no rule applies."""
    inference = decided.part if cell.context else decided.object
    for each in inference.candidates if inference else ():
        if each.object == cell.object and each.argument and each.argument.name == cell.argument:
            return each if each.rules else None
    return None


def _bounds(candidate: Candidate | None) -> tuple[float, float]:
    interval = candidate.interval if candidate else VACUOUS
    return interval.lower, interval.upper


def check_grasps(space: ScenarioSpace, first: int) -> CheckResult:
    """Check the choice between the parts of each object, one at code `first`, the other at any.

    A row contains the bit mask of the acceptable parts for each object and context.
    """
    firsts = {(name, space.parts[name][0]) for name in space.objects}
    rows: list[list[int]] = []
    for second in CODES:
        codes = [
            (first if (cell.object, cell.argument) in firsts else second) if cell.context else 0
            for cell in space.cells
        ]
        asked = ((name, context) for name in space.objects for context in CONTEXTS)
        with space.taught_agent(codes) as taught:
            chosen = ((o, taught.decide(to, Target(object=o), [o]).part) for o, to in asked)
            rows.append([parts_mask(space, *each) for each in chosen])
    wrong = [
        f"codes {first} and {second} give {mask}"
        for second, row in enumerate(rows)
        for mask in row
        if mask != highest_codes([first, second])
    ]
    return {"rows": rows}, wrong


def parts_mask(space: ScenarioSpace, name: str, found: Inference | None) -> int:
    """Return the bit mask of the acceptable parts of an object."""
    chosen = (each.argument.name for each in acceptable_candidates(found) if each.argument)
    return bit_mask(map(space.parts[name].index, chosen))


def highest_codes(codes: Sequence[int]) -> int:
    """Return the bit mask of the highest non-zero codes; a higher code means a higher belief."""
    highest = max(codes, default=0)
    return bit_mask(i for i, code in enumerate(codes) if code == highest and highest)
