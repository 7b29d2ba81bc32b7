"""The result of an utterance: every stage, the JSON object, and failure messages."""

from __future__ import annotations

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.nlu import ActionRule, AskBack, Command, Language, Misunderstanding, Statement

SENTENCE = "To pass a knife grab the knife by the blade"
IMPLIES = "implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high)"


def test_the_json_has_every_stage(language: Language) -> None:
    """The JSON object has the keys that the documentation lists."""
    assert language.understand(SENTENCE).as_json() == {
        "text": SENTENCE,
        "speaker": "sam",
        "addressee": "self",
        "semantics": f"STATEMENT(sam,self,{IMPLIES})",
        "pragmatics": f"wantBelieve(sam,self,{IMPLIES})",
        "kind": "statement",
        "meaning": {
            "rule": "action",
            "object": "knife",
            "context": "pass",
            "part": "blade",
            "confidence": [0.95, 1.0],
        },
        "new_words": [],
        "readings": 1,
    }


@pytest.mark.parametrize(
    ("text", "pragmatics"),
    [
        ("pass me something used for cutting", "want(sam,pass(self,usedFor(something,cutting)))"),
        ("pound the nail", "want(sam,pound(self,nail))"),
        ("could you pass me the knife?", "want(sam,pass(self,knife))"),
        ("I need the knife", "want(sam,pass(self,knife))"),
        ("do not pass me the knife", "want(sam,not(pass(self,knife)))"),
        (
            "A knife is sometimes used for cutting",
            "wantBelieve(sam,self,implies(knife,cutting,mediumLow))",
        ),
        (
            "To pickup a knife grab it by the handle",
            "wantBelieve(sam,self,implies(pickUp(self,knife),"
            "graspObject(self,partOf(handle,knife)),high))",
        ),
    ],
)
def test_the_predicate_forms_are_the_papers(language: Language, text: str, pragmatics: str) -> None:
    """The predicate forms are those of sections 3.2, 3.3 and 4.2."""
    assert language.understand(text).pragmatics == pragmatics


def test_the_speaker_is_named(language: Language) -> None:
    """Predicate forms name the speaker."""
    understood = language.understand("I need the knife", speaker="evan")

    assert understood.semantics == "STATEMENT(evan,self,need(evan,knife))"


def test_the_goal_is_the_content_of_a_command(language: Language) -> None:
    """The goal submitted to the goal manager is a predicate form."""
    understood = language.understand("pass me something used for cutting")

    assert understood.content == "pass(self,usedFor(something,cutting))"


def test_the_derivation_shows_a_term_at_each_step(language: Language) -> None:
    """The derivation prints as an indented tree."""
    assert str(language.understand("pass me the knife").derivation).splitlines() == [
        "C : pass(self,knife)    CP => C",
        "  CP : pass(self,knife)    >",
        "    CP/NP : λx.pass(self,x)    >",
        '      (CP/NP)/ME : λx.λy.pass(self,y)    "pass"',
        '      ME : speaker    "me"',
        "    NP : knife    >",
        '      NP/N : λx.x    "the"',
        '      N : knife    "knife"',
    ]


def test_a_failure_has_the_longest_span_understood(language: Language) -> None:
    """A failure has the longest span, what was expected after it, and similar sentences."""
    meaning = language.understand("to pass a knife grab").meaning

    assert isinstance(meaning, Misunderstanding)
    assert meaning.where == "to pass a knife"
    assert any("how to hold it" in each for each in meaning.expected)
    assert "To pass a knife, grab the knife by the blade." in meaning.nearest


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "I didn't hear anything."),
        ("x" * 10_000, "That is too long for me. I can take in at most 2000 characters at a time."),
        ("the " * 41, "That is too long for me. I can take in at most 40 words at a time."),
        ("zorp me the knife", 'I don\'t know the word "zorp".'),
        (
            "to pass a knife grab the mug by the handle",
            "You mention a knife and a mug at once. Which one do you mean?",
        ),
        ("pass me the knife and the knife", "One thing at a time, please."),
    ],
)
def test_a_failure_has_a_message_for_the_speaker(
    language: Language, text: str, message: str
) -> None:
    """The message says in one sentence what is wrong."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Misunderstanding)
    assert meaning.message == message


def test_a_stated_question_teaches_nothing(language: Language) -> None:
    """A question mark makes a question of a statement, and asks back on a command."""
    assert language.understand("A knife is used for cutting?").kind == "question"
    assert isinstance(language.understand("Pass me the knife?").meaning, AskBack)


def test_it_is_what_was_spoken_of(language: Language) -> None:
    """Within a sentence, and over sentences."""
    first = language.understand("do you see the mug?")
    second = language.understand("to pick it up grab it by the handle", discourse=first.discourse)

    assert second.meaning == Statement((ActionRule("mug", "pickUp", "handle", (0.95, 1.0)),))


def test_it_without_anything_before_asks_back(language: Language) -> None:
    """Nothing is guessed."""
    assert language.understand("pass it to me").kind == "ask_back"


@settings(max_examples=300, deadline=None)
@given(st.text(max_size=300))
def test_any_text_is_taken(language: Language, text: str) -> None:
    """No text makes the language part fail, and none of these means anything."""
    understood = language.understand(text)

    json.dumps(understood.as_json())
    assert understood.kind not in {"command", "correction"}


@pytest.mark.parametrize(
    "text", ["A knife, not a spoon, is used for cutting", "Use a knife for cutting, not a spoon"]
)
def test_what_is_set_against_another_is_denied(language: Language, text: str) -> None:
    """The one is used for it, of the other it is never so."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Statement)
    assert [(rule.object, rule.confidence) for rule in meaning.rules] == [
        ("knife", (0.95, 1.0)),
        ("spoon", (0.0, 0.05)),
    ]


@pytest.mark.parametrize(
    "text",
    [
        "To pass a knife grab it by the blade and never grab it by the handle",
        "To pass a knife grab it by the blade and never by the handle",
    ],
)
def test_two_holds_are_for_the_same_act(language: Language, text: str) -> None:
    """What the first clause names is the occasion of both."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Statement)
    assert [
        (rule.context, rule.part) for rule in meaning.rules if isinstance(rule, ActionRule)
    ] == [("pass", "blade"), ("pass", "handle")]


def test_a_degree_is_not_carried_over_to_another_rule(language: Language) -> None:
    """One that stands in the second clause says nothing of the first."""
    meaning = language.understand(
        "Knives are for cutting while spoons are rarely for poking"
    ).meaning

    assert isinstance(meaning, Statement)
    assert [rule.confidence for rule in meaning.rules] == [(0.95, 1.0), (0.0, 0.25)]


@pytest.mark.parametrize("text", ["Pick up the big bowl.", "A bowl is used for mixing."])
def test_a_part_that_names_things_too_is_one_where_no_part_fits(
    language: Language, text: str
) -> None:
    """Bowls are things, unlike handles, which are always those of something."""
    assert isinstance(language.understand(text).meaning, (Command, Statement))
    assert isinstance(language.understand(text.replace("bowl", "handle")).meaning, AskBack)


def test_the_part_of_what_was_spoken_of_is_no_thing_of_its_own(language: Language) -> None:
    """What is said of "the bowl" may be said of that of the spoon."""
    assert isinstance(language.understand("The bowl is used for mixing.").meaning, AskBack)
