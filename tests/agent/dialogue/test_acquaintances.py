"""Who speaks after an introduction, and whom that lets nobody become."""

from __future__ import annotations

from hilt.agent import Agent
from hilt.agent.dialogue.acquaintances import Acquaintances


def test_known_person_speaks_from_then_on(agent: Agent) -> None:
    """Until the next one is introduced, under whatever name they are heard."""
    agent.base.set_trust("anna", 0.8)
    people = Acquaintances(agent.base)

    assert people.meet("sam", "Anna").key == "hello"
    assert people.speaker("sam") == "anna"
    assert people.meet("anna", "Sam").key == "hello"
    assert people.speaker("sam") == "sam"


def test_unknown_person_speaks_for_who_spoke_before(agent: Agent) -> None:
    """The name is remembered, and changes no trust."""
    people = Acquaintances(agent.base)

    assert people.meet("sam", "Ottokar").key == "hello_guest"
    assert people.speaker("sam") == "sam"
    assert people.called("sam") == "Ottokar"
    assert agent.base.trust("ottokar") is None


def test_nobody_becomes_trusted_by_a_name(agent: Agent) -> None:
    """A stranger who claims to be Sam stays a stranger."""
    people = Acquaintances(agent.base)

    assert people.meet("eve", "Sam").key == "hello_stranger"
    assert people.speaker("eve") == "eve"


def test_owner_is_who_was_heard_first(agent: Agent) -> None:
    """Of those who are trusted; strangers who come before own nothing."""
    people = Acquaintances(agent.base)
    assert people.owner is None

    agent.hear("A knife is used for cutting", speaker="eve")
    assert people.owner is None

    agent.hear("A knife is used for cutting")
    agent.base.set_trust("anna", 1.0)
    agent.hear("A mug is used for containing", speaker="anna")
    assert people.owner == "sam"


def test_trusted_people_vouch_for_others(agent: Agent) -> None:
    """In words, for one or several; who is vouched for is believed."""
    agent.hear("hello")

    assert agent.hear("You can trust Anna").said == "From now on I trust Anna."
    assert agent.hear("I trust Zoë Ünal and Ben").is_done
    assert agent.hear("A knife is used for cutting", speaker="Anna").is_done
    assert agent.hear("Don't trust Anna any more").is_done
    assert not agent.hear("A mug is used for containing", speaker="Anna").is_done
    assert agent.base.speakers() == ("Ben", "Zoë Ünal", "sam")


def test_nobody_vouches_above_their_own_trust(agent: Agent) -> None:
    """Strangers not at all; others as far as they are trusted, and not against the owner."""
    agent.hear("hello")
    agent.base.set_trust("ben", 0.5)

    assert agent.hear("You can trust Anna", speaker="eve").ending == "refused"
    assert agent.hear("You can trust Anna", speaker="ben").is_done
    trust = agent.base.trust("Anna")
    assert trust is not None and trust.lower == 0.5
    assert agent.hear("You can't trust Sam", speaker="ben").ending == "refused"
    assert agent.hear("I trust Ben", speaker="ben").ending == "refused"
    assert agent.hear("Don't trust Ben").is_done
