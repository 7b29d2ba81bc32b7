# SPDX-License-Identifier: Apache-2.0
"""Derivations to look at: which words made what, and the lambda term of each step."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..grammar.categories import Category
from ..grammar.combinators import Combination
from ..grammar.terms import quote
from ..lexicon.lexicon import Entry
from .chart import Derivation


@dataclass(frozen=True)
class DerivationStep:
    """One step of a derivation; as text, with all steps below it.

    Attributes:
        words: the words it spans.
        category: what they are.
        term: what they mean, in normal form.
        rule: `>`, `<`, `>B`, `<B`, a change of category, or empty for a word.
        parts: the steps it rests on.
    """

    words: str
    category: str
    term: str
    rule: str
    parts: tuple[DerivationStep, ...]

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self, depth: int = 0) -> Iterator[str]:
        """One line for each step, indented by how deep it lies, words first seen at the leaves."""
        mark = f'"{self.words}"' if not self.parts else self.rule
        yield f"{'  ' * depth}{self.category} : {self.term}    {mark}"
        for part in self.parts:
            yield from part.lines(depth + 1)

    def as_json(self) -> dict[str, object]:
        """The tree for other programs."""
        return {
            "words": self.words,
            "category": self.category,
            "term": self.term,
            "rule": self.rule,
            "parts": [part.as_json() for part in self.parts],
        }


def steps(derivation: Derivation, words: tuple[str, ...]) -> DerivationStep:
    """The steps of a derivation.

    Args:
        derivation: as the chart built it.
        words: the tokens of the utterance.
    """
    return DerivationStep(
        " ".join(words[derivation.start : derivation.end]),
        str(derivation.category),
        str(quote(derivation.value)),
        _shown(derivation),
        tuple(steps(part, words) for part in derivation.parts),
    )


def entries_of(derivation: Derivation) -> Iterator[Entry]:
    """The readings of words that a derivation rests on, from left to right."""
    if isinstance(derivation.rule, Entry):
        yield derivation.rule
    for part in derivation.parts:
        yield from entries_of(part)


def categories_of(derivation: Derivation) -> Iterator[Category]:
    """The categories of all spans that a derivation goes through."""
    yield derivation.category
    for part in derivation.parts:
        yield from categories_of(part)


def _shown(derivation: Derivation) -> str:
    rule = derivation.rule
    if isinstance(rule, Entry):
        return ""
    return rule.value if isinstance(rule, Combination) else str(rule)
