# SPDX-License-Identifier: Apache-2.0
"""Conversations that are kept nowhere."""

from __future__ import annotations

import pytest

from hilt.nlu import AskBack, Language, Session


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("pass me the saw", {"goal": "pass", "target": {"object": "saw"}}),
        ("pass it to me", {"goal": "pass", "target": {"object": "saw"}}),
        ("pass me something to slice with", {"goal": "pass", "target": {"usedFor": "slicing"}}),
        ("what slices?", {"ask": "objects_for", "affordance": "slicing"}),
        ("slice the bread", {"goal": "slice", "patient": "bread", "tool": {"usedFor": "slicing"}}),
    ],
)
def test_words_are_usable_once_they_were_taught(
    language: Language, text: str, meaning: object
) -> None:
    """In every form: plural, gerund, infinitive, as an act."""
    session = Session(language).after(["A saw is used for slicing."])

    understood, _ = session.hear(text)

    assert understood.meaning.as_json() == meaning


def test_what_is_heard_changes_no_other_session(language: Language) -> None:
    """A session is a value."""
    before = Session(language)

    before.after(["A saw is used for slicing."])

    assert before.hear("pass me the saw")[0].unknown == ("saw",)


@pytest.mark.parametrize(
    ("text", "lower"),
    [("No wait, only sometimes.", 0.5), ("no, never", 0.0), ("I meant often", 0.75)],
)
def test_a_degree_is_corrected(language: Language, text: str, lower: float) -> None:
    """The last rule keeps its object and use."""
    session = Session(language).after(["A shoe is used for pounding."])

    rule = session.hear(text)[0].meaning.as_json()

    assert (rule["object"], rule.get("revises")) == ("shoe", True)
    assert rule["confidence"][0] == lower  # type: ignore[index]


def test_a_rule_is_carried_over(language: Language) -> None:
    """It may be said that the same goes for another object."""
    session = Session(language).after(["A shoe is often used for pounding."])

    rule = session.hear("The same goes for mugs.")[0].meaning.as_json()

    assert rule == {
        "rule": "functional",
        "object": "mug",
        "affordance": "pounding",
        "confidence": [0.75, 1.0],
    }


def test_a_slip_is_asked_about_whatever_else_the_word_could_be(language: Language) -> None:
    """After "saw" was learned, "knive" could be a part of it too; still it looks like "knife"."""
    session = Session(language).after(["A saw is used for slicing."])

    meaning = session.hear("A knive is used for cutting")[0].meaning

    assert isinstance(meaning, AskBack)
    assert meaning.choices == ("knife",)
