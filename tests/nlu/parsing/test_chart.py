"""The chart: one derivation per meaning, all words used, bounded time."""

from __future__ import annotations

import time

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from hilt.nlu import Language
from hilt.nlu.lexicon.tokenizer import MAX_TOKENS
from hilt.nlu.parsing.chart import Chart
from hilt.nlu.semantics.predicates import form_of

SLOWEST = (
    1.0  # [s] of processor time: what grows without bounds takes far longer; speed is benchmarked
)


def chart_of(language: Language, text: str) -> Chart:
    """The chart of a text in lower case without punctuation."""
    return Chart(text.split(), language.parser.lexicon, language.parser.combinator)


def test_a_span_knows_its_categories(language: Language) -> None:
    """The chart gives the categories of every span."""
    chart = chart_of(language, "pass me the knife")

    assert {"NP", "TP"} <= set(map(str, chart.categories(2, 4)))
    assert {"N", "NP", "TP"} <= set(map(str, chart.categories(3, 4)))


def test_a_meaning_is_found_once(language: Language) -> None:
    """The normal form leaves one derivation of one meaning."""
    chart = chart_of(language, "to pass a knife grab the knife by the blade")
    statements = [
        derivation
        for category, act in language.parser.grammar.roots.items()
        if act == "STATEMENT"
        for derivation in chart.derivations(category)
    ]

    forms = [str(form_of(each.value)) for each in statements]
    assert len(set(forms)) == len(forms)
    assert [form for form in forms if not form.startswith("within")] == [
        "implies(pass(self,knife),graspObject(self,partOf(blade,knife)),high)"
    ]


def test_the_longest_span_is_reported(language: Language) -> None:
    """A failure message can say how much was understood."""
    chart = chart_of(language, "knife pass me the knife the")

    assert chart.longest_span() == (1, 5)


def test_an_empty_chart_has_no_derivations(language: Language) -> None:
    """A text without words has no span and no derivation."""
    chart = chart_of(language, "")

    assert chart.longest_span() == (0, 0)
    assert all(not chart.derivations(root) for root in language.parser.grammar.roots)


@pytest.mark.parametrize("word", ["the", "to", "and", "is", "knife", "used", "with", "or"])
def test_repeated_words_take_bounded_time(language: Language, word: str) -> None:
    """The worst case, as many of the most ambiguous words as allowed, takes under a second."""
    text = " ".join([word] * MAX_TOKENS)

    started = time.process_time()
    language.understand(text)

    assert time.process_time() - started < SLOWEST


@settings(max_examples=200, deadline=None)
@given(st.data())
def test_any_words_take_bounded_time(language: Language, data: st.DataObject) -> None:
    """Known words in any order, as many as allowed, take under a second."""
    known = sorted({*language.lexicon.words()})
    words = data.draw(st.lists(st.sampled_from(known), max_size=MAX_TOKENS))

    started = time.process_time()
    language.understand(" ".join(words))

    assert time.process_time() - started < SLOWEST
