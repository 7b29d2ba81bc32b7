"""The space of all learning scenarios: every set of rules that can be taught (section 4.1).

A *cell* is the topic of a rule: an object and an affordance, or an object, one of its parts and the
action it is grasped for. Each cell can be taught at each level of confidence, at several, or not at
all: its *code* has one bit for each level, the highest bit for the highest level. A learning
scenario is a code for each cell. With the paper's 8 objects, 5 affordances, 2 contexts and
4 levels there are 72 cells, 288 rules and 16^72 = 2^288 learning scenarios.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from random import Random
from typing import TYPE_CHECKING

from ....kb.rule import Rule
from ...config import household
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS, command, load_scenarios, rule_sentence

if TYPE_CHECKING:
    from typing_extensions import Self

# Table 2: level -> confidence
CONFIDENCES: Mapping[str, float] = dict(zip(LEVELS, (0.95, 0.75, 0.5, 0.25), strict=True))

Codes = tuple[int, ...]  # a learning scenario: a code in [0, 16) for each cell


@dataclass(frozen=True, order=True)
class RuleKey:
    """The topic of a rule: an affordance, with an empty context, or a part to grasp in one."""

    object: str
    argument: str
    context: str = ""

    @classmethod
    def from_rule(cls, rule: Rule) -> RuleKey:
        """Return the cell of a rule."""
        name = rule.argument.name if rule.argument else ""
        return cls(rule.object or "*", name, rule.context or "")


@dataclass(frozen=True)
class ScenarioSpace:
    """The space of learning scenarios, spanned by objects, affordances and parts.

    The objects have the order that they have in every scene; each has two parts.
    """

    objects: tuple[str, ...]
    affordances: tuple[str, ...]
    parts: Mapping[str, tuple[str, ...]]

    @classmethod
    def from_paper(cls, objects: int = 8, affordances: int = 5) -> Self:
        """Return the space of the paper, or of its first few objects and affordances."""
        scenario, _ = load_scenarios()
        names = tuple(scenario.grasps)[:objects]
        types = household().objects
        parts = {name: tuple(types[name].parts) for name in names}
        return cls(names, tuple(scenario.affordances)[:affordances], parts)

    @cached_property
    def cells(self) -> tuple[RuleKey, ...]:
        """All cells: those of affordances by object, then those of grasps."""
        functional = (RuleKey(name, each) for name in self.objects for each in self.affordances)
        held = ((name, context) for name in self.objects for context in CONTEXTS)
        grasps = (
            RuleKey(name, part, context) for name, context in held for part in self.parts[name]
        )
        return (*functional, *grasps)

    @cached_property
    def index(self) -> Mapping[RuleKey, int]:
        """Cell -> its index in `cells`."""
        return {cell: number for number, cell in enumerate(self.cells)}

    @property
    def full(self) -> int:
        """The code of a cell that is taught at every level."""
        return 2 ** len(LEVELS) - 1

    def sentence(self, cell: RuleKey, level: str) -> str:
        """Return the sentence that teaches a cell at a level."""
        return rule_sentence(cell.object, cell.argument, cell.context, level)

    def sentences(self, codes: Sequence[int]) -> list[str]:
        """Return the sentences that teach a learning scenario, by cell, the highest level first."""
        taught = zip(self.cells, map(levels_of, codes), strict=True)
        return [self.sentence(cell, level) for cell, levels in taught for level in levels]

    def commands(self) -> list[tuple[str, int, int]]:
        """Return all commands: sentence, index of the action, index of the affordance."""
        return [
            (command(action, affordance), number, wanted)
            for number, action in enumerate(ACTIONS)
            for wanted, affordance in enumerate(self.affordances)
        ]

    def scene(self, mask: int) -> tuple[str, ...]:
        """Return the objects of a scene given as a bit mask, the first object the lowest bit."""
        return tuple(name for i, name in enumerate(self.objects) if mask >> i & 1)

    def mask(self, names: Sequence[str]) -> int:
        """Return the bit mask of a set of objects."""
        return sum(1 << self.objects.index(name) for name in names)

    def drawn(self, rng: Random, share: float) -> Codes:
        """Return a random learning scenario, to which each rule belongs with the chance `share`."""
        bits = [1 << i for i in range(len(LEVELS))]
        return tuple(sum(bit for bit in bits if rng.random() < share) for _ in self.cells)

    def node(self, cell: RuleKey) -> list[int]:
        """Return the indices of the cells whose rules are at the same node as those of a cell."""
        same = (each for each in self.cells if each.context == cell.context)
        every = (each for each in same if cell.context or each.argument == cell.argument)
        return [self.index[each] for each in every]


def levels_of(code: int) -> list[str]:
    """Return the levels of a code, the highest first."""
    bits = reversed(range(len(LEVELS)))
    return [level for level, bit in zip(LEVELS, bits, strict=True) if code >> bit & 1]


def code_of(levels: Sequence[str]) -> int:
    """Return the code of a set of levels."""
    return sum(1 << (len(LEVELS) - 1 - LEVELS.index(level)) for level in set(levels))


def belief(code: int) -> float:
    """Return the belief of a cell with a code: one minus the product of 1 - c over its levels.

    The confidences c are those of Table 2. The product is computed in whole steps of 1/10,000,000,
    so that equal values are equal.
    """
    steps = 10**7
    for level in levels_of(code):
        steps = steps * round((1 - CONFIDENCES[level]) * 100) // 100
    return (10**7 - steps) / 10**7
