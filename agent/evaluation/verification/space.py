# SPDX-License-Identifier: Apache-2.0
"""The space of all learning scenarios: every set of rules that can be taught (section 4.1).

A *cell* is what a rule is about: an object and an affordance, or an object, one of its parts and
the action it is grasped for. Each cell can be taught at each level of confidence, or at several,
or not at all: its *code* says at which, one bit a level, the highest level the highest bit. A
learning scenario is a code for each cell. With the paper's 8 objects, 5 affordances, 2 contexts and
4 levels there are 72 cells, 288 rules and 16^72 = 2^288 learning scenarios.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from random import Random

from ....kb.rule import Rule
from ....ontology.objects import load_household
from ..scenarios import (
    ACTIONS,
    LEVELS,
    command,
    functional_sentence,
    grasp_sentence,
    load_scenarios,
)

CONTEXTS = ("pass", "pickUp")  # the actions that grasp
# Table 2: level -> confidence
NUMBERS: Mapping[str, float] = dict(zip(LEVELS, (0.95, 0.75, 0.5, 0.25), strict=True))

Codes = tuple[int, ...]  # a learning scenario: a code in [0, 16) for each cell


@dataclass(frozen=True, order=True)
class Cell:
    """What a rule is about, without how sure it is.

    Attributes:
        object: the object.
        argument: the affordance, or the part.
        context: the action it is grasped for; empty for an affordance.
    """

    object: str
    argument: str
    context: str = ""

    @classmethod
    def of(cls, rule: Rule) -> Cell:
        """The cell that a rule is about."""
        name = rule.argument.name if rule.argument else ""
        return cls(rule.object or "*", name, rule.context or "")


@dataclass(frozen=True)
class Space:
    """Objects, affordances, contexts and levels, and all that can be taught about them.

    Attributes:
        objects: in the order of every scene.
        affordances: what they may be used for.
        parts: object -> its two parts.
    """

    objects: tuple[str, ...]
    affordances: tuple[str, ...]
    parts: Mapping[str, tuple[str, ...]]

    @classmethod
    def of_paper(cls, objects: int = 8, affordances: int = 5) -> Space:
        """The paper's space, or that of its first few objects and affordances."""
        scenario, _ = load_scenarios()
        names = tuple(scenario.grasps)[:objects]
        types = load_household().objects
        parts = {name: tuple(types[name].parts) for name in names}
        return cls(names, tuple(scenario.affordances)[:affordances], parts)

    @cached_property
    def cells(self) -> tuple[Cell, ...]:
        """All cells: those of affordances object by object, then those of grasps."""
        functional = [Cell(name, each) for name in self.objects for each in self.affordances]
        grasps = [
            Cell(name, part, context)
            for name in self.objects
            for context in CONTEXTS
            for part in self.parts[name]
        ]
        return (*functional, *grasps)

    @cached_property
    def index(self) -> Mapping[Cell, int]:
        """Cell -> its place among all."""
        return {cell: number for number, cell in enumerate(self.cells)}

    @property
    def full(self) -> int:
        """The code of a cell that is taught at every level."""
        return 2 ** len(LEVELS) - 1

    def sentence(self, cell: Cell, level: str) -> str:
        """The sentence that teaches a cell at a level."""
        if cell.context:
            return grasp_sentence(cell.object, cell.context, cell.argument, level)
        return functional_sentence(cell.object, cell.argument, level)

    def sentences(self, codes: Sequence[int]) -> list[str]:
        """All sentences that teach a learning scenario, cell by cell, the highest level first."""
        return [
            self.sentence(cell, level)
            for cell, code in zip(self.cells, codes, strict=True)
            for level in levels_of(code)
        ]

    def commands(self) -> list[tuple[str, int, int]]:
        """All commands: the sentence, the number of its action and that of its affordance."""
        return [
            (command(action, affordance), number, wanted)
            for number, action in enumerate(ACTIONS)
            for wanted, affordance in enumerate(self.affordances)
        ]

    def scene(self, mask: int) -> tuple[str, ...]:
        """The objects of a scene, given as one bit an object, the first the lowest."""
        return tuple(name for i, name in enumerate(self.objects) if mask >> i & 1)

    def mask(self, names: Sequence[str]) -> int:
        """The scene of these objects, as `scene` takes it."""
        return sum(1 << self.objects.index(name) for name in names)

    def shifted(self, shift: int) -> Codes:
        """The learning scenario whose i-th cell has code shift + i, modulo the number of codes.

        The 16 shifts together give each cell each code once, always among other codes.
        """
        return tuple((shift + i) % (self.full + 1) for i in range(len(self.cells)))

    def drawn(self, seed: int) -> Codes:
        """A learning scenario at random."""
        rng = Random(seed)  # noqa: S311 - scenarios, not secrets
        return tuple(rng.randrange(self.full + 1) for _ in self.cells)


def levels_of(code: int) -> list[str]:
    """The levels of a code, the highest first."""
    bits = reversed(range(len(LEVELS)))
    return [level for level, bit in zip(LEVELS, bits, strict=True) if code >> bit & 1]


def code_of(levels: Sequence[str]) -> int:
    """The code of some levels."""
    return sum(1 << (len(LEVELS) - 1 - LEVELS.index(level)) for level in set(levels))


def belief(code: int) -> float:
    """How surely a cell of a code holds: one minus the product of what each level leaves open.

    By Table 2's numbers, in whole steps of 1/10,000,000 so that equals are equal: each level leaves
    open 1/20, 1/4, 1/2 or 3/4.
    """
    steps = 10**7
    for level in levels_of(code):
        steps = steps * round((1 - NUMBERS[level]) * 100) // 100
    return (10**7 - steps) / 10**7
