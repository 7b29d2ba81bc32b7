"""Norms, taught actions and kinds in the words of people who had not read the grammar.

They wrote down what each sentence means by the schema of meanings. What is not understood is asked
about or refused; the sentences that are understood otherwise than they meant are listed here.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from hilt.nlu import Language

DATA = Path(__file__).parent / "data"
LEAST_RIGHT = {"blind_norms": 0.6, "blind_actions": 0.75, "blind_kinds": 0.9}
OTHERWISE = {  # what is made of it
    "A blunt knife has to be passed by the blade.": "a rule on holding",
    "A hammer must be passed by the head.": "a rule on holding",
    "You have to hold a hot pan by the handle when you pick it up.": "a rule on holding",
    "You must never grab the pan by the handle.": "a rule on holding",
    "You must pick up any hot thing by its handle.": "a rule on holding",
    "A hot pan must always be grabbed by the handle.": "a rule on holding",
    "Under no circumstances should you hand over a saw by the blade.": "a rule on holding",
    "You have to pass scissors by the blade.": "a rule on holding",
    "You must hold the teapot by the handle.": "a rule on holding",
    "To air a pillow, first pick it up, then put it down; if that fails, stop.": "with its end",
    "Don't ever give matches to a toddler.": "matches as a singular",
}


@pytest.fixture(scope="module")
def language() -> Language:
    """The language without learned words."""
    return Language.load()


def cases(name: str) -> list[dict[str, Any]]:
    """The lines of a file: text, what was said before, meaning."""
    lines = (DATA / f"{name}.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line) for line in lines]


def plain(meaning: Any) -> Any:
    """A meaning without its usual confidence, its links, and the recipient "me".

    Of conditions and reactions to failure only whether there are any: their form was not in the
    schema that people had.
    """
    if isinstance(meaning, list):
        return [plain(each) for each in meaning]
    if not isinstance(meaning, dict):
        return meaning
    kept = {key: plain(value) for key, value in meaning.items() if key != "links"}
    kept |= {key: True for key in ("only_if", "if_fails") if key in kept}
    for key, usual in (("confidence", [0.95, 1.0]), ("recipient", "me"), ("recipient", "speaker")):
        if kept.get(key) == usual:
            del kept[key]
    return kept


@pytest.mark.parametrize("name", LEAST_RIGHT)
def test_most_is_understood_as_it_was_meant(language: Language, name: str):
    """At least this share; whatever else is taken for a meaning is known and listed."""
    right, wrong = 0, []
    for case in cases(name):
        discourse = None
        for text in case.get("before", []):
            discourse = language.understand(text, discourse=discourse).discourse
        found = json.loads(
            json.dumps(language.understand(case["text"], discourse=discourse).meaning.as_json())
        )
        if plain(found) == plain(case["meaning"]):
            right += 1
        elif not found.keys() & {"error", "ask_back", "note"} and case["text"] not in OTHERWISE:
            wrong.append((case["text"], found, case["meaning"]))

    assert wrong == []
    assert right >= LEAST_RIGHT[name] * len(cases(name)), right
