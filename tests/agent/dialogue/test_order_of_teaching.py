"""What is concluded depends on the set of what was told: not on its order, nor on repetition."""

import random

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.kb.interval import Interval

LESSONS = [
    ("A knife is often used for cutting", "sam"),
    ("A knife is sometimes used for cutting", "kim"),
    ("A knife is occasionally used for cutting", "ann"),
    ("A spoon is never used for cutting", "sam"),
    ("A spoon is generally used for cutting", "kim"),
    ("Sharp things are sometimes used for cutting", "ann"),
    ("To pass a knife grab the knife by the blade", "sam"),
    ("To pass a knife often grab the knife by the handle", "kim"),
]


def concluded(lessons: list[tuple[str, str]]) -> dict[tuple[str, str], Interval]:
    """What a mind concludes about each thing and each part, after these lessons."""
    with Agent.open("memory:", AgentConfig(simulate=False)) as agent:
        for speaker, trust in (("kim", 0.8), ("ann", 0.6)):
            agent.base.set_trust(speaker, trust)
        for sentence, speaker in lessons:
            assert agent.hear(sentence, speaker=speaker).is_done, sentence
        reply = agent.hear("pass me something used for cutting")
    assert reply.result is not None and reply.result.decision is not None
    decision = reply.result.decision
    assert decision.part is not None
    return {
        (candidate.name, str(candidate.argument)): candidate.interval
        for candidate in (*decision.object.candidates, *decision.part.candidates)
    }


@pytest.fixture(scope="module")
def in_order() -> dict[tuple[str, str], Interval]:
    """What follows of the lessons as they stand."""
    return concluded(LESSONS)


@pytest.mark.parametrize("seed", range(4))
def test_shuffled_and_doubled_teaching_concludes_the_same_bits(
    seed: int, in_order: dict[tuple[str, str], Interval]
):
    """Three speakers of different trust, negative rules, rules of properties, rival parts."""
    lessons = [*LESSONS, *LESSONS]
    random.Random(seed).shuffle(lessons)  # noqa: S311 - not for secrets

    assert concluded(lessons) == in_order


def test_every_speaker_and_every_rule_counts(in_order: dict[tuple[str, str], Interval]):
    """Sam, Kim to .8 and Ann to .6 make the knife surer than any of them alone."""
    knife = in_order["knife", "affordance:cutting"]
    spoon = in_order["spoon", "affordance:cutting"]
    missed = (1 - 0.75) * (1 - 0.8 * 0.5) * (1 - 0.6 * 0.25) * (1 - 0.6 * 0.5)

    assert knife.lower == pytest.approx(1 - missed)
    assert spoon.upper < 1
    assert {part for _, part in in_order if part.startswith("part")} == {
        "part:blade",
        "part:handle",
    }
