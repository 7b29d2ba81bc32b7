# SPDX-License-Identifier: Apache-2.0
"""Segments of an utterance that are offered as all that it means."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.semantics.meaning import AskBack, Meaning, Statement


def offered(language: Language, text: str) -> tuple[Meaning, ...]:
    """The meanings that are offered for a text."""
    meaning = language.understand(text).meaning
    return meaning.choices if isinstance(meaning, AskBack) else ()


@pytest.mark.parametrize(
    "before", ["gonna teach you something now: ", "My dear friend, look here, "]
)
def test_what_stands_after_a_pause_is_offered(language: Language, before: str) -> None:
    """Nothing before it changes what it means."""
    rule = language.understand("a knife is used for cutting").meaning
    assert isinstance(rule, Statement)

    assert offered(language, f"{before}a knife is used for cutting") == (rule,)


@pytest.mark.parametrize(
    "text",
    [
        "nobody here believes this: a knife is used for cutting",
        "unless it is Sunday in town, a knife is used for cutting",
        "I read it in the papers, a knife is used for cutting",
    ],
)
def test_words_that_change_a_meaning_are_not_left_out(language: Language, text: str) -> None:
    """A negation, an exception or another source beside it is part of what is said."""
    rule = language.understand("a knife is used for cutting").meaning

    assert rule not in offered(language, text)
