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


@dataclass(frozen=True)
class ConstructionGap:
    """A gap of a construction, `{x:NP}`; its name is empty if the term does not use its meaning."""

    name: str
    category: Category


@dataclass(frozen=True)
class WordRun:
    """Adjacent words of a construction, as a pattern."""

    text: str
    name = ""

    @property
    def category(self) -> Category:
        """The category that only these words have."""
        return AtomicCategory(f'"{self.text}"')


Piece = ConstructionGap | WordRun


@dataclass(frozen=True)
class Construction:
    """One spelling of a construction, with one of its meanings."""

    pieces: tuple[Piece, ...]  #: its gaps and runs of words, in order
    result: Category  #: the category of the whole phrase
    term: Term  #: its meaning, in which the names of the gaps are constants

    @cached_property
    def anchor(self) -> int:
        """The index of the head: the first run of words, or else the first nameless gap."""
        for place, piece in enumerate(self.pieces):
            if isinstance(piece, WordRun):
                return place
        return next((place for place, piece in enumerate(self.pieces) if not piece.name), 0)

    @property
    def head(self) -> Piece:
        """The piece that takes the others as arguments."""
        return self.pieces[self.anchor]

    @property
    def gaps(self) -> tuple[ConstructionGap, ...]:
        """The gaps whose meanings the term uses."""
        return tuple(
            each for each in self.pieces if isinstance(each, ConstructionGap) and each.name
        )

    @cached_property
    def category(self) -> Category:
        """The category of the head, or if that is a gap, the category that it changes to."""
        category = self.result
        for place in self._taken_last_first():
            forward = place > self.anchor
            category = Functor(category, self.pieces[place].category, forward)
        return category

    def functor(self) -> Term:
        """The term of the head, or if that is a gap, the function from its meaning to the term."""
        term = self.term
        for place in self._taken_last_first():
            term = _taking(self.pieces[place], term)
        return term if isinstance(self.head, WordRun) else _taking(self.head, term)

    def _taken_last_first(self) -> Iterator[int]:
        # The last argument taken is the innermost one of the category and of the term.
        yield from range(self.anchor)
        yield from range(len(self.pieces) - 1, self.anchor, -1)


def pieces_of(variant: Sequence[str], field: YamlNode) -> tuple[Piece, ...]:
    """The gaps and runs of words of a construction; `DataError` unless a gap is `{name:NP}`."""
    return tuple(_gap(text, field) if is_gap(text) else WordRun(text) for text in variant)


def _taking(piece: Piece, term: Term) -> Lambda:
    return bind(term, piece.name) if piece.name else Lambda(term, "s")


_GAP = re.compile(r"\{(?:(?P<name>\w+):)?(?P<category>\w+)\}")


def _gap(text: str, field: YamlNode) -> ConstructionGap:
    found = _GAP.fullmatch(text)
    if found is None:
        raise field.fail(f'expected a gap like {{x:NP}}, found "{text}".')
    return ConstructionGap(found["name"] or "", AtomicCategory(found["category"]))
