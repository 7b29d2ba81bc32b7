"""The CCG chart of a token sequence, filled by the CKY algorithm (Cocke, Kasami, Younger) in O(n³).

A cell holds the categories of one span, each with back pointers to the cells it was built from.
Derivations and meanings are only computed on demand, for what spans the whole utterance. For each
category of a span the `MAX_DERIVATIONS` cheapest derivations are kept.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from typing import NamedTuple, TypeAlias

from ..grammar.categories import Category
from ..grammar.combinators import BinaryRule, CombinationTable, Sign
from ..grammar.grammar import UnaryRule
from ..grammar.terms import Value, compose, quote
from ..lexicon.lexicon import Entry, EntryIndex, Lexicon

MAX_DERIVATIONS = 16


class Derivation(NamedTuple):
    """A derivation of a category for the tokens from `start` up to, not including, `end`."""

    category: Category
    value: Value  # the meaning
    cost: float  # the sum of the costs of its words and unary rules; the lower, the likelier
    start: int
    end: int
    rule: Entry | UnaryRule | BinaryRule  # the lexical entry or rule that gave it
    parts: "tuple[Derivation, ...]" = ()  # one for a unary rule, two for a combination


class _BackPointer(NamedTuple):
    rule: UnaryRule | BinaryRule
    middle: int = 0
    left: Sign = 0
    right: Sign = 0


_Cell: TypeAlias = "dict[Sign, list[Entry | _BackPointer]]"


class Chart:
    """The filled chart of one token sequence, with guesses for unknown words by position."""

    def __init__(
        self,
        tokens: Sequence[str],
        lexicon: Lexicon,
        combinator: CombinationTable,
        guesses: Mapping[int, Sequence[Entry]] | None = None,
    ) -> None:
        self.length = len(tokens)
        self._combinator = combinator
        size = self.length + 1
        self._cells: list[list[_Cell]] = [[{} for _ in range(size)] for _ in tokens]
        self._signs: list[list[tuple[Sign, ...]]] = [[()] * size for _ in tokens]
        self._known: dict[tuple[int, int, Sign], list[Derivation]] = {}
        self._add_words(tokens, lexicon, guesses or {})
        self._fill()

    def categories(self, start: int, end: int) -> list[Category]:
        """Return the categories of a span."""
        return [self._combinator.category(sign) for sign in self._signs[start][end]]

    def derivations(self, category: Category) -> list[Derivation]:
        """Return the derivations of the whole sequence as a category, the cheapest first."""
        sign, end = self._combinator.sign(category), self.length
        return self._derivations(0, end, sign) if end and sign in self._signs[0][end] else []

    def longest_span(self) -> tuple[int, int]:
        """Return the longest span with a category, the leftmost among equals; (0, 0) for none."""
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
        self._add_constructions(found)

    def _add_constructions(self, found: Sequence[tuple[_Cell, EntryIndex]]) -> None:
        """Add the entries of constructions all of whose words occur in the sequence.

        This loses no derivation: a category that seeks other words would never find them, and
        words that nothing seeks combine with nothing. It skips most of the entries.
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
                            pointer = _BackPointer(rule, middle, one, other)
                            cell.setdefault(result, []).append(pointer)
                if cell:
                    self._apply_unary_rules(cell)
                    row[end] = tuple(sorted(cell))

    def _apply_unary_rules(self, cell: _Cell) -> None:
        # Unary rules may apply to the result of others; grammars have no cycles of them.
        changes = self._combinator.changes
        pending = [sign for sign in cell if changes(sign)]
        while pending:
            sign = pending.pop()
            for target, rule in changes(sign):
                if target not in cell:
                    cell[target] = []
                    pending.append(target)
                cell[target].append(_BackPointer(rule, left=sign))

    def _derivations(self, start: int, end: int, sign: Sign) -> list[Derivation]:
        key = (start, end, sign)
        found = self._known.get(key)
        if found is None:
            found = []
            category = self._combinator.category(sign)
            for pointer in self._cells[start][end][sign]:
                found.extend(self._derived(start, end, category, pointer))
            if len(found) > 1:
                found.sort(key=attrgetter("cost"))
                del found[MAX_DERIVATIONS:]
            self._known[key] = found
        return found

    def _derived(
        self, start: int, end: int, category: Category, pointer: Entry | _BackPointer
    ) -> Iterator[Derivation]:
        if isinstance(pointer, Entry):
            yield Derivation(category, pointer.value, pointer.cost, start, end, pointer)
        elif isinstance(rule := pointer.rule, UnaryRule):
            for part in self._derivations(start, end, pointer.left):
                value, cost = rule.value(part.value), part.cost + rule.cost
                yield Derivation(category, value, cost, start, end, rule, (part,))
        else:
            for left in self._derivations(start, pointer.middle, pointer.left):
                for right in self._derivations(pointer.middle, end, pointer.right):
                    value, cost = _meaning(rule, left.value, right.value), left.cost + right.cost
                    yield Derivation(category, value, cost, start, end, rule, (left, right))


def _meaning(rule: BinaryRule, left: Value, right: Value) -> Value:
    if rule is BinaryRule.FORWARD:
        return left(right)
    if rule is BinaryRule.BACKWARD:
        return right(left)
    return compose(left, right) if rule is BinaryRule.FORWARD_COMPOSITION else compose(right, left)


@dataclass(frozen=True)
class DerivationStep:
    """One step of a derivation; `str()` gives it and all steps below it as indented text."""

    words: str
    category: str
    term: str  # the lambda term of its span, in normal form
    rule: str  # `>`, `<`, `>B`, `<B`, a unary rule, or empty for a word
    parts: "tuple[DerivationStep, ...]"

    def __str__(self) -> str:
        mark = self.rule if self.parts else f'"{self.words}"'
        below = "".join(f"\n{part}" for part in self.parts).replace("\n", "\n  ")
        return f"{self.category} : {self.term}    {mark}{below}"


def derivation_step(derivation: Derivation, words: tuple[str, ...]) -> DerivationStep:
    """Return the root step of a derivation of the words of an utterance."""
    rule = derivation.rule
    shown = rule.value if isinstance(rule, BinaryRule) else str(rule)
    return DerivationStep(
        " ".join(words[derivation.start : derivation.end]),
        str(derivation.category),
        str(quote(derivation.value)),
        "" if isinstance(rule, Entry) else shown,
        tuple(derivation_step(part, words) for part in derivation.parts),
    )


def subderivations(derivation: Derivation) -> Iterator[Derivation]:
    """The derivation and all that it consists of, from the root down and from left to right."""
    yield derivation
    for part in derivation.parts:
        yield from subderivations(part)


def lexical_entries(derivation: Derivation) -> list[Entry]:
    """Return the lexical entries that a derivation uses, from left to right."""
    rules = (each.rule for each in subderivations(derivation))
    return [rule for rule in rules if isinstance(rule, Entry)]
