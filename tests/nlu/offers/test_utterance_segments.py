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
    "before",
    [
        "My dear friend, look here, ",
        "When we lived by the sea nobody had one; now, ",
        "You were clever to ask, ",
    ],
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
        "My cousin swears that a knife is used for cutting",
        "It is possible that a knife is used for cutting",
        "When the lamp is green, a knife is used for cutting",
        "In our village by the sea, a knife is used for cutting",
        "The card on the wall reads: a knife is used for cutting",
        "Oh great, a knife is used for cutting, and I am the king of Spain",
    ],
)
def test_words_that_change_a_meaning_are_not_left_out(language: Language, text: str) -> None:
    """A negation, an exception or another source beside it is part of what is said."""
    rule = language.understand("a knife is used for cutting").meaning

    assert rule not in offered(language, text)


def test_it_is_the_one_thing_named_before_a_segment(language: Language) -> None:
    """Of several things before it, or of none that is known, nothing is offered."""
    rule = language.understand("a mug is used for containing").meaning

    assert offered(language, "Folks ask me what a mug does all day: it is used for containing") == (
        rule,
    )
    assert not offered(
        language, "Folks with mugs and knives ask me a lot: it is used for containing"
    )


def test_what_differs_from_the_last_rule_corrects_it(language: Language) -> None:
    """The same thing and use with another degree is a correction, another thing is none."""
    before = language.understand("a spoon is used for cutting").discourse
    found = language.understand(
        "Hang on, I went too far there, lads: a spoon is rarely used for cutting", discourse=before
    ).meaning

    assert isinstance(found, AskBack)
    (choice,) = found.choices
    assert isinstance(choice, Statement)
    assert choice.rules[0].revises
