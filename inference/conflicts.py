"""Conflicts: pairs of rules, one of which asserts what the other denies.

The weight of a conflict is the mass K of `Interval.conflict`. Two different parts for one grasp do
not contradict each other: a knife can be held at either end.
"""

from collections import defaultdict
from collections.abc import Iterable
from dataclasses import dataclass
from itertools import combinations

from ..kb.interval import EPSILON
from ..kb.rule import Atom, Rule
from .proof import Json


@dataclass(frozen=True)
class Conflict:
    """Two rules of one antecedent and conclusion, the earlier one first, and their K in [0, 1]."""

    first: Rule
    second: Rule
    weight: float

    def as_json(self) -> Json:
        """Return the JSON object that `hilt conflicts --json` prints."""
        return {"rules": [self.first.as_json(), self.second.as_json()], "weight": self.weight}


def find_conflicts(rules: Iterable[Rule]) -> list[Conflict]:
    """Return the pairs of rules that contradict each other, weighted by trust, heaviest first."""
    groups: dict[tuple[frozenset[Atom], str, Atom | None], list[Rule]] = defaultdict(list)
    for rule in rules:
        groups[rule.features | rule.contexts, rule.functor, rule.argument].append(rule)
    pairs = (pair for group in groups.values() for pair in combinations(group, 2))
    found = [Conflict(a, b, a.support.conflict(b.support)) for a, b in pairs]
    heavy = [each for each in found if each.weight > EPSILON]
    return sorted(heavy, key=lambda each: (-each.weight, each.first.id, each.second.id))
