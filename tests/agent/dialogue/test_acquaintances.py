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
