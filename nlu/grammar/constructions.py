# SPDX-License-Identifier: Apache-2.0
r"""Constructions: whole turns of phrase with gaps, as lexical entries of a categorial grammar.

`"{a:K} is a job for {x:NP}"` is written as people say it. Its first words become an entry that
takes the gaps, and a category of its own for each further run of words, as its arguments: here
`(R/NP)\K` for "is a job for". So a construction combines by application like any other word, and
the chart knows nothing of it. After lexicalised construction grammar (Steedman 2000).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from ...ontology.yaml_reader import Field
from .categories import AtomicCategory, Category, Functor
from .patterns import is_gap
from .terms import Lambda, Term, bind


@dataclass(frozen=True)
class Gap:
    """A place in a construction: `{x:NP}`, or `{NP}` where its meaning does not matter.

    Attributes:
        name: how the term calls its meaning, empty where it does not.
        category: what goes there.
    """

    name: str
    category: Category


@dataclass(frozen=True)
class Run:
    """Words of a construction that stand together, as a pattern."""

    text: str
    name = ""

    @property
    def category(self) -> Category:
        """What these words are, and no others."""
        return AtomicCategory(f'"{self.text}"')


Piece = Gap | Run


@dataclass(frozen=True)
class Construction:
    """One spelling of a construction, with one of its meanings.

    Attributes:
        pieces: its gaps and runs of words, in order.
        result: what the whole is.
        term: what the whole means, with the names of the gaps in it.
    """

    pieces: tuple[Piece, ...]
    result: Category
    term: Term

    @cached_property
    def anchor(self) -> int:
        """The place of what takes the rest: the first words, or else the first nameless gap."""
        for place, piece in enumerate(self.pieces):
            if isinstance(piece, Run):
                return place
        return next((place for place, piece in enumerate(self.pieces) if not piece.name), 0)

    @property
    def head(self) -> Piece:
        """What takes the rest."""
        return self.pieces[self.anchor]

    @property
    def gaps(self) -> tuple[Gap, ...]:
        """The gaps whose meanings the term has, by name."""
        return tuple(piece for piece in self.pieces if isinstance(piece, Gap) and piece.name)

    @cached_property
    def category(self) -> Category:
        """The category of the head; of a gap, what it changes to."""
        category = self.result
        for place in self._taken_last_first():
            forward = place > self.anchor
            category = Functor(category, self.pieces[place].category, forward)
        return category

    def functor(self) -> Term:
        """The term of the head; of a gap, the function from what it means to that."""
        term = self.term
        for place in self._taken_last_first():
            term = _taking(self.pieces[place], term)
        return term if isinstance(self.head, Run) else _taking(self.head, term)

    def _taken_last_first(self) -> Iterator[int]:
        # What is taken last is the innermost of the category and of the term.
        yield from range(self.anchor)
        yield from range(len(self.pieces) - 1, self.anchor, -1)


def pieces_of(variant: Sequence[str], field: Field) -> tuple[Piece, ...]:
    """The gaps and runs of words of a construction, from `patterns.variants`.

    Raises:
        DataError: a gap is not written as `{name:CATEGORY}`.
    """
    return tuple(_gap(text, field) if is_gap(text) else Run(text) for text in variant)


def runs(found: Sequence[Piece]) -> list[Run]:
    """The runs of words among some pieces."""
    return [piece for piece in found if isinstance(piece, Run)]


def _taking(piece: Piece, term: Term) -> Lambda:
    return bind(term, piece.name) if piece.name else Lambda(term, "s")


_GAP = re.compile(r"\{(?:(?P<name>\w+):)?(?P<category>\w+)\}")


def _gap(text: str, field: Field) -> Gap:
    found = _GAP.fullmatch(text)
    if found is None:
        raise field.fail(f'expected a gap like {{x:NP}}, found "{text}".')
    return Gap(found["name"] or "", AtomicCategory(found["category"]))
