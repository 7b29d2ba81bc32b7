# SPDX-License-Identifier: Apache-2.0
"""The chart: all that a sequence of words can be, cell by cell, in time n³.

A cell holds the categories of one span, each with the ways it came about (Cocke, Kasami, Younger).
Meanings are computed only for what spans the whole utterance, so nothing is ever understood from a
part of it. For each category of a span the `MAX_DERIVATIONS` cheapest derivations are kept.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import NamedTuple, TypeAlias

from ..grammar.categories import Category
from ..grammar.combinators import Combination, Combinator, Sign
from ..grammar.grammar import Unary
from ..grammar.terms import Value, compose
from ..lexicon.lexicon import Entry, EntryIndex, Lexicon

MAX_DERIVATIONS = 16


class Derivation(NamedTuple):
    """One way in which a span of words is a category, with its meaning.

    Attributes:
        category: what the span is.
        value: what it means.
        cost: the sum of the costs of its words; the less, the likelier.
        start: its first token.
        end: one past its last token.
        rule: how it came about: a word, a change of category, or a combination.
        parts: none for a word, one for a change, two for a combination, all of a frame.
    """

    category: Category
    value: Value
    cost: float
    start: int
    end: int
    rule: Entry | Unary | Combination
    parts: tuple[Derivation, ...] = ()


class _Way(NamedTuple):
    rule: Unary | Combination
    middle: int = 0
    left: Sign = 0
    right: Sign = 0


_Cell: TypeAlias = "dict[Sign, list[Entry | _Way]]"


class Chart:
    """The filled chart of one utterance.

    Args:
        tokens: the words.
        lexicon: what they may be.
        combinator: what combines.
        guesses: readings of words that the lexicon does not have, by position.
    """

    def __init__(
        self,
        tokens: Sequence[str],
        lexicon: Lexicon,
        combinator: Combinator,
        guesses: Mapping[int, Sequence[Entry]] | None = None,
    ) -> None:
        self.length = len(tokens)
        self._combinator = combinator
        self._cells: list[list[_Cell]] = [
            [{} for _ in range(self.length + 1)] for _ in range(self.length)
        ]
        self._signs: list[list[tuple[Sign, ...]]] = [
            [()] * (self.length + 1) for _ in range(self.length)
        ]
        self._known: dict[tuple[int, int, Sign], list[Derivation]] = {}
        self._add_words(tokens, lexicon, guesses or {})
        self._fill()

    def signs(self, start: int, end: int) -> tuple[Sign, ...]:
        """What the span is, as the combinator numbers it."""
        return self._signs[start][end]

    def categories(self, start: int, end: int) -> list[Category]:
        """What the span is."""
        return [self._combinator.category(sign) for sign in self.signs(start, end)]

    def derivations(self, category: Category) -> list[Derivation]:
        """How the whole utterance is this category, the cheapest first."""
        return self.spanning(0, self.length, category) if self.length else []

    def spanning(self, start: int, end: int, category: Category) -> list[Derivation]:
        """How a span is this category, the cheapest first."""
        sign = self._combinator.sign(category)
        return self._derivations(start, end, sign) if sign in self.signs(start, end) else []

    def fragments(self, categories: Collection[Category]) -> Iterator[Derivation]:
        """The two cheapest derivations of each span that is one of some categories."""
        wanted = {self._combinator.sign(category) for category in categories}
        for start, row in enumerate(self._signs):
            for end, signs in enumerate(row):
                for sign in wanted.intersection(signs):
                    yield from self._derivations(start, end, sign)[:2]

    def longest_span(self) -> tuple[int, int]:
        """The longest span that is anything at all, the leftmost among equals; (0, 0) for none."""
        for width in range(self.length, 0, -1):
            for start in range(self.length - width + 1):
                if self._signs[start][start + width]:
                    return start, start + width
        return 0, 0

    def _add_words(
        self, tokens: Sequence[str], lexicon: Lexicon, guesses: Mapping[int, Sequence[Entry]]
    ) -> None:
        found = [
            (self._cells[start][end], node.index(self._combinator))
            for start in range(self.length)
            for end, node in lexicon.nodes(tokens, start)
        ]
        for cell, entries in found:
            for sign, plain in entries.plain.items():
                cell.setdefault(sign, []).extend(plain)
        for start, added in guesses.items():
            for guess in added:
                end = start + len(guess.says.split(" "))
                self._cells[start][end].setdefault(guess.sign, []).append(guess)
        self._add_turns(found)

    def _add_turns(self, found: Sequence[tuple[_Cell, EntryIndex]]) -> None:
        """Add the entries of constructions, but for those whose other words are not there.

        Nothing is lost: a category that seeks certain words never finds them, and words that
        nothing seeks are part of nothing. It is most of the entries, and most of the time.
        """
        turn = self._combinator.turn
        there = {entry.sign for _, entries in found for entry in entries.words}
        wanted = set(self._combinator.wanted_by_changes)
        for cell, entries in found:
            for need in there & entries.heads.keys():
                for entry in entries.heads[need]:
                    needs = turn(entry.sign).needs
                    if needs <= there:
                        wanted |= needs
                        cell.setdefault(entry.sign, []).append(entry)
        for sign in there:
            for needs in turn(sign).changes:
                if needs <= there:
                    wanted |= {sign, *needs}
        for cell, entries in found:
            for entry in entries.words:
                if entry.sign in wanted:
                    cell.setdefault(entry.sign, []).append(entry)

    def _fill(self) -> None:
        join, cells, signs = self._combinator.join, self._cells, self._signs
        for width in range(1, self.length + 1):
            for start in range(self.length - width + 1):
                end = start + width
                cell, row = cells[start][end], signs[start]
                for middle in range(start + 1, end):
                    left, right = row[middle], signs[middle][end]
                    if left and right:
                        for result, one, other, rule in join(left, right):
                            cell.setdefault(result, []).append(_Way(rule, middle, one, other))
                if cell:
                    self._change(cell)
                    row[end] = tuple(sorted(cell))

    def _change(self, cell: _Cell) -> None:
        # What appears through a change may change again; grammars have no cycles of changes.
        changes = self._combinator.changes
        pending = [sign for sign in cell if changes(sign)]
        while pending:
            sign = pending.pop()
            for target, rule in changes(sign):
                if target not in cell:
                    cell[target] = []
                    pending.append(target)
                cell[target].append(_Way(rule, left=sign))

    def _derivations(self, start: int, end: int, sign: Sign) -> list[Derivation]:
        key = (start, end, sign)
        found = self._known.get(key)
        if found is None:
            found = []
            category = self._combinator.category(sign)
            for way in self._cells[start][end][sign]:
                found += self._derived(start, end, category, way)
            if len(found) > 1:
                found.sort(key=_cost)
                del found[MAX_DERIVATIONS:]
            self._known[key] = found
        return found

    def _derived(
        self, start: int, end: int, category: Category, way: Entry | _Way
    ) -> list[Derivation]:
        if isinstance(way, Entry):
            return [Derivation(category, way.value, way.cost, start, end, way)]
        rule = way.rule
        if isinstance(rule, Unary):
            return [
                Derivation(
                    category,
                    rule.value(part.value),
                    part.cost + rule.cost,
                    start,
                    end,
                    rule,
                    (part,),
                )
                for part in self._derivations(start, end, way.left)
            ]
        return [
            Derivation(
                category,
                _meaning(rule, left.value, right.value),
                left.cost + right.cost,
                start,
                end,
                rule,
                (left, right),
            )
            for left in self._derivations(start, way.middle, way.left)
            for right in self._derivations(way.middle, end, way.right)
        ]


def _meaning(rule: Combination, left: Value, right: Value) -> Value:
    if rule is Combination.FORWARD:
        return left(right)
    if rule is Combination.BACKWARD:
        return right(left)
    if rule is Combination.FORWARD_COMPOSITION:
        return compose(left, right)
    return compose(right, left)


def _cost(derivation: Derivation) -> float:
    return derivation.cost
