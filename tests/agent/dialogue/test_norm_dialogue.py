"""Norms in conversations: kept, told, lifted by whom they belong to, and asked about."""

from __future__ import annotations

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig

NEVER = "Never pick up the mug"


def ending(agent: Agent, text: str, speaker: str = "sam") -> str:
    """How a turn ends."""
    return agent.hear(text, speaker=speaker).ending


def test_prohibition_is_kept_and_its_sentence_told(agent: Agent):
    """What was agreed to is not done, and who said it is told."""
    agent.hear(NEVER)

    assert agent.hear("pick up the mug").said == (
        'I won\'t pick up the mug. Sam told me: "Never pick up the mug".'
    )
    assert agent.hear("why not?").said == 'Because Sam said: "Never pick up the mug".'
    assert "Sam told me" in agent.hear("who said so?").said
    assert agent.hear("may you pick up the mug?").said.startswith("No.")
    assert ending(agent, "point to the mug") == "done"


def test_prohibition_survives_a_restart(tmp_path_factory: pytest.TempPathFactory):
    """It is in the base, not in the conversation."""
    folder = str(tmp_path_factory.mktemp("kb") / "kb")
    config = AgentConfig(simulate=False)
    with Agent.open(folder, config) as agent:
        agent.hear(NEVER)

    with Agent.open(folder, config) as agent:
        assert ending(agent, "pick up the mug") == "refused"


@pytest.mark.parametrize("lifting", ["you may pick up the mug again", "forget that"])
def test_who_forbade_it_may_lift_it(agent: Agent, lifting: str):
    """After that it is done."""
    agent.hear(NEVER)
    agent.hear(lifting)

    assert ending(agent, "pick up the mug") == "done"


@pytest.mark.parametrize("lifting", ["you may pick up the mug", "forget that"])
def test_who_is_trusted_less_may_not_lift_it(agent: Agent, lifting: str):
    """The answer names who can, and it stays forbidden."""
    agent.base.set_trust("kim", 0.8)
    agent.hear(NEVER)

    assert "nly Sam can" in agent.hear(lifting, speaker="kim").said
    assert ending(agent, "pick up the mug") == "refused"


def test_who_is_trusted_more_may_lift_it(agent: Agent):
    """Sam is trusted more than Kim."""
    agent.base.set_trust("kim", 0.8)
    agent.hear(NEVER, speaker="kim")
    assert ending(agent, "pick up the mug") == "refused"

    agent.hear("you may pick up the mug")

    assert ending(agent, "pick up the mug") == "done"


def test_role_of_the_recipient_counts(agent: Agent):
    """A child is not given a knife, somebody else is."""
    agent.hear("You must not pass a knife to a child")

    assert ending(agent, "pass the knife to the child") == "refused"
    assert ending(agent, "pass the knife to Anna") == "done"
    assert ending(agent, "pass the spoon to the child") == "done"


def test_only_those_named_are_given_it(agent: Agent):
    """The permission is more specific than the prohibition for all."""
    agent.hear("Only adults may get knives")

    assert ending(agent, "pass the knife to the adult") == "done"
    assert ending(agent, "pass the knife to the child") == "refused"


def test_norm_holds_in_its_place():
    """In the kitchen, and nowhere else."""
    for place, expected in (("place:kitchen", "refused"), ("place:garden", "done")):
        config = AgentConfig(simulate=False, contexts=(place,))
        with Agent.open("memory:", config) as agent:
            agent.hear("in the kitchen, never pass a knife")
            assert ending(agent, "pass me the knife") == expected


def test_part_that_alone_is_allowed_is_taken(agent: Agent):
    """Whatever else was taught about holding it."""
    agent.hear("to pass a knife, grab it by the blade")
    agent.hear("you may only pass a knife by the handle")

    assert agent.hear("pass me the knife").said == "I would pass the knife by the handle."
    assert ending(agent, "pass me the knife by the blade") == "refused"


