"""Discourse markers are removed, and nothing else is."""

from __future__ import annotations

import pytest

from hilt.nlu import Language
from hilt.nlu.lexicon.discourse_markers import DiscourseMarkers, move_to_front
from hilt.nlu.lexicon.tokenizer import tokenize
from hilt.ontology.errors import DataError
from hilt.ontology.yaml_reader import YamlNode


def discourse_markers(kind: str, *patterns: str) -> DiscourseMarkers:
    """Discourse markers of one kind."""
    items = tuple(YamlNode(pattern, "<text>", 1, 1) for pattern in patterns)
    return DiscourseMarkers().with_phrases(kind, YamlNode(items, "<text>", 1, 1))


def said(text: str, known: DiscourseMarkers, *whole: str) -> str:
    """A text without its discourse markers."""
    kept = {tuple(phrase.split()) for phrase in whole}
    return " ".join(known.remove_markers(tokenize(text, {}), kept).words)


def test_a_marker_is_removed_anywhere() -> None:
    """The phrase may stand between any two words."""
    known = discourse_markers("anywhere", "you know", "really")

    assert said("Knives are, you know, really for cutting", known) == "knives are for cutting"


def test_a_marker_within_a_protected_phrase_is_kept() -> None:
    """The word "ever" is part of "hardly ever"."""
    known = discourse_markers("anywhere", "ever")

    assert said("hardly ever, if ever", known, "hardly ever") == "hardly ever if"


def test_a_marker_that_needs_pauses_is_kept_without_them() -> None:
    """The word "right" is a marker in "right, pass it", not in "the right end"."""
    known = discourse_markers("apart", "right")

    assert said("right, hold the right end", known) == "hold the right end"


def test_a_reason_is_removed_up_to_a_pause() -> None:
    """An asterisk in a pattern matches one word, but never "not"."""
    known = discourse_markers("clauses", "because it is *")

    assert said("because it is sharp, use it", known) == "use it"
    assert said("because it is not, use it", known) == "because it is not use it"


@pytest.mark.parametrize(("kind", "asks"), [("question_tags", True), ("statement_tags", False)])
def test_a_tag_makes_a_question_or_does_not(kind: str, asks: bool) -> None:
    """A tag like "right?" asks, one like "okay?" does not."""
    known = discourse_markers(kind, "tag")

    found = known.remove_tag(tokenize("knives cut, tag?", {}))

    assert (found.words, found.asks) == (("knives", "cut"), asks)


@pytest.mark.parametrize(
    ("text", "left"),
    [
        ("every so often, now and then at least, it cuts", "now and then it cuts"),
        ("often, well rarely, it cuts", "rarely it cuts"),
        ("rarely, and I mean rarely, it cuts", "rarely it cuts"),
        ("it rarely cuts, very rarely", "it rarely cuts"),
        ("often, it cuts", "often it cuts"),
        ("often, it cuts and, often, it pounds", "often it cuts and often it pounds"),
        ("it cuts often enough", "it cuts often enough"),
    ],
)
def test_of_degrees_that_are_repeated_the_last_is_left(text: str, left: str) -> None:
    """One that stands alone, or with something said between, stays where it is."""
    emphasis = ("and", "at", "least", "well", "i", "mean", "very")
    known = DiscourseMarkers(emphasis=frozenset((word,) for word in emphasis))
    degrees = {("every", "so", "often"): "low", ("now", "and", "then"): "low"}
    degrees |= {("often",): "high", ("rarely",): "none"}

    assert known.leave_last_degree(tokenize(text, {}), degrees).words == tuple(left.split())


def test_a_repeated_beginning_is_removed() -> None:
    """Only with a pause between: doubled words without one are a mistake."""
    known = discourse_markers("anywhere", "really")

    assert said("you can, you can cut", known) == "you can cut"
    assert said("you can you can cut", known) == "you can you can cut"


def test_a_single_adverb_moves_to_the_front() -> None:
    """Where there are two, neither moves."""
    often = {("often",)}

    one = move_to_front(tokenize("you often cut", {}), often, ())

    assert one is not None
    assert one.words == ("often", "you", "cut")
    assert move_to_front(tokenize("you often cut often", {}), often, ()) is None
    assert move_to_front(tokenize("you often cut", {}), often, ["you"]) is None


def test_an_unknown_kind_is_refused() -> None:
    """The message lists the kinds."""
    with pytest.raises(DataError, match="anywhere"):
        discourse_markers("nowhere", "really")


@pytest.mark.parametrize("word", ["not", "never", "if", "unless", "said", "yesterday", "no"])
def test_words_that_change_a_meaning_are_no_markers(language: Language, word: str) -> None:
    """No data file may declare such words to be markers."""
    known = language.builder.discourse_markers

    assert (word,) not in known.anywhere | known.apart


@pytest.mark.parametrize(
    "text", ["basically.", "you know. basically. of course", "well; basically; so?", "please!"]
)
def test_an_utterance_of_markers_only_is_not_understood(language: Language, text: str) -> None:
    """Nothing remains to be parsed."""
    assert language.understand(text).kind in {"error", "acknowledgement"}
