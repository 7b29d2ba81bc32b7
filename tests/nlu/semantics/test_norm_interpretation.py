"""Norms in the words of people: the same meaning however it is said."""

from __future__ import annotations

from pathlib import Path

import pytest
import yaml

from hilt.nlu.language import Language
from hilt.nlu.semantics.meaning import AskBack, Command, NormStatement, Statement

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
    "text",
    [
        "do not pass me the knife",
        "never pass me the knife",
        "you must not give me the knife",
        "do not touch the mug",
    ],
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
        "never pick up the mug in the attic",
        "never pick up the mug in the box",
        "never pick up the mug in the morning",
        "you can pick up the mug, but not in the hallway",
        "only in the garage may you pick up the hammer",
        "to pass a knife in the garage, grab it by the handle",
        "I don't mind if she holds the mug by the rim",
        "I don't mind holding the mug by the rim",
        "I don't mind if you don't hold the mug by the rim",
        "feel free not to pass the knife",
        "never pick up a spotless bottle",
        "never bring a knife to a gun fight",
        "you may pass the chisel so long as its cap is on",
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


def test_permission_may_forbid_another_part(language: Language):
    """What is allowed by the rim but not by the handle is both."""
    text = "It's fine if you hold the mug by the rim, but not by the handle"

    found = language.understand(text).meaning

    assert isinstance(found, NormStatement)
    said = [(norm.norm, getattr(norm.act, "part", None)) for norm in found.norms]
    assert said == [("permitted", "rim"), ("forbidden", "handle")]


def test_place_that_is_confirmed_is_learned(language: Language):
    """What may be no place is asked about first."""
    understood = language.understand("never pick up the mug in the attic")
    assert isinstance(understood.meaning, AskBack)
    (choice,) = understood.meaning.choices
    assert not isinstance(choice, str)

    learned = language.with_words(understood.chosen(choice).new_words)

    assert learned.understand("never touch the mug in the attic").meaning.kind == "statement"


@pytest.mark.parametrize("new", ["pedal", "torque"])
def test_a_norm_names_one_recipient(language: Language, new: str) -> None:
    """In "give the pedal wrench to customers" the pedal gets nothing."""
    found = language.understand(f"Never give the {new} wrench to customers.")
    assert found.kind in {"error", "ask_back"}
