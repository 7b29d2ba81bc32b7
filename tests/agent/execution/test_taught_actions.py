"""Actions that were taught by language only, in the simulated world."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
import yaml

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig

pytestmark = pytest.mark.sim

SCENE = "objects:knife,mug,spoon,hammer,nail"
ACTIONS: list[dict[str, Any]] = yaml.safe_load(
    (Path(__file__).parents[1] / "data" / "taught_actions.yaml").read_text(encoding="utf-8")
)


def primitives(agent: Agent, command: str) -> list[str]:
    """The primitives that were carried out for a command, but looking; each blow counts once."""
    result = agent.hear(command).result
    assert result is not None and result.answer.ending == "done", result
    done = [each.node.rsplit("/", 1)[-1] for each in result.steps if each.action == "executed"]
    acts = [each for each in done if each != "findObject"]
    return [each for place, each in enumerate(acts) if each not in acts[:place] or each != "lower"]


@pytest.mark.parametrize("case", ACTIONS, ids=lambda case: str(case["command"]))
def test_what_was_taught_is_carried_out(case: dict[str, Any]):
    """Its primitives are done in order, and the hand holds what it should in the end."""
    with Agent.open("memory:", AgentConfig(scene=SCENE, seed=7)) as agent:
        for text in (*case.get("before", ()), case["taught"]):
            assert agent.hear(text).is_done

        done = primitives(agent, case["command"])

        assert list(dict.fromkeys(done)) == list(dict.fromkeys(case["does"]))
        assert [each for each in done if each not in {"raise", "lower"}] == [
            each for each in case["does"] if each not in {"raise", "lower"}
        ]
        assert (agent.body.holding or "").rstrip("_0123456789") == case.get("holds", "")
