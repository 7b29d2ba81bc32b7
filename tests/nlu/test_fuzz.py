"""Any text is taken: a slice of `benchmarks/fuzz_nlu.py`."""

from __future__ import annotations

from hypothesis import example, given, settings
from hypothesis import strategies as st

from hilt.nlu import Language

SENTENCES = st.sampled_from(
    [
        "pass me something used for cutting",
        "do not pass me the knife",
        "to pass a knife, never grab it by the handle",
        "no, not by the blade, by the handle",
        "a spoon is never used for cutting",
    ]
)


@settings(max_examples=300, deadline=None)
@example('NO"AAA')
@example("bottle. to me. now pls.")
@given(st.one_of(st.text(max_size=300), st.binary(max_size=100).map(lambda b: b.decode("latin-1"))))
def test_any_text_is_answered(language: Language, text: str) -> None:
    """Nothing raises, and nothing is done but of known words; the benchmark measures the time."""
    understood = language.understand(text)

    if getattr(understood.meaning, "negated", False):  # "no aaa" only says what not to do
        return
    if understood.kind not in {"error", "ask_back"}:
        assert {*language.lexicon.words()}.issuperset(understood.words)
    if understood.kind in {"statement", "command"}:
        assert len(understood.words) > 2


@settings(max_examples=300, deadline=None)
@given(st.data())
def test_a_forbidden_act_never_becomes_a_command(language: Language, data: st.DataObject) -> None:
    """However the words of a prohibition are ordered, with "not" in it nothing is done."""
    words = data.draw(st.permutations(["do", "not", "pass", "me", "the", "knife", "please"]))

    meaning = language.understand(" ".join(words)).meaning.as_json()

    assert "goal" not in meaning or meaning["negated"] is True


@settings(max_examples=300, deadline=None)
@given(SENTENCES, st.data())
def test_a_half_sentence_is_no_command_or_rule(
    language: Language, text: str, data: st.DataObject
) -> None:
    """The first words of a sentence are refused until it says as much as it should."""
    words = text.split()
    cut = data.draw(st.integers(1, len(words) - 3))

    assert language.understand(" ".join(words[:cut])).kind not in {"statement", "command"}
