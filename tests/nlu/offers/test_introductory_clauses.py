# SPDX-License-Identifier: Apache-2.0
"""Introductions: which clauses let the last one be offered, and on which ones it depends."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.parsing.parser import UtteranceContext
from hilt.nlu.semantics.coreference import Discourse
from hilt.nlu.semantics.meaning import Meaning


def of_last_clause(language: Language, text: str) -> tuple[Meaning, ...]:
    """What is offered for an utterance because its other clauses only introduce the last one."""
    context = UtteranceContext("sam", "self", Discourse())
    mentions = language.offers.mentions(tokenize(text, language.builder.contractions), Discourse())
    return language.offers.of_last_clause(mentions, context)


@pytest.mark.parametrize(
    ("introduction", "last"),
    [
        ("We never spoke of it, but", "a spoon is used for stirring"),
        ("I was young and proud once, so I laughed at it;", "a fork is sometimes used for poking"),
        ("My aunt says I talk all day, and I go on:", "when you pass a knife, grab the blade"),
        ("You often forget what we agreed on:", "to pick up a pan, grab it by the handle"),
        ("You won't reach the shelf with a mug, so", "pass me the spoon"),
        ("This tin will not open, so", "give me something that is used for cutting"),
    ],
)
def test_what_an_introduction_has_for_itself_is_no_part_of_the_meaning(
    language: Language, introduction: str, last: str
) -> None:
    """A doer, a time, a negation, a degree, and what is named there."""
    (offered,) = of_last_clause(language, f"{introduction} {last}")

    assert offered == language.understand(last).meaning


@pytest.mark.parametrize(
    "text",
    [
        "If I ever come back, a knife is passed by the blade",
        "Once you hear me whistle, pass me the mug",
        "The label of the box says: a spoon is used for stirring",
        "I heard about it: shoes are used for pounding",
        "I would not say so: a mug is used for cutting",
        "I do not believe it: a spoon is used for cutting",
        "You must be joking, a spoon is used for flying",
        "After nine in the evening, a bottle is passed by the neck",
        "I told you to take the mug, pass me the spoon",
        "You know it, and a spoon is used for stirring",
        "As we know it, a fork is used for poking, right?",
    ],
)
def test_a_last_clause_that_depends_on_others_is_not_offered(language: Language, text: str) -> None:
    """A condition, a report, a denial, a joke, a time without a clause, another thing, a tag."""
    assert not of_last_clause(language, text)
