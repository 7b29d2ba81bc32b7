# SPDX-License-Identifier: Apache-2.0
"""Frames: meanings from objects, uses and degrees in any order."""

from __future__ import annotations

from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.nlu import Language, Statement
from hilt.nlu.grammar.combinators import Combination
from hilt.nlu.language import LANGUAGES_FOLDER
from hilt.nlu.parsing.derivation import DerivationStep
from hilt.nlu.parsing.frames import load_frames
from hilt.ontology.errors import DataError

ENGLISH = LANGUAGES_FOLDER / "english"
FRAMED = [
    "Poking is something a screwdriver does sometimes.",
    "You'd be surprised how often a shoe gets used for pounding round here.",
    "Cutting, now that's something a spatula only rarely gets used for.",
    "Should you need something for rolling, a glass sometimes does the job.",
    "A screwdriver that you're about to hand over should be grabbed by the shaft.",
    "Nobody ever grabs a knife by the blade to pick it up.",
]


@pytest.mark.parametrize("text", FRAMED)
def test_all_words_are_accounted_for(language: Language, text: str) -> None:
    """The parts of a frame are the words of the utterance, each exactly once."""
    understood = language.understand(text)

    assert isinstance(understood.meaning, Statement)
    assert understood.reading is not None
    assert understood.reading.derivation.rule is Combination.GATHERED
    assert understood.derivation is not None
    assert " ".join(_leaves(understood.derivation)).split() == list(understood.words)


@pytest.mark.parametrize(
    "text",
    [
        "Pounding, that is what a hammer does best",
        "A hammer, that is what does the pounding",
        "For pounding, a hammer is the thing you want around here",
        "What you want around here for pounding is a hammer",
    ],
)
def test_the_order_does_not_matter(language: Language, text: str) -> None:
    """An object and a use make a rule, whichever is named first."""
    meaning = language.understand(text).meaning.as_json()

    assert (meaning["object"], meaning["affordance"]) == ("hammer", "pounding")


@pytest.mark.parametrize(
    "word", ["only", "than", "said", "unless", "almost", "without", "if", "yet"]
)
def test_a_word_that_is_not_listed_blocks_a_frame(language: Language, word: str) -> None:
    """Words that may change the meaning are never skipped."""
    text = f"Poking is {word} something a screwdriver does sometimes"

    assert language.understand(text).kind in {"error", "ask_back"}


@settings(max_examples=200, deadline=None)
@given(st.sampled_from(FRAMED), st.randoms(use_true_random=False))
def test_shuffled_words_teach_nothing_else(language: Language, text: str, rng: object) -> None:
    """Words out of English order give no rule about another object."""
    words = text.strip(".").replace(",", "").split()
    wanted = language.understand(text).meaning
    rng.shuffle(words)  # type: ignore[attr-defined]

    found = language.understand(" ".join(words)).meaning

    if isinstance(found, Statement) and isinstance(wanted, Statement):
        assert {rule.object for rule in found.rules} <= {rule.object for rule in wanted.rules}


def test_a_name_needs_its_article(language: Language) -> None:
    """An unknown word without an article may be any word, such as a misspelled known one."""
    assert language.understand("Now a skewer, that one you will see used for poking").new_words
    assert not language.understand("Now skewer, that one you will see used for poking").new_words


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ('{takes: "{x:NP} used", with: [plain], is: "R : x"}', "nothing but gaps"),
        ('{takes: "{x:NP}", with: [plein], is: "Q : about(x)"}', "plein"),
        ('{takes: "{x:NP}", with: [plain], is: "Q : x"}', "does not fit"),
        ('{takes: "{x:NO}", with: [plain], is: "Q : about(x)"}', "NO"),
    ],
)
def test_a_mistake_in_a_frame_is_reported_with_its_line(
    language: Language, tmp_path: Path, line: str, problem: str
) -> None:
    """A frame must have gaps only, known filler groups, and a term of its category."""
    text = (ENGLISH / "frames.yaml").read_text(encoding="utf-8")
    head, _, _ = text.partition("\nframes:\n")
    path = tmp_path / "frames.yaml"
    path.write_text(f"{head}\nframes:\n  - {line}\n", encoding="utf-8")

    with pytest.raises(DataError, match=problem) as caught:
        load_frames(path, language.parser.grammar)

    assert caught.value.line == head.count("\n") + 3


def test_an_unknown_kind_of_word_is_reported(language: Language, tmp_path: Path) -> None:
    """A misspelled kind in the table of neighbours would silently reject sentences."""
    text = (ENGLISH / "frames.yaml").read_text(encoding="utf-8")
    path = tmp_path / "frames.yaml"
    path.write_text(text.replace("\n  wish: [", "\n  wish: [advv, "), encoding="utf-8")

    with pytest.raises(DataError, match="advv"):
        load_frames(path, language.parser.grammar)


def _leaves(step: DerivationStep) -> list[str]:
    if not step.parts:
        return [step.words]
    return [words for part in step.parts for words in _leaves(part)]
