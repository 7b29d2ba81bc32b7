"""The space of all learning scenarios: every set of rules that can be taught (section 4.1).

A *cell* is the topic of a rule: an object and an affordance, or an object, one of its parts and the
action it is grasped for. Each cell can be taught at each level of confidence, at several, or not at
all: its *code* has one bit for each level, the highest bit for the highest level. A learning
scenario is a code for each cell. With the paper's 8 objects, 5 affordances, 2 contexts and
4 levels there are 72 cells, 288 rules and 16^72 = 2^288 learning scenarios.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from random import Random

from ....kb.rule import DEFAULT_SPEAKER, Rule
from ....nlu.language import Language
from ....nlu.semantics import meaning
from ...config import household
from ...dialogue.translation import rule_from_meaning
from ...execution.outcome import Json
from ..learning_scenarios import ACTIONS, CONTEXTS, LEVELS, command, load_scenarios, rule_sentence
from .taught_agent import RuleKey, TaughtAgent

# Table 2: level -> confidence
CONFIDENCES: Mapping[str, float] = dict(zip(LEVELS, (0.95, 0.75, 0.5, 0.25), strict=True))
CODES = range(2 ** len(LEVELS))
BITS: Mapping[str, int] = {level: 8 >> i for i, level in enumerate(LEVELS)}

CheckResult = tuple[Json, list[str]]  # facts, and a line for each deviation
Codes = tuple[int, ...]  # a learning scenario: a code for each cell


@dataclass(frozen=True)
class ScenarioSpace:
    """The space of learning scenarios, with the language that teaches them.

    The objects have the order that they have in every scene; each has two parts.
    """

    objects: tuple[str, ...]
    affordances: tuple[str, ...]
    parts: Mapping[str, tuple[str, ...]]

    @classmethod
    def from_paper(cls, objects: int = 8, affordances: int = 5) -> "ScenarioSpace":
        """Return the space of the paper, or of its first few objects and affordances."""
        scenario, _ = load_scenarios()
        names = tuple(scenario.grasps)[:objects]
        parts = {name: tuple(household().objects[name].parts) for name in names}
        return cls(names, tuple(scenario.affordances)[:affordances], parts)

    @cached_property
    def cells(self) -> tuple[RuleKey, ...]:
        """All cells: those of affordances by object, then those of grasps."""
        held = ((name, context) for name in self.objects for context in CONTEXTS)
        return (
            *(RuleKey(name, each) for name in self.objects for each in self.affordances),
            *(RuleKey(name, part, context) for name, context in held for part in self.parts[name]),
        )

    @cached_property
    def index(self) -> Mapping[RuleKey, int]:
        """Cell -> its index in `cells`."""
        return {cell: number for number, cell in enumerate(self.cells)}

    @cached_property
    def language(self) -> Language:
        """The language; it takes a quarter of a second to load."""
        return Language.load()

    @cached_property
    def rules(self) -> dict[tuple[RuleKey, str], Rule]:
        """Cell and level -> the rule that its sentence teaches."""
        cells = ((cell, level) for cell in self.cells for level in LEVELS)
        return {(cell, level): self._rule(rule_sentence(*cell, level)) for cell, level in cells}

    def _rule(self, text: str) -> Rule:
        if not isinstance(said := self.language.understand(text).meaning, meaning.Statement):
            raise TypeError(f'"{text}" is not understood as a statement: {said}.')
        (rule,) = said.rules
        return rule_from_meaning(rule, DEFAULT_SPEAKER)

    def taught(self, codes: Sequence[int]) -> list[tuple[RuleKey, str]]:
        """Return cell and level of each rule of a learning scenario, the highest level first."""
        taught = zip(self.cells, map(levels_of, codes), strict=True)
        return [(cell, level) for cell, levels in taught for level in levels]

    def taught_agent(self, codes: Sequence[int]) -> TaughtAgent:
        """Return an agent that was taught a learning scenario."""
        return TaughtAgent(self.rules[key] for key in self.taught(codes))

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

    def mask(self, names: Iterable[str]) -> int:
        """Return the bit mask of a set of objects."""
        return bit_mask(map(self.objects.index, names))

    def cell_mask(self, cells: Iterable[RuleKey]) -> int:
        """Return the bit mask of a set of cells."""
        return bit_mask(self.index[cell] for cell in cells)

    def drawn(self, rng: Random, share: float) -> Codes:
        """Return a random learning scenario, to which each rule belongs with the chance `share`."""
        levels = range(len(LEVELS))
        return tuple(bit_mask(i for i in levels if rng.random() < share) for _ in self.cells)

    def node(self, cell: RuleKey) -> list[int]:
        """Return the indices of the cells whose rules are at the same node as those of a cell."""
        same = (each for each in self.cells if each.context == cell.context)
        every = (each for each in same if cell.context or each.argument == cell.argument)
        return [self.index[each] for each in every]


def bit_mask(indices: Iterable[int]) -> int:
    """Return the bit mask of a set of indices."""
    return sum(1 << i for i in {*indices})


def levels_of(code: int) -> list[str]:
    """Return the levels of a code, the highest first."""
    return [level for level, bit in BITS.items() if code & bit]


def belief(code: int) -> float:
    """Return the belief of a cell with a code: one minus the product of 1 - c over its levels.

    The confidences c are those of Table 2. The product is computed in whole steps of 1/10,000,000,
    so that equal values are equal.
    """
    steps = 10**7
    for level in levels_of(code):
        steps = steps * round((1 - CONFIDENCES[level]) * 100) // 100
    return (10**7 - steps) / 10**7
