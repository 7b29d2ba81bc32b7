# SPDX-License-Identifier: Apache-2.0
r"""Constructions: whole turns of phrase with gaps, as lexical entries of a categorial grammar.

`"{a:K} is a job for {x:NP}"` is written as people say it. Its first words become an entry that
takes the gaps, and a category of its own for each further run of words, as its arguments: here
`(R/NP)\K` for "is a job for". So a construction combines by application like any other word, and
the chart knows nothing of it. After lexicalised construction grammar (Steedman 2000).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, cached_property

from ..ontology.source import Field
from .categories import Atom, Category, Functor
from .patterns import Group
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
    """Words of a construction that stand together."""

    words: tuple[str, ...]
    name = ""

    @property
    def category(self) -> Category:
        """What these words are, and no others."""
        return Atom(f'"{" ".join(self.words)}"')


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

    def without_head(self) -> tuple[Piece, ...]:
        """The same for all constructions that differ only in their first words."""
        head = _ANY_WORDS if isinstance(self.head, Run) else self.head
        return (*self.pieces[: self.anchor], head, *self.pieces[self.anchor + 1 :])

    def functor(self) -> tuple[Category, Term]:
        """The category and the term of the head; of a gap, those that it changes to."""
        before, after = self.pieces[: self.anchor], self.pieces[self.anchor + 1 :]
        category, term = self.result, self.term
        # What is taken last is the innermost of the category and of the term.
        for piece in before:
            category = Functor(category, piece.category, forward=False)
            term = _taking(piece, term)
        for piece in reversed(after):
            category = Functor(category, piece.category, forward=True)
            term = _taking(piece, term)
        return category, term if isinstance(self.head, Run) else _taking(self.head, term)

    def to_be_checked(self) -> tuple[Category, Term]:
        """The gaps with names as a category and its term, to be checked against each other."""
        category, term = self.result, self.term
        for piece in reversed(self.pieces):
            if piece.name:
                category = Functor(category, piece.category, forward=True)
                term = _taking(piece, term)
        return category, term


_ANY_WORDS = Run(())


def pieces(words: Sequence[str | Group], field: Field) -> tuple[Piece, ...]:
    """The gaps and runs of words of one spelling.

    Raises:
        DataError: a gap is not written as `{name:CATEGORY}`.
    """
    found: list[Piece] = []
    run: list[str] = []
    for word in words:
        if isinstance(word, str) and not word.startswith("{"):
            run.append(word)
            continue
        if run:
            found.append(Run(tuple(run)))
            run.clear()
        found.append(_gap(word) if isinstance(word, str) else Gap("", category_of(word)))
        if found[-1] == _NO_GAP:
            raise field.fail(f'expected a gap like {{x:NP}}, found "{word}".')
    return (*found, Run(tuple(run))) if run else tuple(found)


def category_of(group: Group) -> Category:
    """What the words of a group are, and no others."""
    return Atom(f'"{group.text}"')


def runs(found: Sequence[Piece]) -> list[Run]:
    """The runs of words among some pieces."""
    return [piece for piece in found if isinstance(piece, Run)]


def _taking(piece: Piece, term: Term) -> Lambda:
    return bind(term, piece.name) if piece.name else Lambda(term, "s")


_NO_GAP = Gap("", Atom(""))


@cache
def _gap(word: str) -> Gap:
    name, colon, category = word.strip("{}").partition(":")
    if not word.endswith("}") or not (category if colon else name).isalnum():
        return _NO_GAP
    return Gap(name, Atom(category)) if colon else Gap("", Atom(name))
