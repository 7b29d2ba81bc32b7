r"""Constructions: phrases with gaps as lexical entries of a categorial grammar (Steedman 2000).

Of `"{a:K} is a job for {x:NP}"` the first words become an entry that takes the gaps as its
arguments, and every further run of words with a category of its own: here `(R/NP)\K` for "is a job
for". So a construction combines by application like any word, without a special case in the chart.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

from ...ontology.yaml_reader import YamlNode
from .categories import AtomicCategory, Category, Functor
from .terms import Lambda, Term, bind
from .word_patterns import is_gap

_GAP = re.compile(r"\{(?:(?P<name>\w+):)?(?P<category>\w+)\}")


@dataclass(frozen=True)
class ConstructionPiece:
    """A gap, `{x:NP}`, or adjacent words, as a pattern, with the category that only they have.

    The name is empty if the term does not use the meaning of the piece.
    """

    name: str
    category: AtomicCategory


@dataclass(frozen=True)
class Construction:
    """One spelling of a construction, with one of its meanings."""

    pieces: tuple[ConstructionPiece, ...]  #: its gaps and runs of words, in order
    result: Category  #: the category of the whole phrase
    term: Term  #: its meaning, in which the names of the gaps are constants

    @cached_property
    def anchor(self) -> int:
        """The index of the head: the first run of words, or else the first nameless gap."""
        words = (n for n, piece in enumerate(self.pieces) if piece.category.is_words)
        return next(words, next((n for n, piece in enumerate(self.pieces) if not piece.name), 0))

    @property
    def head(self) -> ConstructionPiece:
        """The piece that takes the others as arguments."""
        return self.pieces[self.anchor]

    @cached_property
    def category(self) -> Category:
        """The category of the head, or if that is a gap, the category that it changes to."""
        category = self.result
        for place in self._taken_last_first():
            category = Functor(category, self.pieces[place].category, place > self.anchor)
        return category

    def functor(self) -> Term:
        """The term of the head, or if that is a gap, the function from its meaning to the term."""
        term = self.term
        taken = [self.pieces[place] for place in self._taken_last_first()]
        for piece in taken if self.head.category.is_words else (*taken, self.head):
            term = bind(term, piece.name) if piece.name else Lambda(term, "s")
        return term

    def _taken_last_first(self) -> Iterator[int]:
        # The last argument taken is the innermost one of the category and of the term.
        yield from range(self.anchor)
        yield from range(len(self.pieces) - 1, self.anchor, -1)


def pieces_of(variant: Sequence[str], field: YamlNode) -> tuple[ConstructionPiece, ...]:
    """The gaps and runs of words of a construction; `DataError` unless a gap is `{name:NP}`."""
    pieces: list[ConstructionPiece] = []
    for text in variant:
        found = _GAP.fullmatch(text)
        if is_gap(text) and not found:
            raise field.fail(f'expected a gap like {{x:NP}}, found "{text}".')
        name, category = (found["name"] or "", found["category"]) if found else ("", f'"{text}"')
        pieces.append(ConstructionPiece(name, AtomicCategory(category)))
    return tuple(pieces)
