"""Utterances of several segments."""

from __future__ import annotations

import json

import pytest

from hilt.nlu import Language


def _used(name: str, use: str) -> dict[str, object]:
    confidence = [0.95, 1.0]
    return {"rule": "functional", "object": name, "affordance": use, "confidence": confidence}


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("That hammer, could I have it?", {"goal": "pass", "target": {"object": "hammer"}}),
        ("See the mug? Pick it up.", {"goal": "pickUp", "target": {"object": "mug"}}),
        ("Hello there. Pass me the mug. Thanks!", {"goal": "pass", "target": {"object": "mug"}}),
        ("Yes. That's it. Thank you.", {"ack": "yes"}),
        ("Scratch that, I was wrong.", {"retract": "last"}),
        (
            "A knife is used for cutting, and a spoon, that is for containing.",
            {"all": [_used("knife", "cutting"), _used("spoon", "containing")]},
        ),
    ],
)
def test_segments_have_one_meaning_together(language: Language, text: str, meaning: object) -> None:
    """Segments before or after the main segment do not change its meaning."""
    assert json.loads(json.dumps(language.understand(text).meaning.as_json())) == meaning


@pytest.mark.parametrize(
    "text",
    [
        "The hammer, pass me the mug.",
        "Pass me the knife. No!",
        "Yes. No.",
        "Sam said, pass me the knife.",
        "See the mug? Pick up the knife.",
        "It rains, pass me the knife.",
    ],
)
def test_segments_without_one_meaning_are_rejected(language: Language, text: str) -> None:
    """No segment is acted on when another one is not understood or contradicts it."""
    assert language.understand(text).kind in {"error", "ask_back"}


def test_statements_are_combined(language: Language) -> None:
    """Two sentences teach two rules, and the second may speak of the first."""
    understood = language.understand("Knives are for cutting. They are passed by the blade.")

    meaning = understood.meaning.as_json()

    assert [rule["object"] for rule in meaning["all"]] == ["knife", "knife"]  # type: ignore[index,union-attr]


@pytest.mark.parametrize("text", ["Do not. Pass me the knife.", "never, pass me the knife"])
def test_a_pause_does_not_lose_a_negation(language: Language, text: str) -> None:
    """A negation that a pause separates from its verb still forbids."""
    assert language.understand(text).meaning.as_json()["negated"] is True
