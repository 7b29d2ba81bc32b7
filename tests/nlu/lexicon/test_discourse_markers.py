# SPDX-License-Identifier: Apache-2.0
"""What is said by the way adds nothing, and nothing else is ever left out."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.nlu import Language
from hilt.nlu.lexicon.discourse_markers import DiscourseMarkers, move_to_front
from hilt.nlu.lexicon.tokenizer import BREAK, tokenize
from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import Field


def discourse_markers(kind: str, *patterns: str) -> DiscourseMarkers:
    """Asides of one kind."""
    items = tuple(Field(pattern, "<text>", 1, 1) for pattern in patterns)
    return DiscourseMarkers().with_phrases(kind, Field(items, "<text>", 1, 1))


def said(text: str, known: DiscourseMarkers, *whole: str) -> str:
    """A text without its asides."""
    kept = {tuple(phrase.split()) for phrase in whole}
    return " ".join(known.remove_markers(tokenize(text, {}), kept).words)


def test_an_aside_adds_nothing_anywhere() -> None:
    """It may stand between any two words."""
    known = discourse_markers("anywhere", "you know", "really")

    assert said("Knives are, you know, really for cutting", known) == "knives are for cutting"


def test_an_aside_in_a_fixed_phrase_stays() -> None:
    """The word "ever" is part of "hardly ever"."""
    known = discourse_markers("anywhere", "ever")

    assert said("hardly ever, if ever", known, "hardly ever") == "hardly ever if"


def test_what_needs_pauses_is_kept_without_them() -> None:
    """The word "right" is an aside in "right, pass it", not in "the right end"."""
    known = discourse_markers("apart", "right")

    assert said("right, hold the right end", known) == "hold the right end"


def test_a_reason_is_set_aside_up_to_a_pause() -> None:
    """A star stands for one word, but never for "not"."""
    known = discourse_markers("clauses", "because it is *")

    assert said("because it is sharp, use it", known) == "use it"
    assert said("because it is not, use it", known) == "because it is not use it"


def test_what_is_asked_for_comes_after_a_reason() -> None:
    """It is kept when it is hearsay, or when "it" may stand for what it names."""
    known = replace(
        discourse_markers("reasons", "the * * so"),
        doubts=frozenset({("said",)}),
        stand_ins=frozenset({("it",)}),
    )

    def after(text: str) -> str | None:
        rest = known.after_reason(tokenize(text, {}))
        return " ".join(rest.words) if rest else None

    assert after("the soup boils, so pass the mug") == "pass the mug"
    assert after("the boss said so, so pass the mug") is None
    assert after("the soup boils, so pass it") is None


@pytest.mark.parametrize(("kind", "asks"), [("asking", True), ("telling", False)])
def test_a_tag_makes_a_question_or_does_not(kind: str, asks: bool) -> None:
    """A tag like "right?" asks, one like "okay?" does not."""
    known = discourse_markers(kind, "tag")

    found = known.remove_tag(tokenize("knives cut, tag?", {}))

    assert (found.words, found.asks) == (("knives", "cut"), asks)


def test_a_pause_may_end_a_sentence() -> None:
    """The two sentences "forget that, ..." are not the one "forget that ..."."""
    known = discourse_markers("ending", "forget that")

    assert known.mark_boundaries(tokenize("forget that, it cuts", {})).words[2] == BREAK
    assert known.mark_boundaries(tokenize("forget that it cuts", {})).words[2] == "it"


def test_what_is_begun_twice_is_said_once() -> None:
    """Only with a pause between the two: doubled words are a mistake."""
    known = discourse_markers("anywhere", "really")

    assert said("you can, you can cut", known) == "you can cut"
    assert said("you can you can cut", known) == "you can you can cut"


def test_one_adverb_may_go_to_the_front() -> None:
    """Where there are two, neither moves."""
    often = {("often",)}

    one = move_to_front(tokenize("you often cut", {}), often)

    assert one is not None
    assert one.words == ("often", "you", "cut")
    assert move_to_front(tokenize("you often cut often", {}), often) is None


def test_an_unknown_kind_is_refused() -> None:
    """The message lists the kinds."""
    with pytest.raises(DataError, match="anywhere"):
        discourse_markers("nowhere", "really")


@pytest.mark.parametrize("word", ["not", "never", "if", "unless", "said", "yesterday", "no"])
def test_words_that_change_a_meaning_are_no_asides(language: Language, word: str) -> None:
    """Nobody may declare them to be empty."""
    known = language.builder.discourse_markers

    assert (word,) not in known.anywhere | known.apart


@pytest.mark.parametrize(
    "text", ["really.", "you know. really. of course", "well; really; so?", "please!"]
)
def test_nothing_but_asides_says_nothing(language: Language, text: str) -> None:
    """What is left then is no utterance."""
    assert language.understand(text).kind in {"error", "acknowledgement"}
