"""A choice among meanings that were offered, in a conversation."""

from __future__ import annotations

from hilt.agent.agent import Agent

UNCLEAR = "a spoon iz nevr usd for cutting"


def test_an_offer_is_not_believed(agent: Agent) -> None:
    """Before a yes there is no rule."""
    reply = agent.hear(UNCLEAR)

    assert reply.ending == "asked"
    assert agent.base.rules() == []


def test_a_yes_confirms_the_only_offer(agent: Agent) -> None:
    """The sentence that says it is heard."""
    agent.hear(UNCLEAR)

    agent.hear("yes")

    assert [str(rule.interval) for rule in agent.base.rules()] == ["[0.00, 0.05]"]


def test_a_number_takes_an_offer(agent: Agent) -> None:
    """So does an ordinal."""
    agent.hear(UNCLEAR)

    agent.hear("the first one")

    assert len(agent.base.rules()) == 1


def test_no_and_neither_take_none(agent: Agent) -> None:
    """And a later yes confirms nothing."""
    for answer in ("no", "neither", "none of them", "never mind"):
        agent.hear(UNCLEAR)

        agent.hear(answer)
        agent.hear("yes")

    assert agent.base.rules() == []


def test_only_who_was_asked_can_choose(agent: Agent) -> None:
    """A number said by somebody else is no answer."""
    agent.hear(UNCLEAR, speaker="sam")

    agent.hear("1", speaker="kim")

    assert agent.base.rules() == []


def test_a_confirmed_phrase_is_remembered(agent: Agent) -> None:
    """It means the same of other names, and is understood at once."""
    agent.hear("a spoon is what comes out here for cutting")
    agent.hear("yes")

    reply = agent.hear("a shoe is what comes out here for cutting")

    assert reply.is_done
    assert [rule.object for rule in agent.base.rules()] == ["spoon", "shoe"]
    assert [each.pattern for each in agent.base.phrases()] == [
        "a ?object is what comes out here for ?affordance"
    ]


def test_a_phrase_that_was_not_confirmed_is_not_remembered(agent: Agent) -> None:
    """After a "no" it is asked about again."""
    agent.hear("a spoon is what comes out here for cutting")
    agent.hear("no")

    assert agent.base.phrases() == []
    assert agent.hear("a shoe is what comes out here for cutting").ending == "asked"
