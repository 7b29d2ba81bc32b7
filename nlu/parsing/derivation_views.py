"""Derivation trees for people: as indented text and as JSON.

Every step shows its words, its category and its lambda term in normal form.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from ..grammar.combinators import BinaryRule
from ..grammar.terms import quote
from ..lexicon.lexicon import Entry
from .chart import Derivation


@dataclass(frozen=True)
class DerivationStep:
    """One step of a derivation; `str()` gives it and all steps below it as indented text.

    Attributes:
        term: the lambda term of its span, in normal form.
        rule: `>`, `<`, `>B`, `<B`, a unary rule, or empty for a word.
    """

    words: str
    category: str
    term: str
    rule: str
    parts: tuple[DerivationStep, ...]

    def __str__(self) -> str:
        return "\n".join(self.lines())

    def lines(self, depth: int = 0) -> Iterator[str]:
        """One line for each step, parents before children, indented by depth."""
        mark = f'"{self.words}"' if not self.parts else self.rule
        yield f"{'  ' * depth}{self.category} : {self.term}    {mark}"
        for part in self.parts:
            yield from part.lines(depth + 1)

    def as_json(self) -> dict[str, object]:
        """The tree as a JSON object."""
        return {**vars(self), "parts": [part.as_json() for part in self.parts]}


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
