# SPDX-License-Identifier: Apache-2.0
"""What a decision reads, and scores that can only be compared.

`Traced` stands between a base and the inference: it hands out rules that note when anything is
read of them that another level of confidence, or another telling, would change. What identifies a
rule's cell (its features, contexts, functor and argument) may be read freely: that is how the
program finds out what to look for. A run is a deterministic program: one that noted the cells R
decides alike in all learning scenarios that agree on R and teach something about the same cells.

`BlindOperators` rank by an `Opaque` score. It supports what a choice by comparison needs (order,
reversal, and "a little less", for ties) and nothing else: any other use is a `TypeError`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from typing import cast

from ....inference.affordance import RuleSource
from ....inference.evidence import EPSILON, Operators
from ....kb.interval import Interval
from ....kb.rule import Rule
from .space import Cell

SAYING = frozenset({"interval", "speaker", "utterance", "time", "status", "trust", "id", "support"})


class TracingRule(Rule):
    """A rule that notes when what it says is read."""

    def __getattribute__(self, name: str) -> object:
        """As of any object; what depends on the telling is noted first."""
        if name in SAYING:
            noted = object.__getattribute__(self, "__dict__").get("noted")
            if noted is not None:  # None while it is being made
                noted.add(Cell.of(self))
        return object.__getattribute__(self, name)


class Traced:
    """A source of rules that notes of which cells something is read.

    Args:
        source: where the rules are.

    Attributes:
        read: the cells of which something was read since this was last emptied.
    """

    def __init__(self, source: RuleSource) -> None:
        self.source = source
        self.read: set[Cell] = set()

    @property
    def sequence(self) -> int:
        """That of the source."""
        return self.source.sequence

    def rules_at_nodes(self, nodes: Sequence[str]) -> list[Rule]:
        """Those of the source, each of which notes what is read of it."""
        return [self._noting(rule) for rule in self.source.rules_at_nodes(nodes)]

    def _noting(self, rule: Rule) -> Rule:
        values = {each.name: getattr(rule, each.name) for each in fields(Rule)}
        noting = TracingRule(**values)
        noting.__dict__["noted"] = self.read
        return noting


class Opaque:
    """A score of which nothing can be found out but how it compares with others.

    Args:
        level: its place in the order; higher is better.
    """

    __slots__ = ("_key",)

    def __init__(self, level: int) -> None:
        # Levels are four apart: there is room for "a little less" on either side of zero.
        self._key = 4 * level

    def __neg__(self) -> Opaque:
        return self._made(-self._key)

    def __sub__(self, other: object) -> Opaque:
        if other != EPSILON:
            raise TypeError("Of a score only the tolerance of ties may be taken away.")
        return self._made(self._key - 1)

    def __lt__(self, other: Opaque) -> bool:
        return self._key < other._key

    def __gt__(self, other: Opaque) -> bool:
        return self._key > other._key

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Opaque) and self._key == other._key

    def __hash__(self) -> int:
        raise TypeError("A score may only be compared.")

    @classmethod
    def _made(cls, key: int) -> Opaque:
        made = cls.__new__(cls)
        made._key = key
        return made


@dataclass(frozen=True)
class BlindOperators(Operators):
    """The operators, with opaque scores for some intervals.

    Attributes:
        scores: interval -> what it is ranked by.
    """

    scores: Mapping[Interval, Opaque] = field(default_factory=dict[Interval, Opaque])

    def rank(self, interval: Interval) -> float:
        """The opaque score of an interval, which only looks like a number to the type checker."""
        return cast("float", self.scores[interval])
