"""Claims about utterances."""

from __future__ import annotations

from datetime import datetime, timezone

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.kb.history import HISTORY, Utterance, import_utterance, read_utterance, utterance_quads
from hilt.kb.rdf.rule_mapping import DERIVED
from hilt.ontology.errors import ValidationError

NOON = datetime(2026, 11, 21, 12, tzinfo=timezone.utc)
texts = st.text(st.characters(exclude_categories=["Cs"]))
ids = st.lists(st.integers(0, 9).map(lambda n: f"rule/{n:016x}"), max_size=3, unique=True)
utterances = st.builds(
    Utterance, st.integers(1, 10**9), texts, texts, st.just("sam"), st.just(NOON),
    st.just("statement"), st.booleans(), texts,
    *(ids.map(lambda some: tuple(sorted(some))) for _ in range(3)),
)  # fmt: skip


@given(utterances)
def test_utterance_comes_back_from_the_graph(utterance: Utterance):
    """`read_utterance` is the inverse of `utterance_quads`."""
    quads = list(utterance_quads(utterance))

    said = [(quad.predicate, quad.object) for quad in quads if quad.graph == HISTORY]
    assert read_utterance(said) == utterance
    assert {quad.graph for quad in quads} == {HISTORY, DERIVED}


def test_utterance_with_a_gap_is_refused():
    """Each utterance has a text, a speaker and a time."""
    quads = list(utterance_quads(Utterance(1, "Hello.", "", "sam", NOON)))

    with pytest.raises(ValidationError, match="An utterance has 0 "):
        read_utterance((quad.predicate, quad.object) for quad in quads[:3])


def test_time_without_zone_is_refused():
    """History is ordered in time everywhere."""
    with pytest.raises(ValidationError, match="no time zone"):
        Utterance(1, "Hello.", "", "sam", datetime(2026, 11, 21))


def test_endless_text_is_refused():
    """What is kept is bounded."""
    with pytest.raises(ValidationError, match="at most 100000"):
        Utterance(1, "x" * 100_001, "", "sam", NOON)


def test_json_shows_what_is_missing_as_null():
    """Nothing understood and nothing answered are null."""
    shown = Utterance(1, "Hm.", "", "sam", NOON, "unknown", False).as_json()

    assert (shown["sequence"], shown["time"]) == (1, "2026-11-21T12:00:00Z")
    assert (shown["predicate"], shown["answer"], shown["asserts"]) == (None, None, [])


@pytest.mark.parametrize(
    ("source", "speaker"),
    [
        ("rules.csv", "file rules.csv"),
        ("/home/eve/my rules (1).csv.gz", "file my rules 1 .csv.gz"),
        ("-", "file standard input"),
        ("<text>", "file text"),
        ("http://127.0.0.1:7878/query", "file query"),
        ("/", "file"),
        ("x" * 300, "file " + "x" * 95),
    ],
)
def test_file_says_what_no_person_said(source: str, speaker: str):
    """Its name is that of a speaker, and never that of a person: a file may be called "sam"."""
    told = import_utterance(source, 1, NOON, some=", rules 1 to 2")

    assert (told.speaker, told.kind) == (speaker, "import")
    assert told.text == f"import of {source}, rules 1 to 2"