def test_what_must_come_first_is_offered_and_done(agent: Agent):
    """A "yes" does both; each new act needs it again."""
    agent.hear("always point to a knife before passing it")

    assert "Should I point to the knife first?" in agent.hear("pass me the knife").said
    assert agent.hear("yes").said == "I would point to the knife. I would pass the knife."
    assert ending(agent, "pass me the knife") == "asked"
    agent.hear("you need not point to a knife before you pass it")
    assert ending(agent, "pass me the knife") == "done"


def test_property_that_nobody_can_see_is_asked_about(agent: Agent):
    """A hot mug looks like a cold one."""
    agent.hear("never pick up anything hot")

    assert agent.hear("pick up the mug").said.startswith("I can't see if the mug is hot")
    assert ending(agent, "yes") == "done"


def test_property_that_is_seen_counts(agent: Agent):
    """A knife is sharp, a spoon is not."""
    agent.hear("never pass anything sharp to a child")

    assert ending(agent, "pass the knife to the child") == "refused"
    assert ending(agent, "pass the spoon to the child") == "done"


def test_another_object_is_taken_for_one_that_is_forbidden():
    """Something for cutting that may be passed is there, too."""
    with Agent.open("memory:", AgentConfig(scene="objects:knife,spatula", simulate=False)) as agent:
        agent.hear("a knife is used for cutting")
        agent.hear("a spatula is often used for cutting")
        agent.hear("never touch the knife")

        assert agent.hear("pass me something used for cutting").said == "I would pass the spatula."


def test_prohibition_of_the_moment_covers_what_is_described(agent: Agent):
    """Not the knife means not the knife, however it is asked for; a "yes" ends it."""
    agent.hear("a knife is used for cutting")
    agent.hear("don't pass me the knife")

    asked = agent.hear("pass me something used for cutting")
    assert asked.said == 'Sam told me: "don\'t pass me the knife". Should I do it all the same?'
    assert ending(agent, "yes") == "done"
    assert ending(agent, "pass me the knife") == "done"


def test_what_is_forbidden_is_listed(agent: Agent):
    """With what may be done in spite of it."""
    assert agent.hear("what must you not do?").said == "Nobody has forbidden me anything."
    agent.hear("Don't hand knives to children")

    assert agent.hear("what are you not allowed to do?").said == (
        "I must not pass a knife to a child."
    )


def test_more_specific_norm_prevails_and_is_explained(agent: Agent):
    """The permission by the handle is more specific than the prohibition."""
    agent.hear("never pick up the mug")
    agent.hear("you may pick up the mug by the handle")

    reply = agent.hear("pick up the mug by the handle")
    assert reply.is_done
    assert reply.result is not None
    assert [each.reason for each in reply.result.verdicts[0].conflicts] == ["more specific"]


def test_stranger_lays_down_no_norm(agent: Agent):
    """Who is not trusted is not believed."""
    assert ending(agent, NEVER, "mallory") == "refused"
    assert ending(agent, "pick up the mug") == "done"


def test_norm_on_a_kind_holds_for_what_is_of_it(agent: Agent):
    """A hammer is a tool, and a shoe is none."""
    agent.hear("Don't hand tools to children")

    assert ending(agent, "pass the hammer to the child") == "refused"
    assert ending(agent, "pass the shoe to the child") == "done"


def test_permission_to_do_what_is_a_duty_does_not_end_the_duty(agent: Agent):
    """The rim is wanted still, although to hold it there is allowed, too."""
    agent.hear("You must touch the mug only by the rim")
    agent.hear("You may touch the mug by the rim")

    assert ending(agent, "pass me the mug by the handle") == "refused"


@pytest.mark.parametrize("person", ["boy", "girl", "toddler", "child"])
def test_norm_about_children_holds_for_every_kind_of_child(agent: Agent, person: str):
    """What must not be given to children is given to no boy and no girl, but to other people."""
    agent.hear("Don't hand knives to children.")

    assert ending(agent, f"hand the knife to the {person}") == "refused"
    assert ending(agent, "hand the knife to the teacher") == "done"
