"""Claims about uses on a material: what is taught, answered and chosen."""

import pytest

from hilt.agent.agent import Agent

LESSONS = (
    "a spatula is often used for cutting wood",
    "a spatula is never used for cutting bread",
    "a knife is used for cutting bread",
    "a spoon is sometimes used for cutting",
    "a screwdriver is often used for painting walls",
)


@pytest.fixture
def skilled(agent: Agent) -> Agent:
    """A mind that was taught uses on several materials, and one on any."""
    for lesson in LESSONS:
        assert agent.hear(lesson).is_done, lesson
    return agent


def test_rule_is_kept_with_its_material(agent: Agent):
    """What is said back, stored and printed as JSON has the material."""
    reply = agent.hear("a spatula is never used for cutting bread")

    assert reply.said == "I learned: a spatula is not used for cutting bread."
    assert [rule.as_json()["material"] for rule in reply.rules] == ["bread"]
    assert [rule.material for rule in agent.base.rules(object="spatula")] == ["bread"]


@pytest.mark.parametrize(
    ("question", "start"),
    [
        ("is a knife used for cutting bread?", "Yes: a knife is used for cutting bread"),
        ("is a knife used for cutting?", "Yes: a knife is used for cutting bread"),
        ("is a knife used for cutting wood?", "Nobody has told me that a"),
        ("is a spatula used for cutting?", "Yes: a spatula is often used for cutting wood"),
        ("is a spatula used for cutting bread?", "No: a spatula is not used for cutting bread"),
        ("is a spoon used for cutting wood?", "Yes: a spoon is sometimes used for cutting."),
        ("what do I cut bread with?", "For cutting bread, I know of a knife and a spoon"),
        ("what do I cut wood with?", "For cutting wood, I know of a spatula (often) and"),
        ("what is used for painting?", "For painting, I know of a screwdriver for walls"),
        ("what is best for cutting wood?", "A spatula is best for cutting wood."),
        ("what is best for cutting?", "A knife is best for cutting bread."),
        ("what is a screwdriver used for?", "A screwdriver is used for painting walls (often)."),
        ("what do you know about cutting bread?", "For cutting bread, I know of a knife"),
        (
            "how sure are you that a knife is used for cutting bread?",
            "Quite sure: a knife is used for cutting bread",
        ),
        ("who told you that a knife is used for cutting wood?", "Nobody has told me that."),
        (
            "what would have to be true of an object for it to be used for cutting bread?",
            "To be used for cutting bread, it would have to be one of these: a knife and a spoon.",
        ),
    ],
)
def test_question_is_answered_for_its_material(skilled: Agent, question: str, start: str):
    """An answer names the material; a denial for one material denies no other."""
    assert skilled.hear(question).said.startswith(start)


@pytest.mark.parametrize(
    ("command", "chosen"),
    [
        ("pass me something to cut bread with", "knife"),
        ("pass me something to cut wood with", "spatula"),
        ("pass me something to cut paper with", "spoon"),
        ("pass me something to cut with", "knife"),
        ("pass me something not used for cutting bread", "spatula"),
    ],
)
def test_object_is_chosen_by_the_material(skilled: Agent, command: str, chosen: str):
    """A tool for another material is not passed."""
    assert skilled.hear(command).said == f"I would pass the {chosen}."


def test_reason_against_an_object_names_the_material(skilled: Agent):
    """The knife was not passed for wood: nobody said that it cuts wood."""
    skilled.hear("pass me something to cut wood with")

    said = skilled.hear("why not the knife?").said

    assert said.endswith("nobody has told me that a knife is used for cutting wood.")


def test_patient_of_a_tool_is_its_material(agent: Agent):
    """Of two tools the one for nails pounds the nail."""
    agent.hear("a shoe is used for pounding tent pegs")
    agent.hear("a hammer is sometimes used for pounding nails")

    assert agent.hear("pound the nail").said == "I would pound the nail with the hammer."


def test_correction_of_a_use_replaces_its_material(agent: Agent):
    """What was said of the walls is taken back by "no, for painting fences"."""
    agent.hear("a screwdriver is used for painting walls")
    agent.hear("no, for painting fences")

    assert [rule.material for rule in agent.base.rules(object="screwdriver")] == ["fence"]


def test_only_the_rule_with_the_material_is_forgotten(skilled: Agent):
    """Forgetting a use on one material leaves that on another."""
    skilled.hear("a knife is used for cutting cheese")
    skilled.hear("forget that a knife is used for cutting bread")

    assert [rule.material for rule in skilled.base.rules(object="knife")] == ["cheese"]


def test_what_nobody_trustworthy_said_is_no_answer(agent: Agent):
    """Trust that was taken away counts in answers at once, as in decisions."""
    agent.base.set_trust("mallory", 1)
    agent.hear("a hammer is used for cutting", speaker="mallory")
    before = agent.hear("what is used for cutting?").said

    agent.base.set_trust("mallory", 0)

    assert before.startswith("For cutting, I know of a hammer")
    assert agent.hear("what is used for cutting?").said.startswith("Nobody has told me")
    assert agent.hear("what is a hammer used for?").said.startswith("I don't know")
