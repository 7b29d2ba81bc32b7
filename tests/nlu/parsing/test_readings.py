"""The scope of "no": it negates a thing, or corrects what was said before."""

from __future__ import annotations

import pytest

from hilt.nlu import Language, Session, Statement


@pytest.mark.parametrize(
    "text",
    [
        "no mug should be passed by the handle",
        "no spoon can be used for cutting",
        "No knives must be used for pounding.",
        "no saw is ever used for pounding",
        "no knife is used for cutting",
        "no mugs get passed by the handle",
        "No object should ever be passed by the handle.",
    ],
)
def test_no_before_a_thing_makes_a_negative_rule(language: Language, text: str) -> None:
    """Without a pause, "no" is the determiner of the thing."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Statement)
    assert [rule.confidence for rule in meaning.rules] == [(0.0, 0.05)]


@pytest.mark.parametrize("text", ["No, knives are used for cutting.", "No, a saw is for cutting."])
def test_no_before_a_pause_is_a_correction(language: Language, text: str) -> None:
    """With a pause, "no" refers to what was said before."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Statement)
    assert [rule.confidence for rule in meaning.rules] == [(0.95, 1.0)]


@pytest.mark.parametrize("text", ["pass me no knife", "to pass no knife grab it by the blade"])
def test_a_positive_rule_about_no_thing_is_rejected(language: Language, text: str) -> None:
    """No rule about "no knife" is taken for one about "a knife"."""
    assert language.understand(text).kind in {"error", "ask_back"}


@pytest.mark.parametrize(
    "text", ["Anything for stirring, fast.", "A shoe is no good for pounding, nails."]
)
def test_gerund_takes_no_material_after_a_pause(language: Language, text: str) -> None:
    """What follows a pause is not what something is done to."""
    assert language.understand(text).kind in {"error", "ask_back"}


def test_nothing_is_told_after_a_question_of_ones_own(language: Language) -> None:
    """The rest of a question is no statement."""
    session = Session(language).after(("What do you know about the knife?",))

    understood, _ = session.hear("Well, do you think it is? Used for spreading, I mean.")

    assert understood.kind in {"error", "ask_back"}
