# SPDX-License-Identifier: Apache-2.0
"""What words may be, as the lines of a language file say it: made into entries when it is heard."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from ..grammar.categories import Category
from ..grammar.combinators import Combinator
from ..grammar.constructions import Construction
from ..grammar.terms import evaluate, replace_constants
from .lexicon import Entry, EntryTemplate


@dataclass(frozen=True)
class TemplateSense:
    """What a word is by one line of a template.

    Attributes:
        says: the word, in the form that the line is for.
        frame: the line.
        names: what stands for the constants of the template.
        combinator: numbers the categories.
        name: what the word names, empty where it names nothing.
        role: of a word not in the lexicon, what it would be.
        cost: how unlikely this is, besides the cost of the line.
    """

    says: str
    frame: EntryTemplate
    names: Mapping[str, str]
    combinator: Combinator
    name: str = ""
    role: str = ""
    cost: float = 0.0

    @property
    def category(self) -> Category:
        """What the word is."""
        return self.frame.category

    def entry(self) -> Entry:
        """The entry of the word."""
        category, term = self.frame.category, replace_constants(self.frame.term, self.names)
        sign, cost = self.combinator.sign(category), self.frame.cost + self.cost
        return Entry(
            category, term, evaluate(term), sign, cost, self.name, self.role, says=self.says
        )


@dataclass(frozen=True)
class ConstructionSense:
    """The first words of a construction, which take the rest.

    Attributes:
        construction: the construction.
        cost: how unlikely it is.
        combinator: numbers the categories.
        says: the words.
    """

    construction: Construction
    cost: float
    combinator: Combinator
    says: str
    name = ""

    @property
    def category(self) -> Category:
        """What the words are."""
        return self.construction.category

    def entry(self) -> Entry:
        """The entry of the words."""
        category, term = self.construction.category, self.construction.functor()
        sign = self.combinator.sign(category)
        return Entry(category, term, evaluate(term), sign, self.cost, says=self.says)
