# SPDX-License-Identifier: Apache-2.0
"""Derivations as pictures."""

from __future__ import annotations

from xml.etree import ElementTree

from hilt.nlu import Language
from hilt.nlu.parsing.derivation_drawing import svg_of


def test_every_word_and_step_is_drawn(language: Language) -> None:
    """The picture is good XML, with each word and the meaning of the whole."""
    step = language.understand("A knife is used for cutting").derivation
    assert step is not None

    drawn = ElementTree.fromstring(svg_of(step))  # noqa: S314 - our own

    texts = ["".join(each.itertext()) for each in drawn.iter("{http://www.w3.org/2000/svg}text")]
    assert {"knife", "used", "for", "cutting"} <= {*" ".join(texts).split()}
    assert any("implies(knife,cutting,high)" in text for text in texts)
