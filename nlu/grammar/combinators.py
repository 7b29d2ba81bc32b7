"""How two neighbouring categories combine: application, and harmonic composition in normal form.

Of the many derivations that composition gives one and the same meaning, only one is built
(Eisner 1996): what came out of a forward composition is not used as the functor of a forward rule
again, and the same backward. Categories are numbered, with the rule they came from where that
matters, and what two numbers give is worked out once: a chart only looks it up.
"""

from collections.abc import Iterable, Iterator
from enum import Enum
from functools import cache, cached_property, lru_cache
from typing import NamedTuple, TypeAlias

from .categories import AtomicCategory, Category, Functor
from .grammar import UnaryRule


class BinaryRule(Enum):
    """A rule for two neighbours, with the sign that derivations show."""

    FORWARD = ">"  # `X/Y Y` gives `X`
    BACKWARD = "<"  # `Y X\Y` gives `X`
    FORWARD_COMPOSITION = ">B"  # `X/^Y Y/^Z` gives `X/^Z`
    BACKWARD_COMPOSITION = "<B"  # `Y\^Z X\^Y` gives `X\^Z`


Sign: TypeAlias = int


class _Way(NamedTuple):
    """Where a functor seeks what, and what it gives; `forward` is None for no functor."""

    forward: bool | None
    sought: Sign
    given: Sign
    composes: bool


class ConstructionRestriction(NamedTuple):
    """Whether a category stands only for certain words of constructions, and which it takes."""

    is_words: bool
    needs: frozenset[Sign]
    changes: tuple[frozenset[Sign], ...]
    """The words that each category takes to which it may change."""


_NOWHERE = _Way(None, -1, -1, False)
Joined: TypeAlias = "tuple[Sign, Sign, Sign, BinaryRule]"

MAX_REMEMBERED = 20_000
"""A conversation needs a few thousand; of random words more would only take memory."""


