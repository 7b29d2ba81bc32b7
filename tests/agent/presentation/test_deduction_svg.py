"""Derivations as drawings of deductions."""

from __future__ import annotations

from xml.etree import ElementTree

from hilt.agent import Agent
from hilt.agent.presentation.deduction_svg import draw_svg, from_derivation, from_proof
from hilt.nlu import Language


def test_the_drawing_has_every_word_and_step() -> None:
    """The drawing is well-formed XML with each word and the meaning of the utterance."""
    step = Language.load().understand("A knife is used for cutting").derivation
    assert step is not None

    drawn = ElementTree.fromstring(draw_svg([from_derivation(step)]))  # noqa: S314 - our own

    texts = ["".join(each.itertext()) for each in drawn.iter("{http://www.w3.org/2000/svg}text")]
    assert {"knife", "used", "for", "cutting"} <= {*" ".join(texts).split()}
    assert any("implies(knife,cutting,high)" in text for text in texts)


def test_rules_of_a_proof_are_sentences(taught: Agent) -> None:
    """With who told them, as a person would say them."""
    result = taught.hear("pass me something used for cutting").result
    assert result and result.decision

    drawn = draw_svg(
        [
            from_proof(each, taught.dialogue.conversation.describe)
            for each in result.decision.proofs()
        ]
    )

    assert "Sam: a knife is used for" in drawn
    assert "Rule" not in drawn
