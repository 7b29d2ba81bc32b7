# SPDX-License-Identifier: Apache-2.0
"""All weak orders of the things on a table, and what the program chooses from each.

Each object of a scene is absent, or there without a rule for what is asked, or ranked. With k
ranked objects on m levels there are C(n, k)·2^(n-k)·m!·S(k, m) cases (S: Stirling numbers of the
second kind); a *block* holds those of one k and m. The program chooses by its own code from
candidates that it can tell apart by their scores only, and those can only be compared.
"""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import product

from ....inference.decision import DecisionRule
from ....inference.proof import Proof
from ....inference.types import Candidate
from ....kb.interval import VACUOUS, Interval
from ...execution.outcome import Json
from .taught_agent import acceptable
from .tracing import BlindOperators, Opaque

ABSENT, SILENT, RANKED = 0, 1, 2  # how an object can stand to what is asked
NODE = "pass/findObject"
NOT_TOLD = Proof("unknown", VACUOUS)


@dataclass(frozen=True)
class OrderShape:
    """The weak orders of one shape.

    Attributes:
        objects: how many objects there are.
        ranked: how many of them are ranked, k.
        levels: on how many levels, m in [0, k].
    """

    objects: int
    ranked: int
    levels: int

    def orders(self) -> Iterator[tuple[tuple[int, ...], tuple[int, ...]]]:
        """Each as (how each object stands, levels of the ranked ones), in lexicographic order."""
        rankings = surjections(self.ranked, self.levels)
        for standing in product((ABSENT, SILENT, RANKED), repeat=self.objects):
            if standing.count(RANKED) == self.ranked:
                yield from ((standing, ranking) for ranking in rankings)

    def chosen(self) -> tuple[Json, list[str]]:
        """What the program chooses, counted and digested, and what is not as the order says.

        What is digested is, for each case, the number of the acceptable objects as one byte, bit i
        for object i.
        """
        chooser = _Chooser(self.objects, self.levels)
        masks = bytearray(chooser.choose(*order) for order in self.orders())
        wrong = [
            f"{standing} ranked {ranking} gives {mask}"
            for mask, (standing, ranking) in zip(masks, self.orders(), strict=True)
            if mask != self._highest(standing, ranking)
        ]
        counts = [0, 0, 0]
        for mask in masks:
            counts[min(mask.bit_count(), 2)] += 1
        return {
            "ranked": self.ranked,
            "levels": self.levels,
            "none": counts[0],
            "unique": counts[1],
            "ties": counts[2],
            "digest": hashlib.sha256(masks).hexdigest(),
        }, wrong

    def _highest(self, standing: Sequence[int], ranking: Sequence[int]) -> int:
        """The objects on the highest level, by the order alone; no level stays empty."""
        ranked = (1 << i for i, how in enumerate(standing) if how == RANKED)
        pairs = zip(ranked, ranking, strict=True)
        return sum(bit for bit, level in pairs if level == self.levels - 1)


def blocks(objects: int) -> list[OrderShape]:
    """The blocks that together are all weak orders of so many objects."""
    shapes = ((k, m) for k in range(objects + 1) for m in range(min(k, 1), k + 1))
    return [OrderShape(objects, k, m) for k, m in shapes]


@cache
def surjections(places: int, levels: int) -> tuple[tuple[int, ...], ...]:
    """All ways to put so many places on levels, none of which stays empty; lexicographic."""
    return tuple(_surjections(places, levels, frozenset()))


def _surjections(places: int, levels: int, used: frozenset[int]) -> Iterator[tuple[int, ...]]:
    if levels - len(used) > places:
        return
    if not places:
        yield ()
        return
    for level in range(levels):
        for rest in _surjections(places - 1, levels, used | {level}):
            yield (level, *rest)


class _Chooser:
    """The program's choice at a find node, among candidates that look alike but for their score.

    Args:
        objects: how many objects there are.
        levels: how many different scores there are.
    """

    def __init__(self, objects: int, levels: int) -> None:
        # Which intervals stand for the scores does not matter: nothing reads them. What nothing
        # was told about gets the highest score of all, and must not be chosen even so.
        ranked = [Proof("seen", Interval(i / 1000, 1.0)) for i in range(1, levels + 1)]
        proofs = [*ranked, NOT_TOLD]
        scores = {proof.interval: Opaque(level) for level, proof in enumerate(proofs)}
        self._judge = DecisionRule(NODE, 0.0, BlindOperators(scores=scores))
        self._candidates = [[_candidate(proof) for proof in proofs] for _ in range(objects)]
        self._bits = {id(each): 1 << i for i, row in enumerate(self._candidates) for each in row}

    def choose(self, standing: Sequence[int], ranking: Sequence[int]) -> int:
        """The acceptable objects, bit i for object i."""
        levels = iter(ranking)
        candidates = [
            row[next(levels) if how == RANKED else -1]
            for row, how in zip(self._candidates, standing, strict=True)
            if how != ABSENT
        ]
        return sum(self._bits[id(each)] for each in acceptable(self._judge.ranked(candidates)))


def _candidate(proof: Proof) -> Candidate:
    verdict = "unknown" if proof is NOT_TOLD else "accepted"
    return Candidate("", "", None, proof, 0.0, verdict, "")
