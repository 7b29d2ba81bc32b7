# SPDX-License-Identifier: Apache-2.0
"""What is denied of a thing, and what only puts right what was said before."""

from __future__ import annotations

import pytest

from hilt.nlu import Language, Statement


@pytest.mark.parametrize(
    "text",
    [
        "no mug should be passed by the handle",
        "no spoon can be used for cutting",
        "No knives must be used for pounding.",
        "no saw is ever used for pounding",
        "No object should ever be passed by the handle.",
    ],
)
def test_no_thing_is_a_denial(language: Language, text: str) -> None:
    """Without a pause, "no" goes with the thing."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Statement)
    assert [rule.confidence for rule in meaning.rules] == [(0.0, 0.05)]


@pytest.mark.parametrize("text", ["No, knives are used for cutting.", "No, a saw is for cutting."])
def test_no_before_a_pause_puts_right(language: Language, text: str) -> None:
    """With a pause, "no" is about what was said before."""
    meaning = language.understand(text).meaning

    assert isinstance(meaning, Statement)
    assert [rule.confidence for rule in meaning.rules] == [(0.95, 1.0)]


@pytest.mark.parametrize(
    "text",
    [
        "no knife is used for cutting",
        "no mugs get passed by the handle",
        "to pass no knife grab it by the blade",
    ],
)
def test_what_is_not_understood_of_no_thing_is_refused(language: Language, text: str) -> None:
    """Nothing is believed of "no knife" as if it were "a knife"."""
    assert language.understand(text).kind in {"error", "ask_back"}
