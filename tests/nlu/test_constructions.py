# SPDX-License-Identifier: Apache-2.0
"""Turns of phrase as entries of a categorial grammar."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.constructions import Construction, Gap, Run, pieces
from hilt.nlu.notation import read_entry
from hilt.nlu.patterns import Group, factored
from hilt.ontology.errors import DataError
from hilt.ontology.source import Field


def field(text: str) -> Field:
    """A text as it would stand in a file."""
    return Field(text, "<text>", 1, 1)


def construction(says: str, means: str) -> Construction:
    """The one construction of a pattern without choices."""
    category, term, _ = read_entry(field(means))
    return Construction(pieces(says.split(), field(says)), category, term)


def test_the_first_words_take_the_gaps() -> None:
    """What stands before them is sought to the left, the rest to the right."""
    found = construction("{a:K} is a job for {x:NP}", "R : λq.implies(x,a,q)")

    category, term = found.functor()

    assert found.head == Run(("is", "a", "job", "for"))
    assert (str(category), str(term)) == (r"(R\K)/NP", "λx.λa.λq.implies(x,a,q)")


def test_later_words_are_arguments_without_meaning() -> None:
    """They only have to be there."""
    found = construction("take {x:NP} for {a:K}", "R : λq.implies(x,a,q)")

    category, term = found.functor()

    assert str(category) == '((R/K)/"for")/NP'
    assert str(term) == "λx.λs.λa.λq.implies(x,a,q)"


def test_gaps_alone_change_the_first_one_without_a_name() -> None:
    """A construction without words of its own is a change of category."""
    found = construction("{x:NP} {GOOD} {a:FU}", "R : λq.implies(x,a,q)")

    assert isinstance(found.head, Gap)
    assert str(found.functor()[0]) == r"(R\NP)/FU"


def test_many_choices_stay_one_group() -> None:
    """So that several of them in one line do not multiply."""
    many = "(a|b|c|d|e|f|g|h)"

    (found,) = factored(field(f"{many} x {many}"))

    assert [type(piece) for piece in found] == [Group, str, Group]


@pytest.mark.parametrize("gap", ["{x:", "{x:}", "{:NP}x", "{}"])
def test_a_wrong_gap_is_refused(gap: str) -> None:
    """The message shows what a gap looks like."""
    with pytest.raises(DataError, match="expected a gap like"):
        pieces([gap], field(gap))


@pytest.mark.parametrize(
    "text",
    [
        "Cutting is a job for a knife",
        "Nothing beats a knife for cutting",
        "It's a knife you reach for when something needs cutting",
        "When it's cutting you want, a knife does the trick",
        "What knives do best is cutting",
    ],
)
def test_a_turn_of_phrase_means_what_plain_words_do(language: Language, text: str) -> None:
    """One rule, however it is put."""
    plain = language.understand("A knife is used for cutting").meaning

    assert language.understand(text).meaning == plain
