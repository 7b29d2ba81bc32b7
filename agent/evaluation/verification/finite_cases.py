"""The finite cases of the verification, run with the code under test.

Each function returns its results as plain JSON, and a line for each deviation from the definition.
Cells, objects, parts, actions and levels are given by their indices; sets of objects and of cells
as bit masks.
"""

from collections.abc import Iterable, Sequence
from dataclasses import astuple
from functools import cached_property

from ....inference.interval_operators import Operators
from ....inference.types import Candidate, Inference, Target
from ....kb.interval import VACUOUS
from ....kb.rule import DEFAULT_SPEAKER, Rule
from ....nlu.language import Language
from ....nlu.semantics import meaning
from ....sim.scene.scene import Placement, Scene
from ...config import household
from ...dialogue.translation import request_from_command, rule_from_meaning
from ...execution.outcome import Json
from ...execution.perception import PerfectVision
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS
from .scenario_space import CONFIDENCES, RuleKey, ScenarioSpace, belief, levels_of
from .taught_agent import TaughtAgent, TracedDecision, acceptable_candidates, belief_statements

CheckResult = tuple[Json, list[str]]  # facts, and a line for each deviation
DIGITS = 9  # precision of written scores; exact for the levels of the paper
FINDING = "pointTo"  # the action that only finds an object


class VerbalizedSpace(ScenarioSpace):
    """A space of learning scenarios, with the language that teaches them."""

    @cached_property
    def language(self) -> Language:
        """The language; it takes a quarter of a second to load."""
        return Language.load()

    @cached_property
    def rules(self) -> dict[tuple[RuleKey, str], Rule]:
        """Cell and level -> the rule that its sentence teaches."""
        cells = ((cell, level) for cell in self.cells for level in LEVELS)
        return {key: self.rule(self.sentence(*key)) for key in cells}

    def rule(self, sentence: str) -> Rule:
        """Return the only rule that a sentence teaches."""
        said = self.language.understand(sentence).meaning
        if not isinstance(said, meaning.Statement):
            raise TypeError(f'"{sentence}" is not understood as a statement: {said}.')
        (rule,) = said.rules
        return rule_from_meaning(rule, DEFAULT_SPEAKER)

    @cached_property
    def _statements(self) -> dict[str, frozenset[tuple[object, ...]]]:
        return {}

    def statements_of(self, sentence: str) -> frozenset[tuple[object, ...]]:
        """Return the graph of beliefs after telling one sentence only, or none if it is empty."""
        if sentence not in self._statements:
            with TaughtAgent([self.rule(sentence)] if sentence else []) as taught:
                self._statements[sentence] = belief_statements(taught.base)
        return self._statements[sentence]

    def taught_agent(self, codes: Sequence[int]) -> TaughtAgent:
        """Return an agent that was taught a learning scenario."""
        taught = zip(self.cells, map(levels_of, codes), strict=True)
        return TaughtAgent(self.rules[cell, level] for cell, levels in taught for level in levels)

    def cell_mask(self, cells: Iterable[RuleKey]) -> int:
        """Return the bit mask of a set of cells."""
        return sum(1 << self.index[cell] for cell in set(cells))


# --- Words -------------------------------------------------------------------------------------


def check_words(space: VerbalizedSpace) -> CheckResult:
    """Check the rules of all sentences, the goals of all commands, and perception of all scenes."""
    taught = [
        [space.sentence(*key), space.index[RuleKey.from_rule(rule)], *astuple(rule.interval)]
        for key, rule in space.rules.items()
    ]
    asked = [_command(space, text) for text, *_ in space.commands()]
    seen = [_seen(space, mask) for mask in range(2 ** len(space.objects))]
    wanted = [
        [space.sentence(cell, level), space.index[cell], CONFIDENCES[level], 1.0]
        for cell, level in space.rules
    ]
    commands = [list(each) for each in space.commands()]
    pairs = ((taught, wanted), (asked, commands), (seen, range(len(seen))))
    wrong = [line for found, right in pairs for line in differences(found, right)]
    return {"sentences": taught, "commands": asked, "scenes": seen}, wrong


def _command(space: VerbalizedSpace, text: str) -> list[str | int]:
    said = space.language.understand(text).meaning
    if not isinstance(said, meaning.Command):
        return [text, -1, -1]
    request = request_from_command(said, DEFAULT_SPEAKER)
    target = request.arguments["object"]
    wanted = target.used_for if isinstance(target, Target) else None
    affordances = space.affordances
    number = affordances.index(wanted) if wanted in affordances else -1
    return [text, list(ACTIONS).index(request.action), number]


