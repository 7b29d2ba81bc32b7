"""Norms in the words of people: the same meaning however it is said."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from hilt.nlu.language import Language
from hilt.nlu.semantics.meaning import Command, NormStatement, Statement

FAMILIES = yaml.safe_load(
    (Path(__file__).parents[1] / "data" / "norms.yaml").read_text(encoding="utf-8")
)
CASES = [
    (text, each["norm"]) for group in FAMILIES.values() for each in group for text in each["texts"]
]


@pytest.mark.parametrize(("text", "norm"), CASES, ids=[text for text, _ in CASES])
def test_norm_is_understood_however_it_is_said(
    language: Language, text: str, norm: dict[str, object]
):
    """Each way to say a norm has its meaning."""
    found = language.understand(text).meaning

    assert isinstance(found, NormStatement)
    said = found.as_json()
    assert {key: said.get(key) for key in norm} == norm


@pytest.mark.parametrize(
    "text", ["do not pass me the knife", "never pass me the knife", "do not touch the mug"]
)
def test_what_is_not_wanted_now_is_a_command(language: Language, text: str):
    """It holds for the moment, and is never carried out."""
    found = language.understand(text).meaning

    assert isinstance(found, Command)
    assert found.negated


@pytest.mark.parametrize("text", ["never cut with a knife", "you can cut bread with a knife"])
def test_use_stays_a_rule(language: Language, text: str):
    """What a thing is good for is no norm."""
    assert isinstance(language.understand(text).meaning, Statement)


@pytest.mark.parametrize(
    "text",
    [
        "pass me the knife before you pick up the mug",
        "my aunt says you must not pick up the mug",
        "perhaps you must not pick up the mug",
        "you may pick up the mug if I say so",
        "you must not pick up the mug unless I ask you to",
    ],
)
def test_norm_that_cannot_be_kept_is_not_agreed_to(language: Language, text: str):
    """It is asked about or refused."""
    assert language.understand(text).meaning.kind in {"ask_back", "error"}


def test_exception_makes_two_norms(language: Language):
    """What only some may have, others must not be given."""
    found = language.understand("only adults may get knives").meaning

    assert isinstance(found, NormStatement)
    assert [norm.norm for norm in found.norms] == ["forbidden", "permitted"]
