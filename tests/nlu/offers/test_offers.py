"""Offers for what is not understood: which meanings, and what keeps one from being offered."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.nlu import Language, Session
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.semantics.discourse import Discourse
from hilt.nlu.semantics.meaning import (
    AskBack,
    FunctionalRule,
    Meaning,
    NormStatement,
    Question,
    Statement,
)


def offered(language: Language, text: str) -> tuple[Meaning | str, ...]:
    """The meanings that are offered for an utterance."""
    understood = language.understand(text)
    assert isinstance(understood.meaning, AskBack)
    return understood.meaning.choices


def test_an_offer_is_a_meaning_that_is_asked_about(language: Language) -> None:
    """Nothing is believed or done: the meaning is a question back with the choice."""
    found = language.understand("pas me somthing usd for cutting").meaning.as_json()

    assert found == {
        "ask_back": True,
        "choices": [{"goal": "pass", "target": {"usedFor": "cutting"}}],
    }


def test_an_offer_is_understood_as_its_speaker_says_it(language: Language) -> None:
    """What Kim asks about herself at the end is a question about Kim."""
    found = language.understand("So there we are. What have I told you?", speaker="kim")

    assert found.meaning.as_json() == {"ask": "told", "speaker": "kim"}


@pytest.mark.parametrize(
    "text",
    [
        "I can't reach the spoon, so you'll have to pass me the spoon.",
        "You'll have to pass me the knife because I can't reach the knife.",
        "We haven't got the hammer over here, so you will have to hand me the hammer.",
        "Nobody can find the mug, so you'd have to pick up the mug.",
    ],
)
def test_reason_that_is_negative_turns_no_sign(language: Language, text: str) -> None:
    """What is asked for after "I can't reach it" is not forbidden."""
    choices = getattr(language.understand(text).meaning, "choices", ())

    assert not [each for each in choices if getattr(each, "negated", False)]


def test_command_that_is_negative_itself_is_offered_so(language: Language) -> None:
    """A negation in the clause of the act forbids it."""
    found = offered(language, "I don't know, whatever you do never pass the spoon over there.")

    assert {getattr(each, "negated", False) for each in found} == {True}


@pytest.mark.parametrize("text", ["her wants it, mug pass to her", "spoon hand him would you now"])
def test_offer_keeps_who_gets_something(language: Language, text: str) -> None:
    """Nothing is passed to the speaker that is for somebody else."""
    assert not getattr(language.understand(text).meaning, "choices", ())


def test_a_denial_is_said_aloud(language: Language) -> None:
    """The sign is in capitals, so that nobody says yes to its opposite."""
    understood = language.understand("a spoon iz nevr usd for cutting")

    assert isinstance(understood.meaning, AskBack)
    assert "NEVER used for cutting" in understood.meaning.question


@pytest.mark.parametrize(
    "text",
    [
        "my neighbour passes knives by the blade",
        "when you pass a fork, praise the handle",
        "grab the knife by the",
        "a spoon a spoon is is cutting",
        "they say shoes pounding is for",
        "unless a shoe, pounding never",
        "we used to pass a knife by the blade back home",
        "when my boss is looking, a mug gets picked up by the handle",
        "round here we grabbed the glass by the bowl",
        "a spoon is used for stirring, apart from the silver ones",
    ],
)
def test_nothing_is_offered_that_loses_a_word_that_matters(language: Language, text: str) -> None:
    """A doer, a source, an exception, another verb, half a sentence."""
    assert not getattr(language.understand(text).meaning, "choices", ())


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("The head is what one often held when passing hammers.", "hammer"),
        ("The hammer, over there on the left, I'd like you to lift that for me.", "hammer"),
        ("Sling that mug over here to me, would you.", "mug"),
        ("Stirring, everybody, that is what the spoon is all about.", "spoon"),
    ],
)
def test_what_is_named_decides_what_is_offered(language: Language, text: str, meant: str) -> None:
    """A verb of holding in any form, a place, a wish and a word behind a pause are in no way."""
    assert meant in language.generate(offered(language, text)[0])  # pyright: ignore


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("pas me teh mug", "pass me the mug"),
        ("to pas a knife grab it by teh blade", "to pass a knife, grab it by the blade"),
        ("pick upp the mug", "pick up the mug"),
    ],
)
def test_typing_slips_are_offered_corrected(language: Language, text: str, meant: str) -> None:
    """Nothing is done before a yes."""
    first = offered(language, text)[0]

    assert not isinstance(first, str)
    assert language.generate(first) == meant


def test_every_offer_is_understood_as_itself(language: Language) -> None:
    """The sentence of an offer has its meaning."""
    for choice in offered(language, "pas me somthing usd for cutting"):
        assert not isinstance(choice, str)
        assert language.understand(language.generate(choice)).meaning == choice


@pytest.mark.parametrize(
    "text", ["Give me a break.", "Pick up the pace.", "To pick up a mug, grab it by the window."]
)
def test_what_is_no_thing_and_no_part_is_not_offered(language: Language, text: str) -> None:
    """A noun is offered as a new thing or part only if it can be one."""
    assert offered(language, text) == ()


def test_one_of_two_rules_is_denied_as_it_was_said(language: Language) -> None:
    """The rule whose use follows the negation is denied, and no other."""
    checks = language.offers.checks
    tokens = tokenize("not for cutting goes the spoon, for stirring", language.builder.contractions)
    mentions = language.offers.mentions(tokens, Discourse())
    stirring, cutting = (
        FunctionalRule("spoon", use, (0.95, 1.0)) for use in ("stirring", "cutting")
    )
    denied = replace(cutting, confidence=(0.0, 0.05))

    assert checks.lost(Statement((denied, stirring)), mentions, ()) == ()
    other = Statement((cutting, replace(stirring, confidence=(0.0, 0.05))))
    assert "scope" in checks.lost(other, mentions, ())


@pytest.mark.parametrize(
    ("text", "number"),
    [
        ("1", 1),
        ("one", 1),
        ("the first", 1),
        ("the first one, please", 1),
        ("number two", 2),
        ("I meant the second one", 2),
        ("the last one", 3),
        ("neither", 0),
        ("none of them", 0),
        ("never mind", 0),
        ("pass me the mug", None),
        ("yes", None),
        ("4", None),
        ("the first or the second", None),
    ],
)
def test_an_answer_takes_a_choice(language: Language, text: str, number: int | None) -> None:
    """A number, an ordinal or a refusal; anything else is a new utterance."""
    assert language.chosen(text, 3) == number


def test_likely_question_is_answered_at_once(language: Language) -> None:
    """Its answer believes and does nothing."""
    asked = language.understand("What would you say people use a screwdriver for?")

    assert asked.meaning == Question("uses_of", "screwdriver")


def test_norms_are_offered(language: Language) -> None:
    """As a sentence that is understood as a norm."""
    text = "Should you feel like picking up the shoe, that is allowed."

    assert any(isinstance(each, NormStatement) for each in offered(language, text))


def test_contrast_in_one_breath_denies_the_first_only(language: Language) -> None:
    """What "a hammer is" says is the opposite of what was denied before it."""
    found = language.understand("A spoon is not used for pounding, a hammer is").meaning

    assert isinstance(found, Statement)
    assert [(rule.object, rule.denies) for rule in found.rules] == [
        ("spoon", True),
        ("hammer", False),
    ]


@pytest.mark.parametrize(
    ("text", "meant"),
    [
        ("True story. A spoon is used for stirring.", "a spoon is used for stirring"),
        ("My uncle was a butcher. A knife is for cutting.", "a knife is used for cutting"),
        ("Nobody, and I mean nobody, ever uses a glass for pounding.", "never"),
    ],
)
def test_the_one_sentence_that_says_something_is_offered(
    language: Language, text: str, meant: str
) -> None:
    """Sentences beside it that take nothing back are left aside; denials in a row agree."""
    assert meant in language.generate(offered(language, text)[0])  # pyright: ignore


@pytest.mark.parametrize(
    "text",
    [
        "A knife is for cutting. I was only dreaming.",
        "A knife is for cutting. They say so in a song that goes on.",
        "A shoe is not for that. A shoe is for walking, they say.",
    ],
)
def test_a_sentence_is_not_offered_beside_one_that_changes_it(
    language: Language, text: str
) -> None:
    """Beside one that takes it back, has it from others or denies it."""
    found = language.understand(text).meaning

    assert found.kind in {"error", "ask_back"}
    assert not getattr(found, "choices", ())


def test_question_that_its_speaker_answers_is_not_answered(language: Language) -> None:
    """What is said after it is the answer."""
    found = language.understand("What's a mug good for? Containing, of course.").meaning

    assert not isinstance(found, Question)


def test_question_at_the_end_is_answered_whatever_goes_before(language: Language) -> None:
    """An answer believes and does nothing."""
    found = language.understand("One more. The screwdriver, what's it for?").meaning

    assert found == Question("uses_of", "screwdriver")


def test_the_other_one_of_nothing_is_asked_about(language: Language) -> None:
    """A question needs a thing to be about."""
    assert isinstance(language.understand("Where would you hold the other one?").meaning, AskBack)


def test_just_kidding_takes_back(language: Language) -> None:
    """What was told last."""
    found, _ = Session(language).after(("A spoon is used for digging",)).hear("Just kidding.")

    assert found.meaning.as_json() == {"retract": "last"}


def test_a_fragment_beside_a_question_is_no_rule(language: Language) -> None:
    """Who asks what the spatula is for does not teach how it is held."""
    session = Session(language).after(("A ladle is held by the handle, never by the bowl.",))
    found, _ = session.hear("And the spatula over there, do you have any idea what that's for?")
    meant = found.meaning.choices if isinstance(found.meaning, AskBack) else (found.meaning,)
    assert meant
    assert not any(isinstance(each, Statement) for each in meant)
