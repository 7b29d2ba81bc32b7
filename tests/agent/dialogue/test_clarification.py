"""The question about a part that was told and did not hold, and what follows from the answer."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import count
from math import comb
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.dialogue.reply import Reply
from hilt.agent.replay import replay
from hilt.kb.episodes import Episode, GraspTrial
from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rule import grasping

CONFIG = AgentConfig(simulate=False, scene="objects:mug,knife")
COMMAND = "pass me the mug"
LEVELS = {"always": 1.0, "generally": 0.95, "often": 0.75, "sometimes": 0.5}
BOUND, TAIL = 0.25, 0.025
NUMBERS = count()


def happened(base: KnowledgeBase, part: str, robot: str = "panda", **outcomes: int) -> None:
    """Record what grasps of the mug by a part came to."""
    trials = [
        GraspTrial("mug", part, "pass", outcome, robot)
        for outcome, times in outcomes.items()
        for _ in range(times)
    ]
    done = Episode(
        goal="pass(self,mug)", text=COMMAND, speaker="sam", outcome="done", said="", seed=0,
        document=f'{{"number": {next(NUMBERS)}}}', trials=tuple(trials),
    )  # fmt: skip
    base.record_episode(done)


@pytest.fixture
def agent() -> Iterator[Agent]:
    """An agent that was told to pass mugs by the barrel."""
    with Agent.open("memory:", CONFIG) as opened:
        opened.hear("To pass a mug, grab it by the barrel")
        yield opened


@pytest.fixture(scope="module", params=LEVELS)
def told(request: pytest.FixtureRequest) -> Iterator[tuple[Agent, float]]:
    """An agent that was told the same to some degree, with this degree."""
    with Agent.open("memory:", CONFIG) as opened:
        opened.hear(f"To pass a mug, {request.param} grab it by the barrel")
        yield opened, LEVELS[request.param]


def chosen(reply: Reply) -> str | None:
    """The part that a command was carried out by; None where Hilt asked."""
    assert reply.result and reply.result.decision
    return reply.result.decision.chosen_part if reply.ending == "done" else None


@given(held=st.integers(0, 12), failed=st.integers(0, 12))
def test_choice_is_questioned_exactly_where_the_interval_says(
    told: tuple[Agent, float], held: int, failed: int
):
    """Hilt asks if the counts reject that the part holds as often as the bound allows."""
    agent, degree = told
    happened(agent.base, "barrel", held=held, slipped=failed)
    share, trials = max(0.0, 1 - BOUND / degree), held + failed
    at_most = sum(comb(trials, k) * share**k * (1 - share) ** (trials - k) for k in range(held + 1))

    reply = agent.hear(COMMAND, keep=False)
    agent.dialogue.hear("never mind", speaker="sam", keep=False)

    assert (reply.ending == "asked") == (at_most < TAIL)
    if trials:
        agent.base.forget_trials("forget", "sam")


def test_told_part_is_questioned_after_three_slips(agent: Agent):
    """Two slips are no reason yet; after the third another part is offered, which is not known."""
    happened(agent.base, "barrel", slipped=2)
    assert chosen(agent.hear(COMMAND)) == "barrel"
    happened(agent.base, "barrel", slipped=1)

    reply = agent.hear(COMMAND)

    assert reply.ending == "asked"
    assert reply.said == (
        "You told me the barrel, but it slipped 3 times of 3. Shall I try the handle?"
    )


@pytest.mark.parametrize(
    ("outcomes", "said"),
    [
        ({"dropped": 4}, "I dropped it 4 times of 4."),
        ({"wrong_part": 4}, "I touched other parts 4 times of 4."),
        ({"missed": 4}, "I missed it 4 times of 4."),
        ({"refused": 4, "held": 1}, "I could not hand it over 4 times of 5."),
        ({"slipped": 3, "dropped": 1}, "it failed 4 times of 4."),
    ],
)
def test_hilt_says_what_happened(agent: Agent, outcomes: dict[str, int], said: str):
    """Each way to fail has its words."""
    happened(agent.base, "barrel", **outcomes)

    assert f"You told me the barrel, but {said}" in agent.hear(COMMAND).said


def test_yes_is_followed_from_then_on_and_changes_no_rule(agent: Agent):
    """The other part is taken, now and later; what was told and the trust stay as they were."""
    happened(agent.base, "barrel", held=1, slipped=4)
    happened(agent.base, "handle", held=5)
    before = agent.base.rules(), agent.base.trust("sam")

    asked = agent.hear(COMMAND)
    answers = [agent.hear("yes"), agent.hear(COMMAND)]

    assert asked.said.endswith("By the handle it held 5 of 5. Shall I take the handle?")
    assert [chosen(each) for each in answers] == ["handle", "handle"]
    assert (agent.base.rules(), agent.base.trust("sam")) == before


@pytest.mark.parametrize(("answer", "part"), [("no", "barrel"), ("by the handle", "handle")])
def test_other_answers_are_followed_too(agent: Agent, answer: str, part: str):
    """After "no" it is done as it was told; a part may be named."""
    happened(agent.base, "barrel", slipped=4)

    replies = [agent.hear(COMMAND), agent.hear(answer), agent.hear(COMMAND)]

    assert [chosen(each) for each in replies] == [None, part, part]


def test_agreement_ends_when_it_fails_as_well(agent: Agent):
    """What happens after an answer may put it in question again."""
    happened(agent.base, "barrel", slipped=4)
    agent.hear(COMMAND)
    agent.hear("no")
    happened(agent.base, "barrel", slipped=2)
    assert chosen(agent.hear(COMMAND)) == "barrel"
    happened(agent.base, "barrel", slipped=1)

    assert agent.hear(COMMAND).ending == "asked"


def test_without_anything_better_it_is_only_asked_whether(agent: Agent):
    """A part that did worse is not offered."""
    happened(agent.base, "barrel", held=1, slipped=5)
    happened(agent.base, "handle", slipped=9)

    asked, answer = agent.hear(COMMAND), agent.hear("yes")

    assert asked.said.endswith("Shall I take it all the same?")
    assert chosen(answer) == "barrel"


def test_forbidden_part_is_never_offered(agent: Agent):
    """However well it held."""
    agent.hear("never grab a mug by the handle")
    happened(agent.base, "barrel", slipped=4)
    happened(agent.base, "handle", held=9)

    assert "handle" not in agent.hear(COMMAND).said


def test_part_that_the_command_names_is_not_questioned(agent: Agent):
    """Who says how knows what they want."""
    happened(agent.base, "barrel", slipped=9)

    assert chosen(agent.hear("pass me the mug by the barrel")) == "barrel"


def test_other_teachers_are_named(agent: Agent):
    """Hilt says who told it the part, and experience of another robot does not count."""
    agent.base.set_trust("anna", 1.0)
    agent.hear("To pass a knife, grab it by the handle", speaker="anna")
    happened(agent.base, "barrel", robot="kuka", slipped=9)
    assert chosen(agent.hear(COMMAND)) == "barrel"
    happened(agent.base, "barrel", slipped=9)

    assert agent.hear(COMMAND, speaker="anna").said.startswith("Sam told me the barrel")


def test_experience_never_changes_the_choice_in_silence(agent: Agent):
    """Where it puts another part that was told first, Hilt asks, even before the bound."""
    rule = grasping("mug", "handle", "pass", interval=Interval(0.9, 1))
    agent.base.believe("A second rule.", "", "sam", [rule])
    happened(agent.base, "barrel", slipped=1)
    assert chosen(agent.hear(COMMAND)) == "barrel"
    happened(agent.base, "barrel", slipped=1)

    asked = agent.hear(COMMAND)

    assert asked.said == (
        "You told me the barrel, but it slipped 2 times of 2. Shall I try the handle?"
    )


def test_experience_survives_a_restart(tmp_path: Path):
    """It is in the base."""
    with Agent.open(str(tmp_path), CONFIG) as first:
        first.hear("To pass a mug, grab it by the barrel")
        happened(first.base, "barrel", slipped=4)

    with Agent.open(str(tmp_path), CONFIG) as second:
        assert second.hear(COMMAND).ending == "asked"


def test_replay_has_the_experience_of_its_time(agent: Agent):
    """What happened since does not change what is run again."""
    happened(agent.base, "barrel", slipped=2)
    agent.hear(COMMAND)
    happened(agent.base, "barrel", slipped=9)
    (done,) = [each for each in agent.base.episodes() if each.said]

    assert replay(agent.base, done.id).result.answer.ending == "done"