def _seen(space: ScenarioSpace, mask: int) -> int:
    things = tuple(Placement(name, name) for name in space.scene(mask))
    vision = PerfectVision(Scene(things, seed=0), household().objects)
    found = vision.search([f"object:{name}" for name in space.objects])
    return space.mask([percept.object for percept in found if percept.confidence == 1.0])


def differences(found: Sequence[object], wanted: Sequence[object]) -> list[str]:
    """Return a line for each pair of items that differ."""
    pairs = zip(found, wanted, strict=True)
    return [f"{one}, not {other}" for one, other in pairs if one != other]


# --- Scores ------------------------------------------------------------------------------------


def check_scores(space: VerbalizedSpace, shift: int) -> CheckResult:
    """Check the score of each cell at one code, among cells of other codes.

    A row is lower, upper, lambda, accepted, then the cells of the proof, those that were read, and
    those whose rules were met. Each score must be the same, to the last bit, with all objects in
    the scene and if only its own cell was taught; its proof must evaluate to its interval.
    """
    cells, objects = space.cells, space.objects
    # The 16 shifts together give each cell each code once, always among other codes.
    codes = [(shift + i) % (space.full + 1) for i in range(len(cells))]
    with space.taught_agent(codes) as taught:
        found = [_score(space, taught, cell) for cell in cells]
        full = [candidate_of(cell, decide_about(taught, cell, objects)) for cell in cells]
    wrong: list[str] = []
    for cell, code, (candidate, row), other in zip(cells, codes, found, full, strict=True):
        with TaughtAgent(space.rules[cell, level] for level in levels_of(code)) as taught:
            alone, _ = _score(space, taught, cell)
        is_same = _bounds(candidate) == _bounds(other) == _bounds(alone)
        is_proven = not candidate or candidate.proof.evaluate(Operators()) == candidate.interval
        if not is_same or row[0] != belief(code) or not is_proven:
            wrong.append(f"{cell} at code {code} has {row}")
    return {"rows": [row for _, row in found]}, wrong


def _score(
    space: VerbalizedSpace, taught: TaughtAgent, cell: RuleKey
) -> tuple[Candidate | None, list[float]]:
    decided = decide_about(taught, cell, [cell.object])
    candidate = candidate_of(cell, decided)
    rules = candidate.rules if candidate else ()
    sets = (map(RuleKey.from_rule, rules), decided.read, decided.listed)
    return candidate, [*score_of(candidate), *map(space.cell_mask, sets)]


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
    found = [
        each
        for each in (inference.candidates if inference else ())
        if each.object == cell.object and each.argument and each.argument.name == cell.argument
    ]
    return found[0] if found and found[0].rules else None


def _bounds(candidate: Candidate | None) -> tuple[float, float]:
    interval = candidate.interval if candidate else VACUOUS
    return interval.lower, interval.upper


# --- Grasps ------------------------------------------------------------------------------------


def check_grasps(space: VerbalizedSpace, first: int) -> CheckResult:
    """Check the choice between the parts of each object, one at code `first`, the other at any.

    A row contains the bit mask of the acceptable parts for each object and context.
    """
    codes = range(space.full + 1)
    rows = [_grasp_row(space, first, second) for second in codes]
    wrong = [
        f"codes {first} and {second} give {mask}"
        for second, row in enumerate(rows)
        for mask in row
        if mask != highest_codes([first, second])
    ]
    return {"rows": rows}, wrong


def _grasp_row(space: VerbalizedSpace, first: int, second: int) -> list[int]:
    firsts = {(name, space.parts[name][0]) for name in space.objects}
    codes = [
        (first if (cell.object, cell.argument) in firsts else second) if cell.context else 0
        for cell in space.cells
    ]
    with space.taught_agent(codes) as taught:
        return [
            parts_mask(space, name, taught.decide(context, Target(object=name), [name]).part)
            for name in space.objects
            for context in CONTEXTS
        ]


def parts_mask(space: ScenarioSpace, name: str, found: Inference | None) -> int:
    """Return the bit mask of the acceptable parts of an object."""
    chosen = {each.argument.name for each in acceptable_candidates(found) if each.argument}
    return sum(1 << i for i, part in enumerate(space.parts[name]) if part in chosen)


def highest_codes(codes: Sequence[int]) -> int:
    """Return the bit mask of the highest non-zero codes; a higher code means a higher belief."""
    highest = max(codes, default=0)
    return sum(1 << i for i, code in enumerate(codes) if code == highest and highest)
