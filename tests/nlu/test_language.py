# SPDX-License-Identifier: Apache-2.0
"""A language as a whole: loading, the vocabulary, the examples, the cost of importing it."""

from __future__ import annotations

import doctest
import importlib
import subprocess
import sys

import pytest

import hilt.nlu
from hilt.nlu import Language, NewWord, Vocabulary
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


def test_an_unknown_language_is_told() -> None:
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


def test_all_public_names_are_listed() -> None:
    """`__all__` is sorted and complete."""
    assert hilt.nlu.__all__ == sorted(hilt.nlu.__all__)
    assert all(hasattr(hilt.nlu, name) for name in hilt.nlu.__all__)


def test_importing_reads_no_data_and_no_parser() -> None:
    """Who only imports does not pay for yaml and lark."""
    program = "import sys, hilt.nlu; print(sorted({'yaml', 'numpy', 'lark'} & set(sys.modules)))"

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
