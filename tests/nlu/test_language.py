"""A language as a whole: loading, the vocabulary, the examples, the cost of importing it."""

from __future__ import annotations

import doctest
import gc
import importlib
import subprocess
import sys
from collections.abc import Callable

import pytest

import hilt.nlu
from hilt.nlu import AskBack, Language, NewWord, Session, Vocabulary
from hilt.ontology.errors import UnknownNameError


def test_every_example_is_understood(language: Language) -> None:
    """What is shown as sayable can be said."""
    before = language.understand("To pass a knife grab it by the blade").discourse
    for sentence in language.examples:
        assert language.understand(sentence, discourse=before).kind not in {"error", "ask_back"}


def test_nouns_come_from_the_vocabulary() -> None:
    """Another domain brings its own names."""
    language = Language.load(vocabulary=Vocabulary(objects=("trowel",), parts=("tang",)))

    understood = language.understand("To pass trowels grab them by the tang")

    assert understood.meaning.as_json()["object"] == "trowel"
    assert language.understand("pass me the knife").unknown == ("knife",)


def test_an_unknown_language_is_an_error() -> None:
    """The error lists those there are."""
    with pytest.raises(UnknownNameError, match="english"):
        Language.load("klingon")


def test_a_language_is_shown_by_its_name(language: Language) -> None:
    """Not by its twenty thousand entries."""
    taught = language.with_words([NewWord("ladle", "object", "ladle")])

    assert repr(taught) == "<Language english, 1 words learned>"


def test_learning_nothing_changes_nothing(language: Language) -> None:
    """Words that are known already make no new language."""
    word = NewWord("ladle", "object", "ladle")
    taught = language.with_words([word])

    assert language.with_words([]) is language
    assert taught.with_words([word]) is taught


@pytest.mark.parametrize("switch", [gc.enable, gc.disable])
def test_garbage_collector_is_left_as_it_was(
    language: Language, switch: Callable[[], None]
) -> None:
    """It pauses while an utterance is understood; whoever switched it off keeps it off."""
    switch()
    before = gc.isenabled()

    language.understand("pass me the knife")

    after = gc.isenabled()
    gc.enable()
    assert after == before


def test_all_public_names_are_listed() -> None:
    """`__all__` is sorted and complete."""
    assert hilt.nlu.__all__ == sorted(hilt.nlu.__all__)
    assert all(hasattr(hilt.nlu, name) for name in hilt.nlu.__all__)


def test_importing_reads_no_data_and_no_parser() -> None:
    """The import alone does not load yaml, lark or numpy."""
    program = (
        "import sys; from hilt.nlu import Language;"
        "print(sorted({'yaml', 'lark', 'numpy'} & set(sys.modules)))"
    )

    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )

    assert done.stdout.strip() == "[]"


@pytest.mark.parametrize("name", ["", ".grammar.terms", ".semantics.predicates", ".language"])
def test_the_examples_in_the_docstrings_run(name: str) -> None:
    """What a docstring shows is what comes out."""
    results = doctest.testmod(importlib.import_module(f"hilt.nlu{name}"))

    assert results.attempted > 0
    assert results.failed == 0


@pytest.mark.parametrize(
    ("text", "meaning"),
    [
        ("pass me the saw", {"goal": "pass", "target": {"object": "saw"}}),
        ("pass it to me", {"goal": "pass", "target": {"object": "saw"}}),
        ("pass me something to slice with", {"goal": "pass", "target": {"usedFor": "slicing"}}),
        ("what slices?", {"ask": "objects_for", "affordance": "slicing"}),
        ("slice the bread", {"goal": "slice", "patient": "bread", "tool": {"usedFor": "slicing"}}),
    ],
)
def test_words_are_usable_once_they_were_taught(
    language: Language, text: str, meaning: object
) -> None:
    """In every form: plural, gerund, infinitive, as an act."""
    session = Session(language).after(["A saw is used for slicing."])

    understood, _ = session.hear(text)

    assert understood.meaning.as_json() == meaning


def test_hearing_an_utterance_changes_no_other_session(language: Language) -> None:
    """A session is a value."""
    before = Session(language)

    before.after(["A saw is used for slicing."])

    assert before.hear("pass me the saw")[0].unknown == ("saw",)


@pytest.mark.parametrize(
    ("text", "lower"),
    [("No wait, only sometimes.", 0.5), ("no, never", 0.0), ("I meant often", 0.75)],
)
def test_a_degree_is_corrected(language: Language, text: str, lower: float) -> None:
    """The last rule keeps its object and use."""
    session = Session(language).after(["A shoe is used for pounding."])

    rule = session.hear(text)[0].meaning.as_json()

    assert (rule["object"], rule.get("revises")) == ("shoe", True)
    assert rule["confidence"][0] == lower  # type: ignore[index]


def test_a_rule_is_applied_to_another_object(language: Language) -> None:
    """It may be said that the same goes for another object."""
    session = Session(language).after(["A shoe is often used for pounding."])

    rule = session.hear("The same goes for mugs.")[0].meaning.as_json()

    assert rule == {
        "rule": "functional",
        "object": "mug",
        "affordance": "pounding",
        "confidence": [0.75, 1.0],
    }


def test_a_misspelling_is_asked_about_even_if_it_fits_another_role(language: Language) -> None:
    """After "saw" was learned, "knive" could be a part of it too; still it looks like "knife"."""
    session = Session(language).after(["A saw is used for slicing."])

    meaning = session.hear("A knive is used for cutting")[0].meaning

    assert isinstance(meaning, AskBack)
    assert meaning.choices == ("knife",)


def test_text_without_capitals_names_people(language: Language) -> None:
    """A speech recogniser writes "kim" for Kim."""
    found = language.understand("give bob the knife").meaning.as_json()

    assert found == {"goal": "pass", "target": {"object": "knife"}, "recipient": "bob"}


def test_text_without_punctuation_has_asides(language: Language) -> None:
    """No pauses set them off."""
    found = language.understand("a mug in case you were wondering is used for containing").meaning

    assert found == language.understand("a mug is used for containing").meaning
