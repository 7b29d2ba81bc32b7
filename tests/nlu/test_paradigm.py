"""Lexical rules: every verb of the paradigm is understood in every form."""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
import yaml

from hilt.nlu import Language

DATA = yaml.safe_load((Path(__file__).parent / "data" / "paradigm.yaml").read_text("utf-8"))


def filled(value: Any, verb: dict[str, str]) -> Any:
    """A text, or all texts of a meaning, with the forms of a verb."""
    if isinstance(value, str):
        return value.format(**verb)
    if isinstance(value, dict):
        return {key: filled(each, verb) for key, each in value.items()}
    return value


def cases() -> Iterator[object]:
    """Each form of each verb: its text and its meaning."""
    for verb in DATA["verbs"]:
        for name, means, says in DATA["forms"][verb["kind"]]:
            wanted = filled(DATA["meanings"][verb["kind"]][means], verb)
            yield pytest.param(says.format(**verb), wanted, id=f"{verb['v']}-{name}")


@pytest.mark.parametrize(("text", "wanted"), list(cases()))
def test_every_verb_is_understood_in_every_form(
    language: Language, text: str, wanted: dict[str, object]
) -> None:
    """A form that is understood with one verb is understood with all verbs of its kind."""
    found = json.loads(json.dumps(language.understand(text).meaning.as_json()))

    assert found == wanted
