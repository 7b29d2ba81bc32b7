"""Enumeration of all weak orders of the objects in a scene, with the choice made from each.

Each object of a scene is absent, present without an applicable rule, or ranked. With k ranked
objects on m levels there are C(n, k)·2^(n-k)·m!·S(k, m) cases (S: Stirling numbers of the second
kind); a *block* contains those of one k and m. The choice is made by the code under test, from
candidates that differ only in their scores. An `OpaqueScore` supports what a choice by comparison
needs (order, reversal, subtraction of the tolerance for ties); other uses raise `TypeError`.
"""

import hashlib
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cache
from itertools import permutations, product
from typing import cast

from ....inference.affordance import DecisionRule
from ....inference.interval_operators import EPSILON, Operators
from ....inference.proof import Proof
from ....inference.types import Candidate
from ....kb.interval import VACUOUS, Interval
from ...execution.outcome import Json
from .scenario_space import CheckResult, ScenarioSpace
from .taught_agent import acceptable_candidates

ABSENT, UNKNOWN, RANKED = 0, 1, 2  # status of an object: not in the scene, no rule, ranked
OUTCOMES = ("none", "unique", "ties")
NODE = "pass/findObject"
NO_RULE = Proof("unknown", VACUOUS)


class OpaqueScore:
    """A score that can only be compared with others; a higher level is better."""

    def __init__(self, level: float) -> None:
        self._level = level

    def __neg__(self) -> "OpaqueScore":
        return OpaqueScore(-self._level)

    def __sub__(self, other: object) -> "OpaqueScore":
        if other != EPSILON:
            raise TypeError("Only the tolerance of ties may be subtracted from a score.")
        return OpaqueScore(self._level - 0.25)  # a little less, which is no other level

    def __lt__(self, other: "OpaqueScore") -> bool:
        return self._level < other._level

    def __eq__(self, other: object) -> bool:
        return isinstance(other, OpaqueScore) and self._level == other._level

    def __hash__(self) -> int:
        raise TypeError("A score may only be compared.")


@dataclass(frozen=True)
class OpaqueOperators(Operators):
    """The operators, with opaque scores as ranks of intervals."""

    scores: Mapping[Interval, OpaqueScore] = field(default_factory=dict[Interval, OpaqueScore])

    def rank(self, interval: Interval) -> float:
        """Return the opaque score of an interval; it is a number to the type checker only."""
        return cast("float", self.scores[interval])


@dataclass(frozen=True)
class WeakOrderClass:
    """The weak orders of some objects, of which k are `ranked` on m `levels`, m in [0, k]."""

    objects: int
    ranked: int
    levels: int

    def orders(self) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
        """Yield (status of each object, levels of the ranked ones), in lexicographic order."""
        rankings = surjections(self.ranked, self.levels)
        for standing in product((ABSENT, UNKNOWN, RANKED), repeat=self.objects):
            if standing.count(RANKED) == self.ranked:
                yield from ((standing, ranking) for ranking in rankings)

    def choices(self) -> Iterator[int]:
        """Yield the acceptable objects in each of the orders, bit i for object i."""
        # The intervals only identify scores: nothing reads them. Candidates without a rule get
        # the highest score, and still must not be chosen.
        ranked = [Proof("seen", Interval(i / 1000, 1.0)) for i in range(1, self.levels + 1)]
        proofs = [*ranked, NO_RULE]
        scores = {proof.interval: OpaqueScore(level) for level, proof in enumerate(proofs)}
        decision = DecisionRule(NODE, 0.0, OpaqueOperators(scores=scores))
        rows = [[_candidate(proof) for proof in proofs] for _ in range(self.objects)]
        bits = {id(each): 1 << i for i, row in enumerate(rows) for each in row}
        for standing, ranking in self.orders():
            levels = iter(ranking)
            present = (pair for pair in zip(rows, standing, strict=True) if pair[1] != ABSENT)
            candidates = [row[next(levels) if how == RANKED else -1] for row, how in present]
            yield sum(bits[id(each)] for each in acceptable_candidates(decision.ranked(candidates)))


def check_choices(space: ScenarioSpace, ranked: int, levels: int) -> CheckResult:
    """Check the choice from each weak order of a block.

    The digest is over one byte for each case: the acceptable objects, bit i for object i.
    """
    block = WeakOrderClass(len(space.objects), ranked, levels)
    masks = bytearray(block.choices())
    wrong: list[str] = []
    for mask, (standing, ranking) in zip(masks, block.orders(), strict=True):
        bits = (1 << i for i, how in enumerate(standing) if how == RANKED)
        pairs = zip(bits, ranking, strict=True)
        if mask != sum(bit for bit, level in pairs if level == levels - 1):
            wrong.append(f"{standing} ranked {ranking} gives {mask}")
    shape = {"ranked": ranked, "levels": levels, "digest": hashlib.sha256(masks).hexdigest()}
    return shape | tally(masks), wrong


def tally(masks: Iterable[int]) -> Json:
    """Return how many sets of choices, given as bit masks, are empty, of one, and of several."""
    kinds = Counter(min(mask.bit_count(), 2) for mask in masks)
    return {outcome: kinds[size] for size, outcome in enumerate(OUTCOMES)}


def weak_order_blocks(objects: int) -> list[WeakOrderClass]:
    """Return the blocks of all weak orders of a number of objects."""
    shapes = ((k, m) for k in range(objects + 1) for m in range(min(k, 1), k + 1))
    return [WeakOrderClass(objects, k, m) for k, m in shapes]


@cache
def surjections(places: int, levels: int) -> tuple[tuple[int, ...], ...]:
    """Return all surjections from places to levels, in lexicographic order."""
    if places == levels:
        return tuple(permutations(range(levels)))
    maps = product(range(levels), repeat=places) if places > levels else ()
    return tuple(each for each in maps if len({*each}) == levels)


def _candidate(proof: Proof) -> Candidate:
    return Candidate("", "", None, proof, 0.0, "unknown" if proof is NO_RULE else "accepted", "")
