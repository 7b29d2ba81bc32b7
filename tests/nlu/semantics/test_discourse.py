"""What is said in a conversation means what it means after the turns before it."""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from hilt.nlu import Language, Session
from hilt.nlu.semantics.discourse import Discourse
from hilt.nlu.semantics.fragments import FragmentValues, complete
from hilt.nlu.semantics.meaning import Command, ObjectReference

DIALOGUES = yaml.safe_load(
    (Path(__file__).parents[1] / "data" / "discourse.yaml").read_text(encoding="utf-8")
)


@pytest.mark.parametrize("dialogue", DIALOGUES, ids=lambda each: each["name"])
def test_turns_mean_what_they_should(language: Language, dialogue: dict[str, Any]):
    """Each turn of a dialogue has its meaning, or leads to a question where it has none."""
    session = Session(language)
    came: list[object] = []
    wanted: list[object] = []
    for turn in dialogue["turns"]:
        understood, session = session.hear(turn["say"])
        is_open = understood.kind in {"error", "ask_back"}
        came.append(understood.meaning.as_json() if "meaning" in turn else is_open)
        wanted.append(turn.get("meaning", True))

    assert json.loads(json.dumps(came)) == wanted


@pytest.mark.parametrize(
    ("before", "fragment", "meaning"),
    [
        ("A knife is used for cutting", "and spoons too", {"object": "spoon"}),
        ("A knife is used for cutting", "and sometimes for poking", {"affordance": "poking"}),
        ("What is a knife used for?", "what about the spoon?", {"ask": "uses_of"}),
        ("How do you pick up a knife?", "what about passing it?", {"context": "pass"}),
        ("Is a knife used for cutting?", "and for stirring?", {"affordance": "stirring"}),
        ("pass the mug", "to Kim", {"recipient": "kim"}),
        ("pass me the mug", "by the handle", {"part": "handle"}),
        ("pass me a mug", "the red one", {"target": {"object": "mug", "props": ["red"]}}),
        ("pass me a mug", "another one", {"target": {"object": "mug", "other": True}}),
    ],
)
def test_fragment_fills_a_slot(
    language: Language, before: str, fragment: str, meaning: dict[str, object]
):
    """All else is as in the turn before."""
    understood, _ = Session(language).after([before]).hear(fragment)

    assert meaning.items() <= understood.meaning.as_json().items()


@pytest.mark.parametrize(
    "fragment", ["and a mug?", "by the handle", "never", "the other one", "no, by the handle"]
)
def test_fragment_alone_means_nothing(language: Language, fragment: str):
    """There is nothing that it completes."""
    assert language.understand(fragment).kind in {"error", "ask_back"}
    failed = Session(language).after(["A knife is used for cutting", "florp the gromp"])
    assert failed.hear(fragment)[0].kind in {"error", "ask_back"}


@pytest.mark.parametrize("said", ["it is also used for poking", "pass it to me"])
def test_it_is_not_one_of_several(language: Language, said: str):
    """After two objects in one turn Hilt asks which one is meant."""
    session = Session(language).after(["A knife and a spoon are used for cutting"])

    assert session.hear(said)[0].kind == "ask_back"


@pytest.mark.parametrize(
    ("before", "target"),
    [
        ("why did you hold the knife by the blade?", {"object": "knife"}),
        ("a ladle is a kind of spoon", {"object": "ladle"}),
        ("can you pound the nail with the hammer?", {"object": "nail"}),
        ("do you see the red mug?", {"object": "mug", "props": ["red"]}),
        ("never pick up the mug", {"object": "mug"}),
        ("forget that a knife is used for cutting", {"object": "knife"}),
    ],
)
def test_it_is_what_any_turn_named(language: Language, before: str, target: dict[str, object]):
    """Questions, commands, norms, kinds and what is retracted all name an object."""
    understood, _ = Session(language).after([before]).hear("pass it to me")

    assert understood.meaning.as_json() == {"goal": "pass", "target": target}


@pytest.mark.parametrize("pause", [". ", ", "])
def test_correction_in_one_breath_leaves_what_was_meant(language: Language, pause: str):
    """The use that was taken back is neither believed nor denied."""
    understood = language.understand(f"a spoon is used for cutting{pause}no, for stirring")

    rule = {"rule": "functional", "object": "spoon", "affordance": "stirring"}
    assert rule.items() <= understood.meaning.as_json().items()


@pytest.mark.parametrize(
    ("failed", "text", "thing"),
    [
        ("There hangs a tool called a wrench.", "It's for tightening bolts.", "wrench"),
        ("So. Trowel.", "It's for digging.", "trowel"),
        ("That's a lovely wine glass you have there.", "What do you use it for?", "wine glass"),
        (
            "These are my good scissors, so listen carefully.",
            "They're for cutting cloth.",
            "scissors",
        ),
    ],
)
def test_it_may_be_what_a_failed_turn_introduced(
    language: Language, failed: str, text: str, thing: str
) -> None:
    """What is asked about afterwards is the thing that was named, not one of before."""
    session = Session(language).after(("A spoon is used for stirring.", failed))

    understood, _ = session.hear(text)

    meanings = getattr(understood.meaning, "choices", ()) or (understood.meaning,)
    assert thing in json.dumps([each.as_json() for each in meanings])


def test_him_may_be_whom_a_failed_turn_named(language: Language) -> None:
    """What is offered goes to the person, never to the speaker."""
    session = Session(language).after(("Now listen, our Danny has come by at long last.",))

    understood, _ = session.hear("Hand that mug over to him at once, would you?")

    choices = getattr(understood.meaning, "choices", ())
    assert {each.recipient for each in choices} <= {"danny"}


def test_fragment_may_describe_a_thing_by_its_use():
    """A fragment that names no object is none of a pair of objects."""
    asked = Command("pass", ObjectReference("mug"))
    discourse = replace(Discourse().about("spoon").about("mug"), last=asked)
    something = ObjectReference(used_for="pounding")

    found = complete(FragmentValues("fill", (0.95, 1.0), target=something), discourse)

    assert found == Command("pass", something)
