"""Utterances and their meanings, as data: one check for all."""

from __future__ import annotations

import itertools
import json
from collections.abc import Iterator
from pathlib import Path

import pytest
import yaml

from hilt.nlu import Language

DATA = Path(__file__).parent / "data"


def cases(*names: str) -> list[object]:
    """All utterances of the files, as `_cases` gives them."""
    return list(_cases(*names))


def _cases(*names: str) -> Iterator[object]:
    """(text, what was said before, group) of every utterance in the files."""
    for name in names:
        for group in yaml.safe_load((DATA / f"{name}.yaml").read_text(encoding="utf-8")):
            for text in group["texts"]:
                yield pytest.param(text, group.get("before"), group, id=text)


def check(language: Language, text: str, before: str | None, group: dict[str, object]) -> None:
    """The text means what its group says, after what was said before."""
    discourse = language.understand(before).discourse if before else None

    understood = language.understand(text, discourse=discourse)

    found = json.loads(json.dumps(understood.meaning.as_json()))
    if "meaning" in group:
        assert found == group["meaning"]
    else:
        expected = group["check"]
        assert isinstance(expected, dict)
        assert expected.items() <= found.items()


@pytest.mark.parametrize(
    ("text", "before", "group"),
    cases(
        "paper",
        "frames",
        "paraphrases",
        "commands",
        "constructions",
        "conversation",
        "materials",
        "attitudes",
        "kinds",
        "new_words",
    ),
)
def test_an_utterance_means_what_it_should(
    language: Language, text: str, before: str | None, group: dict[str, object]
) -> None:
    """Every utterance of the data files has its meaning."""
    check(language, text, before, group)


@pytest.mark.parametrize(
    "text", yaml.safe_load((DATA / "refusals.yaml").read_text(encoding="utf-8"))
)
def test_an_unclear_sentence_is_refused(language: Language, text: str) -> None:
    """Half, conditional and injected sentences give neither belief nor command to be done."""
    meaning = language.understand(text).meaning

    assert meaning.kind in {"error", "ask_back"} or getattr(meaning, "negated", False)


OBJECTS = [
    "mug",
    "knife",
    "wine glass",
    "spatula",
    "spoon",
    "shoe",
    "screwdriver",
    "rock",
    "hammer",
    "glass",
]
QUALIFIERS = {
    "": 0.95,
    "occasionally": 0.25,
    "sometimes": 0.5,
    "often": 0.75,
    "generally": 0.95,
    "always": 1.0,
}
GOALS = {"pass": "pass", "pickup": "pickUp", "pick up": "pickUp", "point to": "pointTo"}
USES = ["cutting", "containing", "pounding", "rolling", "poking"]
PARTS = [
    "red",
    "green",
    "blue",
    "handle",
    "blade",
    "sole",
    "stem",
    "barrel",
    "shaft",
    "upper",
    "head",
]
PREFIXES = ["", "now ", "okay ", "first ", "then "]


def test_table_3_functional_statements(language: Language) -> None:
    """`a <object> is [<qualifier>] used for <use>`, all of them."""
    for name, (word, lower), use in itertools.product(OBJECTS, QUALIFIERS.items(), USES):
        found = language.understand(f"a {name} is {word} used for {use}").meaning.as_json()

        assert found == {
            "rule": "functional", "object": name, "affordance": use, "confidence": [lower, 1.0],
        }  # fmt: skip


@pytest.mark.parametrize("verb", ["grab", "grasp"])
@pytest.mark.parametrize("again", ["it", "the {}", "a {}"])
def test_table_3_action_statements(language: Language, verb: str, again: str) -> None:
    """`to <goal> a <object> [<qualifier>] <primitive> <object> by the <part>`, all of them."""
    for name, (goal, context), (word, lower), part in itertools.product(
        OBJECTS, GOALS.items(), QUALIFIERS.items(), PARTS
    ):
        text = f"to {goal} a {name} {word} {verb} {again.format(name)} by the {part}"

        assert language.understand(text).meaning.as_json() == {
            "rule": "action", "object": name, "context": context, "part": part,
            "confidence": [lower, 1.0],
        }  # fmt: skip


@pytest.mark.parametrize("prefix", PREFIXES)
def test_table_3_commands(language: Language, prefix: str) -> None:
    """`[now|...] (<goal>|<primitive>) something used for <use>`, all of them."""
    acts = {**GOALS, "pass me": "pass", "grab": "grasp", "grasp": "grasp"}
    for (act, goal), use in itertools.product(acts.items(), USES):
        found = language.understand(f"{prefix}{act} something used for {use}").meaning.as_json()

        assert found == {"goal": goal, "target": {"usedFor": use}}


@pytest.mark.parametrize("prefix", PREFIXES)
def test_table_3_grasp_commands(language: Language, prefix: str) -> None:
    """`[now|...] <primitive> <object> by the <part>`, all of them."""
    for verb, name, part in itertools.product(["grab", "grasp"], OBJECTS, PARTS):
        found = language.understand(f"{prefix}{verb} the {name} by the {part}").meaning.as_json()

        assert found == {"goal": "grasp", "target": {"object": name}, "part": part}
