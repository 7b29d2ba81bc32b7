"""Abduction by sentence: what would have to be true, which context explains; and reasons why."""

from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.kb.formats.import_export import import_file

EXAMPLES = Path(__file__).parents[3] / "examples"


@pytest.fixture
def pupil(taught: Agent) -> Agent:
    """Taught the running example, and that what is sharp cuts, too."""
    taught.hear("Sharp things are sometimes used for cutting")
    return taught


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        (
            "What would have to be true of an object for it to be used for cutting?",
            "To be used for cutting, it would have to be one of these: a knife and a sharp thing.",
        ),
        (
            "Which context explains that the knife was passed by the blade?",
            "This explains it: to pass a knife, grab it by the blade.",
        ),
        (
            "Which context explains that the knife was held by the handle?",
            "This explains it: to pick up a knife, grab it by the handle.",
        ),
    ],
)
def test_rules_are_read_backwards_when_asked(pupil: Agent, question: str, answer: str):
    """The answer rests on the rules that would bring it about."""
    reply = pupil.hear(question)

    assert (reply.ending, reply.said) == ("done", answer)
    assert reply.rules


@pytest.mark.parametrize(
    "question",
    [
        "What would have to be true of an object for it to be used for rolling?",
        "Which context explains that the knife was passed by the handle?",
        "Which context explains that the mug was held by the blade?",
    ],
)
def test_what_nothing_explains_is_told(pupil: Agent, question: str):
    """No rule, no explanation."""
    reply = pupil.hear(question)

    assert (reply.ending, reply.rules) == ("failed", ())


def test_reasons_of_what_came_from_a_file_are_its_rules():
    """A file says no sentence; and the next best is told apart by how sure it is."""
    with Agent.open(
        "memory:", AgentConfig(simulate=False, actions=EXAMPLES / "kitchen_actions.yaml")
    ) as agent:
        import_file(agent.base, EXAMPLES / "kitchen_rules.yaml")
        agent.hear("A fork is used for stirring")
        agent.hear("A mug is sometimes used for stirring")
        agent.hear("stir the glass")

        why, why_not = agent.hear("why?").said, agent.hear("why not the mug?").said

    assert why == 'Because Sam said: "a spoon is used for stirring".'
    assert why_not == "Not the mug, because I am surer of the spoon."
