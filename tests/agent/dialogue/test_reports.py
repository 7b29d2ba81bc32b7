"""What somebody told the speaker: a rule of that person, as sure as both are trusted."""

from __future__ import annotations

import pytest

from hilt.agent import Agent

REPORT = "Anna told me that a knife is used for cutting"


def test_what_somebody_told_the_speaker_is_that_persons_rule(agent: Agent):
    """The rule is attributed to that person, the utterance to the speaker."""
    (rule,) = agent.hear(REPORT).rules

    assert (rule.object, rule.affordance, rule.speaker) == ("knife", "cutting", "anna")
    assert agent.base.utterance(rule.utterance or 0).speaker == "sam"


def test_a_report_is_as_sure_as_both_are_trusted(agent: Agent):
    """Half of the trust in Sam and half of that in Anna leave a quarter."""
    agent.base.set_trust("Anna", 0.5)
    agent.base.set_trust("sam", 0.5)

    (rule,) = agent.hear(REPORT).rules

    assert rule.speaker == "Anna"
    assert rule.interval.lower == pytest.approx(0.475)
    assert rule.support.lower == pytest.approx(0.2375)


def test_an_unknown_person_is_not_relied_on_before_being_trusted(agent: Agent):
    """The rule is kept, and counts from the moment when the person is trusted."""
    reply = agent.hear(REPORT)
    before = agent.hear("is a knife used for cutting?")
    agent.base.set_trust(agent.base.match_speaker("Anna"), 0.8)

    assert "don't know Anna" in reply.said
    assert not before.said.startswith("Yes")
    assert agent.hear("is a knife used for cutting?").said.startswith("Yes")


def test_who_told_it_names_both(agent: Agent):
    """The answer says who told whom, in the words that were said."""
    agent.hear(REPORT)

    said = agent.hear("who told you that?").said

    assert said.startswith("Anna told Sam, who told me")
    assert REPORT in said


def test_who_reported_a_rule_may_take_it_back(agent: Agent):
    """It is then no longer believed."""
    agent.hear(REPORT)

    agent.hear("forget that")

    assert agent.base.rules() == []


def test_what_completes_a_report_is_the_speakers_own(agent: Agent):
    """Of Anna nothing is said by "and a mug, too"."""
    agent.hear(REPORT)

    (rule,) = agent.hear("and a mug, too").rules

    assert (rule.object, rule.speaker) == ("mug", "sam")


def test_a_report_of_nobody_with_a_name_is_asked_about(agent: Agent):
    """A "yes" makes it the speaker's own rule."""
    asked = agent.hear("my mother told me that a knife is used for cutting")
    agent.hear("yes")

    (rule,) = agent.base.rules()
    assert asked.ending == "asked"
    assert rule.speaker == "sam"
