"""Meanings as values and as JSON."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hilt.nlu import (
    Acknowledgement,
    ActionRule,
    AskBack,
    Command,
    FunctionalRule,
    Meaning,
    Misunderstanding,
    ObjectReference,
    Question,
    Retraction,
    Statement,
    ToolCommand,
)
from hilt.nlu.semantics.meaning import is_contradictory

RULE = FunctionalRule("knife", "cutting", (0.95, 1.0))
RIM = ActionRule("mug", "pass", "rim", (0.95, 1.0))
NEVER = (0.0, 0.05)
RULE_JSON = {
    "rule": "functional", "object": "knife", "affordance": "cutting", "confidence": [0.95, 1.0],
}  # fmt: skip


@pytest.mark.parametrize(
    ("meaning", "kind", "json"),
    [
        (Statement((RULE,)), "statement", RULE_JSON),
        (Statement((RULE, RULE)), "statement", {"all": [RULE_JSON, RULE_JSON]}),
        (
            Statement((ActionRule("mug", "pass", "rim", (0.5, 1.0), ("red",), revises=True),)),
            "correction",
            {"rule": "action", "object": "mug", "context": "pass", "part": "rim",
             "confidence": [0.5, 1.0], "props": ["red"], "revises": True},
        ),
        (
            Command("pass", ObjectReference(used_for="cutting"), "blade", "bob", negated=True),
            "command",
            {"goal": "pass", "target": {"usedFor": "cutting"}, "part": "blade",
             "recipient": "bob", "negated": True},
        ),
        (
            ToolCommand("pound", "nail", ObjectReference(object="hammer")),
            "command",
            {"goal": "pound", "patient": "nail", "tool": {"object": "hammer"}},
        ),
        (Question("how", object="mug", context="pass"), "question",
         {"ask": "how", "object": "mug", "context": "pass"}),
        (Retraction(), "correction", {"retract": "last"}),
        (Retraction(RULE), "correction", {"retract": RULE_JSON}),
        (Acknowledgement("thanks"), "acknowledgement", {"ack": "thanks"}),
        (AskBack("Which one?", ("a", "b")), "ask_back", {"ask_back": True}),
        (
            Misunderstanding("No.", "to pass", ("an object",), ("Pass me the knife.",)),
            "error",
            {"error": True, "message": "No.", "where": "to pass", "expected": ["an object"],
             "nearest": ["Pass me the knife."]},
        ),
    ],
)  # fmt: skip
def test_a_meaning_has_its_kind_and_json(
    meaning: Meaning, kind: str, json: dict[str, object]
) -> None:
    """Key for key as the schema says; nothing that is not meant."""
    assert meaning.kind == kind
    assert meaning.as_json() == json


@pytest.mark.parametrize(
    "wrong", [{}, {"object": "knife", "used_for": "cutting"}, {"props": ("red",)}]
)
def test_a_target_is_one_thing(wrong: dict[str, object]) -> None:
    """Either an object, or a use it has, or a use it has not."""
    with pytest.raises(ValueError, match="exactly one"):
        ObjectReference(**wrong)  # type: ignore[arg-type]


@pytest.mark.parametrize("context", ["pass", "grasp"])
def test_the_same_grip_and_never_is_a_contradiction(context: str) -> None:
    """Whether the action is repeated or not: "to pass it grab the rim and never grab the rim"."""
    assert is_contradictory((RIM, replace(RIM, context=context, confidence=NEVER)))


@pytest.mark.parametrize(
    "rules",
    [
        (RIM, replace(RIM, context="pickUp", confidence=NEVER)),
        (RIM, replace(RIM, part="handle", confidence=NEVER)),
        (replace(RIM, context="grasp", confidence=NEVER), RIM),
        (RULE, replace(RULE, material="bread", confidence=NEVER)),
        (RIM, replace(RIM, context="grasp")),
    ],
)
def test_exceptions_are_no_contradictions(rules: tuple[ActionRule | FunctionalRule, ...]) -> None:
    """Another action, part or material, and what restricts a general rule said before."""
    assert not is_contradictory(rules)
