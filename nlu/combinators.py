# SPDX-License-Identifier: Apache-2.0
"""How two neighbouring categories combine: application, and harmonic composition in normal form.

Of the many derivations that composition gives one and the same meaning, only one is built
(Eisner 1996): what came out of a forward composition is not used as the functor of a forward rule
again, and the same backward. Categories are numbered, with the rule they came from where that
matters, and what two numbers give is worked out once: a chart only looks it up.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from enum import Enum
from typing import TypeAlias

from .categories import Category, Functor
from .grammar import Unary


class Combination(Enum):
    """A rule for two neighbours, with the sign that derivations show."""

    FORWARD = ">"
    """`X/Y Y` gives `X`."""
    BACKWARD = "<"
    """`Y X\\Y` gives `X`."""
    FORWARD_COMPOSITION = ">B"
    """`X/^Y Y/^Z` gives `X/^Z`."""
    BACKWARD_COMPOSITION = "<B"
    """`Y\\^Z X\\^Y` gives `X\\^Z`."""


Sign: TypeAlias = int
Joined: TypeAlias = "tuple[Sign, Sign, Sign, Combination]"

MAX_REMEMBERED = 200_000


class Combinator:
    """The table of what combines to what; it grows with use, up to `MAX_REMEMBERED` entries."""

    def __init__(self, unary: Iterable[Unary]) -> None:
        self._changes = tuple(unary)
        self._numbers: dict[tuple[Category, Combination | None], Sign] = {}
        self._categories: list[Category] = []
        self._origins: list[Combination | None] = []
        self._pairs: dict[tuple[Sign, Sign], tuple[tuple[Sign, Combination], ...]] = {}
        self._cells: dict[tuple[tuple[Sign, ...], tuple[Sign, ...]], tuple[Joined, ...]] = {}
        self._unary: dict[Sign, tuple[tuple[Sign, Unary], ...]] = {}

    def sign(self, category: Category, origin: Combination | None = None) -> Sign:
        """The number of a category that came out of a rule.

        Args:
            category: the category.
            origin: the composition that gave it, None for everything else.
        """
        number = self._numbers.setdefault((category, origin), len(self._categories))
        if number == len(self._categories):
            self._categories.append(category)
            self._origins.append(origin)
        return number

    def category(self, sign: Sign) -> Category:
        """The category that a number stands for."""
        return self._categories[sign]

    def changes(self, sign: Sign) -> tuple[tuple[Sign, Unary], ...]:
        """What a category may become without a neighbour."""
        found = self._unary.get(sign)
        if found is None:
            category = self._categories[sign]
            found = tuple(
                (self.sign(rule.target), rule) for rule in self._changes if rule.source == category
            )
            self._unary[sign] = found
        return found

    def join(self, left: tuple[Sign, ...], right: tuple[Sign, ...]) -> tuple[Joined, ...]:
        """All that two neighbouring cells give: (result, left, right, rule)."""
        key = (left, right)
        found = self._cells.get(key)
        if found is None:
            if len(self._cells) >= MAX_REMEMBERED:
                self._cells.clear()
            found = tuple(
                (result, one, other, rule)
                for one in left
                for other in right
                for result, rule in self.combine(one, other)
            )
            self._cells[key] = found
        return found

    def combine(self, left: Sign, right: Sign) -> tuple[tuple[Sign, Combination], ...]:
        """All that two neighbouring categories give."""
        key = (left, right)
        found = self._pairs.get(key)
        if found is None:
            if len(self._pairs) >= MAX_REMEMBERED:
                self._pairs.clear()
            found = tuple(self._combinations(left, right))
            self._pairs[key] = found
        return found

    def _combinations(self, left: Sign, right: Sign) -> Iterator[tuple[Sign, Combination]]:
        one, other = self._categories[left], self._categories[right]
        forward, backward = Combination.FORWARD_COMPOSITION, Combination.BACKWARD_COMPOSITION
        if isinstance(one, Functor) and one.forward and self._origins[left] is not forward:
            if one.argument == other:
                yield self.sign(one.result), Combination.FORWARD
            elif _composes(one, other):
                yield self.sign(_composed(one, other), forward), forward
        if isinstance(other, Functor) and not other.forward:
            if self._origins[right] is backward:
                return
            if other.argument == one:
                yield self.sign(other.result), Combination.BACKWARD
            elif _composes(other, one):
                yield self.sign(_composed(other, one), backward), backward


def _composes(outer: Functor, inner: Category) -> bool:
    # Harmonic only: both look the same way, and both slashes allow it.
    return (
        isinstance(inner, Functor)
        and inner.forward == outer.forward
        and outer.composes
        and inner.composes
        and inner.result == outer.argument
    )


def _composed(outer: Functor, inner: Category) -> Category:
    if not isinstance(inner, Functor):
        raise TypeError("Only functors compose.")
    return Functor(outer.result, inner.argument, forward=outer.forward, composes=True)
