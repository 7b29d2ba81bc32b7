"""Claims about processes that share a real endpoint, or are killed there."""

from __future__ import annotations

from datetime import datetime, timedelta, timezone
from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.execution.embodiment import Embodiment
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.stores import write_lease
from hilt.nlu.language import Language
from hilt.ontology.actions import load_actions

from .. import fleet
from ..endpoints import InMemoryEndpoint
from ..test_episodes import EPISODE

BODILESS = AgentConfig(simulate=False)
LATER = datetime(2026, 11, 23, 9, 0, tzinfo=timezone.utc)


@pytest.mark.parametrize("server", fleet.SERVERS)
def test_processes_share_an_endpoint(server: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path):
    """No sentence is lost or there twice, also when one is killed; nor is an import halved."""
    with fleet.served(server) as location:
        told = fleet.tell_together(location, 3, 18, kill=True)
        fleet.check_told(location, told)
        assert len(told.acknowledged) >= 15

        for lease in ("LEASE_S", "DECIDED_LEASE_S"):
            monkeypatch.setattr(write_lease, lease, 1.0)
        (name, job), *_ = fleet.prepare_jobs(tmp_path, 40).items()
        fleet.reset(location, tmp_path)
        fleet.kill_job(location, name, job, after_s=0.2)


def robot(endpoint: InMemoryEndpoint) -> Agent:
    """An agent without a body that shares a base."""
    base, bodiless = KnowledgeBase(endpoint.open()), Embodiment.from_config(BODILESS)
    return Agent(base, Language.load(), load_actions(), bodiless)


def test_robot_knows_what_another_one_learned():
    """Words and rules, before it answers or decides."""
    endpoint = InMemoryEndpoint()
    teacher, other = robot(endpoint), robot(endpoint)

    teacher.hear("A spork is used for zesting.")
    assert other.hear("What is a spork used for?").said == "A spork is used for zesting."
    assert other.hear("Pass me something used for cutting.").ending == "failed"
    teacher.hear("A knife is used for cutting.")
    assert other.hear("Pass me something used for cutting.").said == "I would pass the knife."


def test_what_a_robot_did_belongs_to_its_own_utterance():
    """Although another one said something in between; its clock may be slow."""
    endpoint = InMemoryEndpoint()
    fast = KnowledgeBase(endpoint.open(), clock=lambda: LATER)
    slow = KnowledgeBase(endpoint.open(), clock=lambda: LATER - timedelta(seconds=3))
    counts = fast.episodes_recorded

    own = fast.record("Pass me the knife.", "", "sam", "command", accepted=True)
    assert slow.record("Hello.", "", "sam", "greeting", accepted=True).time == own.time
    assert slow.record_episode(EPISODE).utterance == 2
    assert fast.record_episode(EPISODE).utterance == own.sequence == 1
    assert fast.episodes_recorded == slow.episodes_recorded != counts