class CombinationTable:
    """The table of what combines to what; it grows with use, up to `MAX_REMEMBERED` entries."""

    def __init__(self, unary: Iterable[UnaryRule]) -> None:
        self._changes: dict[Category, list[UnaryRule]] = {}
        self._numbers: dict[tuple[Category, BinaryRule | None], Sign] = {}
        self._categories: list[Category] = []
        self._origins: list[BinaryRule | None] = []
        # For each sign the plain sign of its category, and of what it seeks and gives, if anything.
        self._plain: list[Sign] = []
        self._ways: list[_Way] = []
        self._start_remembering()
        for change in unary:
            self.add(change)

    def _start_remembering(self) -> None:
        #: what the category of a sign has to do with the words of constructions
        self.turn = cache(self._turn)
        #: the signs that a sign may become without a neighbour, each with its rule
        self.changes = cache(self._changed)
        #: all that two neighbouring signs give, each with its rule
        self.combine = lru_cache(MAX_REMEMBERED)(lambda *two: tuple(self._combinations(*two)))
        #: all that two neighbouring cells give: (result, left, right, rule)
        self.join = lru_cache(MAX_REMEMBERED)(self._joined)

    def __getstate__(self) -> dict[str, object]:
        return {name: value for name, value in vars(self).items() if name.startswith("_")}

    def __setstate__(self, state: dict[str, object]) -> None:
        vars(self).update(state)
        self._start_remembering()

    def add(self, change: UnaryRule) -> None:
        """Add a change of category that needs no word."""
        known = self._changes.setdefault(change.source, [])
        if change not in known:
            known.append(change)
            self.turn.cache_clear()
            self.changes.cache_clear()
            self.__dict__.pop("wanted_by_changes", None)

    def sign(self, category: Category, origin: BinaryRule | None = None) -> Sign:
        """The number of a category, of a composed one together with its composition."""
        number = self._numbers.get((category, origin))
        if number is None:
            number = self._numbers[category, origin] = len(self._categories)
            self._categories.append(category)
            self._origins.append(origin)
            self._plain.append(number)
            self._ways.append(_NOWHERE)
            self._plain[number] = number if origin is None else self.sign(category)
            if isinstance(category, Functor):
                sought, given = self.sign(category.argument), self.sign(category.result)
                self._ways[number] = _Way(category.forward, sought, given, category.composes)
        return number

    def category(self, sign: Sign) -> Category:
        """The category that a number stands for."""
        return self._categories[sign]

    def _turn(self, sign: Sign) -> ConstructionRestriction:
        category = self._categories[sign]
        is_words = isinstance(category, AtomicCategory) and category.is_words
        changes = (self._needs(change.target) for change in self._changes.get(category, ()))
        return ConstructionRestriction(is_words, self._needs(category), tuple(changes))

    @cached_property
    def wanted_by_changes(self) -> frozenset[Sign]:
        """The words that the targets of changes of category seek."""
        return frozenset(
            need
            for source, changes in self._changes.items()
            if not (isinstance(source, AtomicCategory) and source.is_words)
            for change in changes
            for need in self._needs(change.target)
        )

    def _needs(self, category: Category) -> frozenset[Sign]:
        needs: set[Sign] = set()
        while isinstance(category, Functor):
            if isinstance(category.argument, AtomicCategory) and category.argument.is_words:
                needs.add(self.sign(category.argument))
            category = category.result
        return frozenset(needs)

    def _changed(self, sign: Sign) -> tuple[tuple[Sign, UnaryRule], ...]:
        rules = self._changes.get(self._categories[sign], ())
        return tuple((self.sign(rule.target), rule) for rule in rules)

    def _joined(self, left: tuple[Sign, ...], right: tuple[Sign, ...]) -> tuple[Joined, ...]:
        # Only functors combine, and most neighbours are not what they seek: look at the few others.
        lefts, rights = self._by_plain(left), self._by_plain(right)
        forward = [(n, way) for n in left if (way := self._ways[n]).forward]
        backward = [(n, way) for n in right if (way := self._ways[n]).forward is False]
        pairs = [(one, n) for one, way in forward for n in rights.get(way.sought, ())]
        pairs += [(n, other) for other, way in backward for n in lefts.get(way.sought, ())]
        return tuple(
            (result, one, other, rule)
            for one, other in dict.fromkeys(pairs)
            for result, rule in self.combine(one, other)
        )

    def _by_plain(self, signs: tuple[Sign, ...]) -> dict[Sign, list[Sign]]:
        found: dict[Sign, list[Sign]] = {}
        for sign in signs:
            found.setdefault(self._plain[sign], []).append(sign)
            if self._ways[sign].composes:
                found.setdefault(self._ways[sign].given, []).append(sign)
        return found

    def _combinations(self, left: Sign, right: Sign) -> Iterator[tuple[Sign, BinaryRule]]:
        one, other = self._categories[left], self._categories[right]
        forward, backward = BinaryRule.FORWARD_COMPOSITION, BinaryRule.BACKWARD_COMPOSITION
        if isinstance(one, Functor) and one.forward and self._origins[left] is not forward:
            if one.argument == other:
                yield self.sign(one.result), BinaryRule.FORWARD
            elif composed := _composed(one, other):
                yield self.sign(composed, forward), forward
        if isinstance(other, Functor) and not other.forward:
            if self._origins[right] is backward:
                return
            if other.argument == one:
                yield self.sign(other.result), BinaryRule.BACKWARD
            elif composed := _composed(other, one):
                yield self.sign(composed, backward), backward


def _composed(outer: Functor, inner: Category) -> Functor | None:
    # Harmonic only: both look the same way, and both slashes allow it.
    if (
        isinstance(inner, Functor)
        and inner.forward == outer.forward
        and outer.composes
        and inner.composes
        and inner.result == outer.argument
    ):
        return Functor(outer.result, inner.argument, forward=outer.forward, composes=True)
    return None
