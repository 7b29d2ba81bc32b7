# SPDX-License-Identifier: Apache-2.0
"""The finite cases of the verification, each by the program's own code.

Every function returns what the program did, as plain JSON, and a line for each thing that is not
as the definition says. Cells, objects, parts, actions and levels are given by their numbers; sets
of objects and of cells as one bit each.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from functools import cached_property

from ....inference.evidence import Operators
from ....inference.types import Candidate, Target
from ....kb.rule import DEFAULT_SPEAKER, Rule
from ....nlu.language import Language
from ....nlu.semantics import meaning
from ....ontology.objects import load_household
from ....sim.scene.scene import Placement, Scene
from ...dialogue.translation import request_of, rule_of
from ...execution.outcome import Json
from ...execution.perception import PerfectVision
from ..scenarios import ACTIONS, LEVELS
from .space import CONTEXTS, NUMBERS, Cell, Space, belief, levels_of
from .taught_agent import Decided, Statement, Taught, acceptable, believed

Found = tuple[Json, list[str]]
NOT_CONCLUDED: list[float] = [0.0, 1.0, 0.0, 0]  # lower, upper, lambda, accepted: nothing was told
DIGITS = 9  # to which scores are written down; exact for the levels of the paper
LOOKING = "pointTo"  # the action that only finds


class TaughtSpace:
    """A space with the language that teaches it.

    Args:
        space: the space.
    """

    def __init__(self, space: Space) -> None:
        self.space = space
        self._left: dict[str, frozenset[Statement]] = {}

    @cached_property
    def language(self) -> Language:
        """The language, which takes a quarter of a second to load."""
        return Language.load()

    @cached_property
    def rules(self) -> dict[tuple[Cell, str], Rule]:
        """Cell and level -> the rule that the sentence for it teaches."""
        cells = ((cell, level) for cell in self.space.cells for level in LEVELS)
        return {key: self.rule(self.space.sentence(*key)) for key in cells}

    def rule(self, sentence: str) -> Rule:
        """The one rule that a sentence teaches."""
        said = self.language.understand(sentence).meaning
        if not isinstance(said, meaning.Statement):
            raise TypeError(f'"{sentence}" is understood as no statement: {said}.')
        (rule,) = said.rules
        return rule_of(rule, DEFAULT_SPEAKER)

    def left_by(self, sentence: str) -> frozenset[Statement]:
        """What a sentence leaves in the graph of beliefs when nothing else is told."""
        if sentence not in self._left:
            with Taught([self.rule(sentence)]) as taught:
                self._left[sentence] = believed(taught.base)
        return self._left[sentence]

    def taught(self, codes: Sequence[int]) -> Taught:
        """A mind that was taught a learning scenario."""
        cells = zip(self.space.cells, codes, strict=True)
        return Taught(self.rules[cell, level] for cell, code in cells for level in levels_of(code))

    def taught_only(self, cell: Cell, code: int) -> Taught:
        """A mind that was taught nothing but one cell."""
        return Taught(self.rules[cell, level] for level in levels_of(code))

    def bits(self, cells: Iterable[Cell]) -> int:
        """A set of cells, one bit each."""
        return sum(1 << self.space.index[cell] for cell in set(cells))


# --- Words -------------------------------------------------------------------------------------


def words(lexis: TaughtSpace) -> Found:
    """All sentences as rules, all commands as goals, all scenes as they are seen."""
    space = lexis.space
    taught = [
        [space.sentence(*key), space.index[Cell.of(rule)], rule.interval.lower, rule.interval.upper]
        for key, rule in lexis.rules.items()
    ]
    asked = [_command(lexis, text) for text, *_ in space.commands()]
    seen = [_seen(space, mask) for mask in range(2 ** len(space.objects))]
    wanted = [
        [space.sentence(cell, level), space.index[cell], NUMBERS[level], 1.0]
        for cell, level in lexis.rules
    ]
    wrong = _unequal(taught, wanted) + _unequal(asked, [list(each) for each in space.commands()])
    wrong += _unequal(seen, range(len(seen)))
    return {"sentences": taught, "commands": asked, "scenes": seen}, wrong


def _command(lexis: TaughtSpace, text: str) -> list[str | int]:
    said = lexis.language.understand(text).meaning
    if not isinstance(said, meaning.Command):
        return [text, -1, -1]
    request = request_of(said, DEFAULT_SPEAKER)
    target = request.arguments["object"]
    wanted = target.used_for if isinstance(target, Target) else None
    affordances = lexis.space.affordances
    number = affordances.index(wanted) if wanted in affordances else -1
    return [text, list(ACTIONS).index(request.action), number]


def _seen(space: Space, mask: int) -> int:
    things = tuple(Placement(name, name) for name in space.scene(mask))
    vision = PerfectVision(Scene(things, seed=0), load_household().objects)
    found = vision.search([f"object:{name}" for name in space.objects])
    return space.mask([percept.object for percept in found if percept.confidence == 1.0])


def _unequal(found: Sequence[object], wanted: Sequence[object]) -> list[str]:
    pairs = zip(found, wanted, strict=True)
    return [f"{one}, not {other}" for one, other in pairs if one != other]


# --- Scores ------------------------------------------------------------------------------------


def scores(lexis: TaughtSpace, shift: int) -> Found:
    """The score of each cell at one code, among cells of other codes.

    A row is lower, upper, lambda, accepted, the cells that the proof rests on, and the cells of
    which anything was read on the way. Each score must be the same, to the last bit, when all
    objects are there and when nothing but its own cell was taught, and its proof, worked out again,
    must come to it.
    """
    codes = lexis.space.shifted(shift)
    with lexis.taught(codes) as taught:
        found = [_score(lexis, taught, cell) for cell in lexis.space.cells]
        crowded = [_crowded(lexis, taught, cell) for cell in lexis.space.cells]
    wrong: list[str] = []
    for cell, code, (candidate, row), other in zip(
        lexis.space.cells, codes, found, crowded, strict=True
    ):
        with lexis.taught_only(cell, code) as taught:
            alone, _ = _score(lexis, taught, cell)
        is_same = _interval(candidate) == _interval(other) == _interval(alone)
        if not is_same or row[0] != belief(code) or not _proved(candidate):
            wrong.append(f"{cell} at code {code} has {row}")
    return {"rows": [row for _, row in found]}, wrong


def _score(lexis: TaughtSpace, taught: Taught, cell: Cell) -> tuple[Candidate | None, list[float]]:
    """What is concluded about a cell when its object is alone on the table, and the row for it."""
    decided = _decided(taught, cell, [cell.object])
    candidate = _about(cell, decided)
    read = lexis.bits(decided.read)
    if candidate is None:
        return None, [*NOT_CONCLUDED, 0, read]
    rests = lexis.bits(Cell.of(rule) for rule in candidate.rules)
    interval = candidate.interval
    numbers = (interval.lower, interval.upper, candidate.certainty)
    return candidate, [*(round(n, DIGITS) for n in numbers), int(candidate.accepted), rests, read]


def _crowded(lexis: TaughtSpace, taught: Taught, cell: Cell) -> Candidate | None:
    return _about(cell, _decided(taught, cell, lexis.space.objects))


def _decided(taught: Taught, cell: Cell, scene: Sequence[str]) -> Decided:
    if cell.context:
        return taught.decide(cell.context, Target(object=cell.object), scene)
    return taught.decide(LOOKING, Target(used_for=cell.argument), scene)


def _about(cell: Cell, decided: Decided) -> Candidate | None:
    """The candidate of a cell, among all those of a decision."""
    inference = decided.part if cell.context else decided.object
    found = [
        each
        for each in (inference.candidates if inference else ())
        if each.object == cell.object and each.argument and each.argument.name == cell.argument
    ]
    return found[0] if found and found[0].rules else None


def _interval(candidate: Candidate | None) -> tuple[float, float]:
    interval = candidate.interval if candidate else None
    return (interval.lower, interval.upper) if interval else (0.0, 1.0)


def _proved(candidate: Candidate | None) -> bool:
    """Whether a proof, worked out again from its leaves, comes to its conclusion."""
    if candidate is None:
        return True
    again = candidate.proof.evaluate(Operators())
    return (again.lower, again.upper) == _interval(candidate)


# --- Grasps ------------------------------------------------------------------------------------


def grasps(lexis: TaughtSpace, first: int) -> Found:
    """The choice between the two parts of each object, one at code `first`, the other at any.

    A row holds, for each object and context, the acceptable parts as one bit each.
    """
    rows = [_grasp_row(lexis, first, second) for second in range(lexis.space.full + 1)]
    wrong = [
        f"codes {first} and {second} give {mask}"
        for second, row in enumerate(rows)
        for mask in row
        if mask != best([first, second])
    ]
    return {"rows": rows}, wrong


def _grasp_row(lexis: TaughtSpace, first: int, second: int) -> list[int]:
    space = lexis.space
    firsts = {(name, space.parts[name][0]) for name in space.objects}
    codes = [
        (first if (cell.object, cell.argument) in firsts else second) if cell.context else 0
        for cell in space.cells
    ]
    with lexis.taught(codes) as taught:
        return list(_grasped(space, taught))


def _grasped(space: Space, taught: Taught) -> Iterator[int]:
    for name in space.objects:
        for context in CONTEXTS:
            decided = taught.decide(context, Target(object=name), [name])
            yield parts_mask(space, name, decided)


def parts_mask(space: Space, name: str, decided: Decided) -> int:
    """The acceptable parts of an object, one bit each."""
    chosen = {each.argument.name for each in acceptable(decided.part) if each.argument}
    return sum(1 << i for i, part in enumerate(space.parts[name]) if part in chosen)


def best(codes: Sequence[int]) -> int:
    """Which of some codes are the highest that were taught anything, one bit each.

    The levels are such that a higher code is the surer one.
    """
    highest = max(codes, default=0)
    return sum(1 << i for i, code in enumerate(codes) if code == highest and highest)
