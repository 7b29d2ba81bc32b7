"""Utterances with something around what they mean."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import pytest
import yaml

from hilt.nlu import AskBack, Command, Language, Retraction, Statement, ToolCommand
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.nlu.parsing.periphery import USE, Pause, UtterancePiece, load_table

FAMILIES: dict[str, dict[str, list[object]]] = yaml.safe_load(
    (Path(__file__).parents[1] / "data" / "periphery.yaml").read_text(encoding="utf-8")
)


def cases(kind: str) -> list[object]:
    """All cases of a kind, of all families."""
    return [each for family in FAMILIES.values() for each in family[kind]]


@pytest.mark.parametrize(("text", "core"), cases("at_once"))
def test_a_core_is_understood_beside_its_periphery(
    language: Language, text: str, core: str
) -> None:
    """It means what it means by itself, without a question."""
    meant = language.understand(core).meaning
    assert not isinstance(meant, AskBack)

    assert language.understand(text).meaning == meant


@pytest.mark.parametrize("text", [*cases("no_more"), *cases("unmeant")])
def test_nothing_is_believed_or_done_beside_other_periphery(language: Language, text: str) -> None:
    """Reports, pretences, conditions and other requests around it do not leave a core as it is."""
    meaning = language.understand(text).meaning

    assert not isinstance(meaning, (Statement, Command, ToolCommand, Retraction))


@pytest.mark.parametrize("text", cases("unmeant"))
def test_the_word_of_others_is_not_offered(language: Language, text: str) -> None:
    """What is pretended or somebody else's word is no choice of a question either."""
    meaning = language.understand(text).meaning

    assert not isinstance(meaning, AskBack) or not meaning.choices


@pytest.mark.parametrize(("text", "core"), FAMILIES["offers"]["told"])
def test_what_is_told_behind_a_strong_pause_is_offered(
    language: Language, text: str, core: str
) -> None:
    """A preamble that names nothing and limits nothing does not forbid the offer."""
    rule = language.understand(core).meaning

    found = language.understand(text).meaning

    assert isinstance(found, AskBack)
    assert found.choices == (rule,)


def test_a_pronoun_is_never_guessed(language: Language) -> None:
    """Of two things beside a core neither is what "it" stands for."""
    one = "The nail is loose, so pound it with the hammer."
    two = "The nail is loose and the tack is bent, so pound it with the hammer."

    found = [language.understand(text).meaning for text in (one, two)]

    assert isinstance(found[0], ToolCommand)
    assert not isinstance(found[1], ToolCommand)


def test_no_row_takes_a_use_beside_a_report() -> None:
    """Unless the speaker says it, too, or something else, a report makes no rule."""
    own = {Pause.BUT, Pause.TOLD}
    rows = [
        row for row in load_table().rows if USE in row.of and row.unless and not row.pauses <= own
    ]

    assert rows
    assert all("report" in row.unless and "quoted" in row.unless for row in rows)


def pieces(language: Language, text: str) -> list[UtterancePiece]:
    """The pieces of a text."""
    parser = language.utterance_parser
    return parser.periphery.reader.pieces(tokenize(text, parser.known_words.builder.contractions))


@pytest.mark.parametrize(
    ("text", "forms"),
    [
        ("My hands are wet, so pass me the mug.", ["other", "phrase"]),
        ("Because my tea boils, hand me the mug.", ["reason", "other"]),
        ("I am tired. It rains.", ["own", "impersonal"]),
    ],
)
def test_a_piece_goes_by_how_it_begins(language: Language, text: str, forms: list[str]) -> None:
    """A clause goes by its first word, and whatever has no verb is a phrase."""
    assert [each.form for each in pieces(language, text)] == forms


@pytest.mark.parametrize(
    ("text", "is_told"),
    [
        ("Let me repeat that a spoon is used for stirring.", True),
        ("I never repeat that a spoon is used for stirring.", False),
        ("My aunt repeats that a spoon is used for stirring.", False),
        ("A thing that is used for stirring helps here.", False),
    ],
)
def test_that_begins_a_piece_behind_an_announcement_only(
    language: Language, text: str, *, is_told: bool
) -> None:
    """What speakers announce of their own accord is a piece of its own."""
    assert (len(pieces(language, text)) == 2) == is_told


def test_all_tokens_but_breaks_and_that_are_in_one_piece(language: Language) -> None:
    """The pieces of an utterance follow each other."""
    found = pieces(language, "Here goes: I know that it is odd, but a shoe is used for pounding.")

    assert all(one.end <= two.start <= one.end + 1 for one, two in pairwise(found))


def test_reason_without_a_clause_is_no_crash(language: Language) -> None:
    """A piece of which only its first words are left is understood as saying nothing."""
    assert (
        language.understand("Because otherwise someone gets stabbed, that's why.").kind == "error"
    )
