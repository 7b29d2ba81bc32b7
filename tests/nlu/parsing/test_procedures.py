"""Several steps in order: plans, and actions that are taught."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from hilt.nlu.language import Language
from hilt.nlu.lexicon.vocabulary import NewWord
from hilt.nlu.semantics.meaning import ActionDefinition, Plan

DATA = yaml.safe_load(
    (Path(__file__).parents[1] / "data" / "procedures.yaml").read_text(encoding="utf-8")
)


@pytest.mark.parametrize("case", DATA["understood"], ids=lambda case: case["say"])
def test_steps_in_order_are_understood(language: Language, case: dict[str, Any]) -> None:
    """What comes out is the meaning in order, and "it" is what a step is about."""
    known = [NewWord(case["after"], "context", case["after"])] if "after" in case else []

    assert language.with_words(known).understand(case["say"]).meaning.as_json() == case["is"]


@pytest.mark.parametrize("text", DATA["refused"])
def test_what_is_no_procedure_is_none(language: Language, text: str) -> None:
    """A step that is denied, of somebody else, or no step at all leaves nothing to do or learn."""
    meant = language.understand(text).meaning

    assert not isinstance(meant, (Plan, ActionDefinition)), meant
    assert meant.kind in {"error", "ask_back"}


@pytest.mark.parametrize(
    "text",
    [
        each["say"]
        for each in DATA["understood"]
        if {"plan", "steps"} & each["is"].keys() and not {"only_if", "if_fails"} & each["is"].keys()
    ],
)
def test_a_procedure_can_be_said_again(language: Language, text: str) -> None:
    """The sentence that is made of a meaning has this meaning."""
    meant = language.understand(text).meaning
    if isinstance(meant, ActionDefinition) and "*" in meant.parameters:
        pytest.skip('"any object" is said as a thing')

    assert language.understand(language.generate(meant)).meaning == meant
