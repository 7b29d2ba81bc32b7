"""Claims about kinds of things that are told: rules are inherited, and can be taken back."""

from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.kb.formats.import_export import export_file, import_file


def test_rules_about_a_kind_reach_what_is_told_to_be_of_it(agent: Agent):
    """A mug is taken for scooping because a bucket is; after retraction it no longer is."""
    agent.hear("a bucket is used for scooping")
    agent.hear("a beaker is a kind of mug")
    agent.hear("a mug is a kind of bucket")

    chosen = agent.hear("pass me something used for scooping")
    inherited = agent.hear("is a beaker used for scooping?").said
    agent.hear("forget that a mug is a kind of bucket")

    assert chosen.said == "I would pass the mug."
    assert inherited == "Yes: a bucket is used for scooping."
    assert agent.hear("is a beaker used for scooping?").said.startswith("Nobody has told me")


@pytest.mark.parametrize(
    ("question", "answer"),
    [
        (
            "is a bread knife a tool?",
            "Yes: a bread knife is a kind of knife, and a knife is a kind of tool.",
        ),
        ("is a spoon cutlery?", "Yes: a spoon is a kind of cutlery."),
        ("is a mug a knife?", "No: a mug is not a kind of knife."),
        ("is a mug a shoe?", "Nobody has told me that a mug is a kind of shoe."),
        ("what is a bread knife?", "A bread knife is a kind of knife."),
    ],
)
def test_a_question_about_a_kind_is_answered_by_what_was_told(
    agent: Agent, question: str, answer: str
):
    """The answer names the relations on the way, those of the ontology included."""
    for said in ("a bread knife is a knife", "a knife is a tool", "a mug is not a kind of knife"):
        assert agent.hear(said).is_done, said

    assert agent.hear(question).said == answer


def test_nothing_becomes_a_kind_of_itself(agent: Agent):
    """What would close a circle is refused with what is known, and nothing is stored."""
    agent.hear("a bread knife is a kind of knife")

    reply = agent.hear("a knife is a kind of bread knife")

    assert (reply.said, reply.ending) == (
        "That can't be: a bread knife is a kind of knife.",
        "failed",
    )
    assert len(agent.base.rules()) == 1


def test_a_relation_of_kinds_survives_files_and_restarts(tmp_path: Path):
    """It is exported and imported as any rule, and inherited along after a restart."""
    with Agent.open(str(tmp_path / "kb"), AgentConfig(simulate=False)) as agent:
        agent.hear("a clog is a kind of shoe")
        agent.hear("a shoe is used for pounding")
        export_file(agent.base, tmp_path / "rules.yaml")
    with Agent.open("memory:", AgentConfig(simulate=False)) as other:
        import_file(other.base, tmp_path / "rules.yaml")
        assert other.hear("is a clog used for pounding?").said.startswith("Yes: a shoe is used")
    with Agent.open(str(tmp_path / "kb"), AgentConfig(simulate=False)) as again:
        assert again.hear("is a clog a shoe?").said == "Yes: a clog is a kind of shoe."


def test_of_two_teachers_the_more_trusted_one_prevails(agent: Agent):
    """What somebody denies who is trusted less does not end a relation."""
    agent.base.set_trust("kim", 0.3)
    agent.hear("a clog is a kind of shoe")
    agent.hear("a clog is not a kind of shoe", speaker="kim")
    agent.hear("a shoe is used for pounding")

    assert agent.hear("is a clog used for pounding?").said.startswith("Yes")


def test_a_kind_can_be_corrected_and_taken_back(agent: Agent):
    """A correction replaces the relation told last; "forget that" means it, too."""
    agent.hear("a mallet is a kind of spoon")
    corrected = agent.hear("no, a mallet is a kind of hammer")
    kinds = [str(rule.argument) for rule in agent.base.rules()]
    agent.hear("forget that")

    assert corrected.understanding.kind == "correction"
    assert kinds == ["object:hammer"]
    assert agent.base.rules() == []
