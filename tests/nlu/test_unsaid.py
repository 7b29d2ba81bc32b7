"""What nobody said is not believed and not done: families of utterances, each with near twins.

What one time, one person, one condition or another speaker is said of gives no rule, no command and
no retraction; its near twins must still be understood.
"""

from __future__ import annotations

import json
from pathlib import Path

import pytest
import yaml

from hilt.nlu import Command, Language, Retraction, Statement, ToolCommand
from hilt.nlu.semantics.meaning import Plan

FAMILIES: dict[str, dict[str, list[object]]] = yaml.safe_load(
    (Path(__file__).parent / "data" / "unsaid.yaml").read_text(encoding="utf-8")
)
MOST_LOST = 0.03
"""The greatest share of near twins that are asked about or refused."""


@pytest.mark.parametrize("family", FAMILIES)
def test_what_nobody_said_is_neither_believed_nor_done(language: Language, family: str) -> None:
    """No utterance of a family gives a rule, a command that is carried out, or a retraction."""
    found = {
        str(text): language.understand(str(text)).meaning for text in FAMILIES[family]["unsaid"]
    }

    taken = {
        text: meaning
        for text, meaning in found.items()
        if isinstance(meaning, (Statement, Retraction, Plan))
        or (isinstance(meaning, (Command, ToolCommand)) and not meaning.negated)
    }
    assert not taken


def test_near_twins_are_understood(language: Language) -> None:
    """Of the near twins at most 3 % are not understood at once, and none wrongly."""
    cases = [(str(each[0]), _wanted(*each[1:])) for f in FAMILIES.values() for each in f["said"]]

    found = [(text, json.loads(json.dumps(_meaning(language, text))), want) for text, want in cases]
    failed = [
        (text, meaning) for text, meaning, want in found if not want.items() <= meaning.items()
    ]
    wrong = [each for each in failed if not each[1].keys() & {"error", "ask_back"}]
    assert not wrong
    assert len(failed) <= MOST_LOST * len(cases), failed


def _meaning(language: Language, text: str) -> dict[str, object]:
    return language.understand(text).meaning.as_json()


def _wanted(*rest: object) -> dict[str, object]:
    """The meaning of a near twin: as it is, or a rule from its fields."""
    match rest:
        case (dict() as meaning,):
            return meaning
        case (thing, use, float() | int() as lower, upper):
            named = {"rule": "functional", "object": thing, "affordance": use}
        case (thing, act, part, lower, upper):
            named = {"rule": "action", "object": thing, "context": act, "part": part}
        case _:
            raise ValueError(f"{rest} is neither a meaning nor a rule")
    return {**named, "confidence": [lower, upper]}
