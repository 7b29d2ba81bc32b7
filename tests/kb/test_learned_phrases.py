"""Learned phrases in the base: kept, listed, exported, merged and forgotten."""

from __future__ import annotations

from pathlib import Path

import pytest

from hilt.kb import KnowledgeBase
from hilt.kb.formats.import_export import export_file, import_file
from hilt.kb.learned import PHRASES, LearnedPhrase
from hilt.kb.validation import check_invariants
from hilt.ontology.errors import NotFoundError

PHRASE = LearnedPhrase(
    "for ?affordance what you want is a ?object",
    '{"rule":"functional","object":"?object","affordance":"?affordance","confidence":[0.95,1.0]}',
    "For stirring, what you want is a spoon.",
    "sam",
)


def learn(base: KnowledgeBase) -> None:
    """Say what is confirmed, and keep the phrase."""
    base.record("a spoon is used for stirring", "", "sam", "statement", accepted=True)
    base.learn_phrase(PHRASE)


def test_a_phrase_is_kept_with_its_speaker_and_utterance(tmp_path: Path) -> None:
    """After the base was closed, too."""
    with KnowledgeBase.open(tmp_path / "kb") as base:
        learn(base)
    with KnowledgeBase.open(tmp_path / "kb") as base:
        (kept,) = base.phrases()

        assert (kept.pattern, kept.meaning, kept.speaker) == (PHRASE.pattern, PHRASE.meaning, "sam")
        assert kept.utterance == 1
        assert base.words() == []
        assert list(check_invariants(base.store)) == []


@pytest.mark.parametrize("name", [PHRASE.pattern, PHRASE.said])
def test_a_phrase_is_forgotten_by_its_pattern_or_what_was_said(name: str) -> None:
    """The history says so, and a second time it is not there."""
    with KnowledgeBase.open("memory:") as base:
        learn(base)
        base.forget(PHRASES, name, "forget it", "sam")

        assert base.phrases() == []
        assert [each.text for each in base.history()][-1] == "forget it"
        with pytest.raises(NotFoundError, match="learned phrase"):
            base.forget(PHRASES, name, "forget it", "sam")


def test_a_phrase_goes_with_an_export(tmp_path: Path) -> None:
    """N-Quads of one base are imported into another."""
    file = tmp_path / "base.nq"
    with KnowledgeBase.open("memory:") as base, KnowledgeBase.open("memory:") as other:
        learn(base)
        export_file(base, file)
        import_file(other, file)

        assert [each.pattern for each in other.phrases()] == [PHRASE.pattern]
