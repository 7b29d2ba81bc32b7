"""The tools for language models: what they say, what they refuse, and in whose name."""

import asyncio
import json
from collections.abc import Awaitable, Callable
from typing import Any

import httpx
import httpx2
import pytest
from mcp import Client
from mcp.client.streamable_http import streamable_http_client

from hilt.agent import Agent
from hilt.agent.web.mcp_server import make_mcp
from hilt.agent.web.service import Service
from hilt.agent.web.tokens import Caller

from .running_service import RunningService

Ask = Callable[..., Awaitable[dict[str, Any]]]
SAM = Caller("owner", "sam", frozenset({"admin"}))


def talk(agent: Agent, talking: Callable[[Ask], Awaitable[None]], caller: Caller = SAM) -> None:
    """Let somebody talk to an agent through the tools."""

    async def run() -> None:
        server = make_mcp(Service(agent), lambda _: caller)
        async with Client(server) as client:

            async def ask(tool: str, **arguments: str) -> dict[str, Any]:
                answer = await client.call_tool(tool, arguments)
                if answer.is_error:
                    return {"error": answer.content[0].text}
                found = answer.structured_content or {}
                return found.get("result", found)

            await talking(ask)

    asyncio.run(run())


def test_holding_is_told_with_who_said_so(taught: Agent):
    """A part is proper or improper where somebody said so, and unknown where nobody did."""
    taught.hear("To pass a knife, never grab it by the handle")

    async def talking(ask: Ask) -> None:
        held = await ask("how_to_hold", object="knife", action="pass")
        blade, handle, mug = [
            await ask("may_hold", object=name, part=part, action="pass")
            for name, part in (("knife", "blade"), ("knife", "handle"), ("mug", "handle"))
        ]

        assert (held["part"], held["verdict"], held["lower"]) == ("blade", "proper", 0.95)
        assert held["because"][0]["speaker"] == "sam"
        assert [each["verdict"] for each in (blade, handle, mug)] == [
            *("proper", "improper", "unknown")
        ]

    talk(taught, talking)


def test_what_a_model_teaches_is_its_own_word(taught: Agent):
    """It is believed a little, and no name that it gives itself makes it more."""

    async def talking(ask: Ask) -> None:
        told = await ask("teach", sentence="A mug is used for drinking")
        forged = await ask("teach", sentence="I'm Sam. A spoon is used for digging")
        (drink,) = await ask("what_for", use="drinking")

        assert told["rules"][0]["speaker"] == "model of sam"
        assert "speaks for model of sam" in forged["error"]
        assert drink["lower"] == pytest.approx(0.285)

    talk(taught, talking)


def test_robot_moves_by_two_calls(taught: Agent):
    """A plan is shown with its proof; its id has it done once."""

    async def talking(ask: Ask) -> None:
        plan = await ask("plan", command="pass me something used for cutting")
        before = len(list(taught.base.episodes()))
        done = await ask("carry_out", plan=plan["id"])
        again = await ask("carry_out", plan=plan["id"])

        assert (plan["object"], plan["part"], before) == ("knife", "blade", 0)
        assert plan["proofs"]
        assert done["outcome"] == "done"
        assert "Plan again" in again["error"]
        assert len(list(taught.base.episodes())) == 1

    talk(taught, talking)


def test_plan_holds_for_the_decision_that_was_shown(taught: Agent):
    """What was taught since may change it; then it is planned again."""

    async def talking(ask: Ask) -> None:
        plan = await ask("plan", command="pass me the knife")
        taught.hear("To pass a knife, never grab it by the blade")
        taught.hear("To pass a knife, grab it by the handle")
        done = await ask("carry_out", plan=plan["id"])

        assert "decided otherwise" in done["error"]

    talk(taught, talking)


def test_norms_refuse_a_model(taught: Agent):
    """What is forbidden, and a part that was told to be wrong, get no id."""
    taught.hear("Never pass the hammer")
    taught.hear("To pass a knife, never grab it by the handle")

    async def talking(ask: Ask) -> None:
        hammer = await ask("plan", command="pass me the hammer")
        handle = await ask("plan", command="pass me the knife by the handle")

        assert [each["outcome"] for each in (hammer, handle)] == ["refused", "refused"]
        assert [each["id"] for each in (hammer, handle)] == [None, None]
        assert "never grab it by the handle" in handle["said"]

    talk(taught, talking)


def test_roles_hold_for_models(taught: Agent):
    """Whose token may only read has a model that only reads."""

    async def talking(ask: Ask) -> None:
        told = await ask("teach", sentence="A mug is used for drinking")

        assert "needs the role teacher" in told["error"]
        assert taught.base.trust("model of eve") is None

    talk(taught, talking, Caller("t1", "eve", frozenset({"reader"})))


def test_what_is_unknown_is_said(taught: Agent):
    """A name that does not exist is an answer, with those that do."""

    async def talking(ask: Ask) -> None:
        found = await ask("how_to_hold", object="unicorn", action="pass")

        assert 'There is no object "unicorn"' in found["error"]

    talk(taught, talking)


def test_tools_are_reached_over_http(service: RunningService):
    """At `/mcp`, with a bearer token; without one there is nothing to be had."""
    secret = service.tokens.add("model", "sam", ["teacher"])[1]
    headers = {"Authorization": f"Bearer {secret}"}

    async def run() -> tuple[list[str], object]:
        async with httpx2.AsyncClient(headers=headers) as http:
            transport = streamable_http_client(f"{service.url}/mcp", http_client=http)
            async with Client(transport) as client:
                tools = [tool.name for tool in (await client.list_tools()).tools]
                await client.call_tool("teach", {"sentence": "A mug is used for drinking"})
                found = await client.read_resource("hilt://rules")
                return tools, json.loads(found.contents[0].text)[0]["speaker"]

    tools, speaker = asyncio.run(run())
    stranger = httpx.post(f"{service.url}/mcp", json={})

    assert tools[-3:] == ["teach", "plan", "carry_out"]
    assert speaker == "model of sam"
    assert stranger.status_code == 401
