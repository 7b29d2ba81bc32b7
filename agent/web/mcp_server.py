"""Tools for language-model agents, by the Model Context Protocol: a memory of norms that refuses.

To move the robot takes two calls: a plan with its proof, and then its one-time id, which holds for
a minute and for the decision that was shown. What a model teaches is told by a speaker of its own,
"model of sam", who is trusted little, and never by the one for whom it works.
"""

import json
import secrets
import time
from collections.abc import Awaitable, Callable, Sequence
from contextlib import AbstractAsyncContextManager
from functools import wraps
from inspect import iscoroutinefunction
from typing import Any, Literal, cast

from mcp.server.mcpserver import Context, MCPServer
from mcp.server.mcpserver.exceptions import ToolError
from mcp.server.transport_security import TransportSecuritySettings
from pydantic import BaseModel, Field
from starlette.applications import Starlette
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection
from starlette.routing import Route
from starlette.types import Receive, Scope, Send

from ...inference.types import Candidate, Target
from ...ontology.errors import HiltError
from ..documents import Explanation
from ..execution.request import Request
from .problems import Problem, problem_of
from .sayings import Said
from .security import CALLER, Gate
from .service import Service
from .tokens import Caller

TRUST = 0.3  # in what a model teaches, until somebody says otherwise
PLAN_SECONDS = 60
WhoAsks = Callable[[Context[Any]], Caller]
_INSTRUCTIONS = (
    "Ask how_to_hold and may_hold before something is handled, and what_for to find a tool. "
    "A command is planned with plan, and done with carry_out and the id of the plan. "
    "A refusal says whose norm it is: ask for what is proper, do not ask again for the same."
)


class Finding(BaseModel):
    """What follows for an object or a part of it, with the interval and the rules behind it."""

    object: str
    part: str | None = None
    verdict: Literal["proper", "improper", "unknown"] = "unknown"
    lower: float = 0.0
    upper: float = 1.0
    because: list[dict[str, Any]] = []


class CommandPlan(BaseModel):
    """What would be done, and the id to have it done; none where it is not to be done."""

    outcome: str
    said: str
    id: str | None = Field(default=None, description=f"for carry_out, within {PLAN_SECONDS} s")
    object: str | None = None
    part: str | None = None
    proofs: list[dict[str, Any]] = []


def make_mcp(service: Service, who: WhoAsks) -> MCPServer[Any]:
    """Return the tools and resources over a service, for the caller that a context names."""
    server = MCPServer[Any]("hilt", instructions=_INSTRUCTIONS, log_level="WARNING")
    tools = ModelTools(service, who)
    asking = (tools.how_to_hold, tools.may_hold, tools.what_for, tools.explain)
    for tool in (*asking, tools.teach, tools.plan, tools.carry_out):
        server.add_tool(_told(tool))

    @server.resource("hilt://rules", mime_type="application/json")
    def rules() -> str:  # pyright: ignore[reportUnusedFunction]
        """The rules that hold now."""
        return json.dumps([rule.as_json() for rule in service.base.rules()])

    @server.resource("hilt://scene", mime_type="application/json")
    def scene() -> str:  # pyright: ignore[reportUnusedFunction]
        """What stands on the table."""
        return json.dumps(service.scene_as_json())

    return server


def add_endpoint(app: Starlette, service: Service, gate: Gate) -> AbstractAsyncContextManager[None]:
    """Add `/mcp` to an application; the context is to be open while that runs.

    Who asks shows a bearer token with every request.
    """

    def who(context: Context[Any]) -> Caller:
        return cast(HTTPConnection, context.request_context.request).scope[CALLER]

    server = make_mcp(service, who)
    doors = TransportSecuritySettings(enable_dns_rebinding_protection=False)  # ours are checked
    endpoint = server.streamable_http_app(stateless_http=True, transport_security=doors)

    class Guarded:
        async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
            gate.caller_of(HTTPConnection(scope), cookies=False)
            await endpoint(scope, receive, send)

    app.router.routes.append(Route("/mcp", Guarded()))
    return server.session_manager.run()


class ModelTools:
    """The tools; their docstrings are what a model reads."""

    def __init__(self, service: Service, who: WhoAsks) -> None:
        self._service, self._who = service, who
        self._plans: dict[str, tuple[CommandPlan, str, Caller, float]] = {}  # and until when

    def how_to_hold(self, object: str, action: str, context: Context[Any]) -> Finding:
        """By which part an object ("knife") is held for an action ("pass", "pickUp")."""
        held = self._held(object, action, context)
        proper = next((each for each in held if each.verdict == "accepted"), None)
        return self._finding(proper) if proper else Finding(object=object)

    def may_hold(self, object: str, part: str, action: str, context: Context[Any]) -> Finding:
        """Whether an object may be held by a part for an action: proper, improper or unknown."""
        held = self._held(object, action, context)
        found = next((each for each in held if each.part == part), None)
        return self._finding(found) if found else Finding(object=object, part=part)

    def _held(self, name: str, action: str, context: Context[Any]) -> Sequence[Candidate]:
        caller = self._model(context)
        target = {"object": Target(object=name), "recipient": caller.speaker}
        with self._service.deciding([], f"objects:{name}") as agent:
            decision = agent.attempt("", Request(action, target, caller.speaker))[0].decision
        return decision.part.candidates if decision and decision.part else ()

    def what_for(self, use: str, context: Context[Any]) -> list[Finding]:
        """Which objects in view are used for something ("cutting"), surest first."""
        caller = self._model(context)
        target = {"object": Target(used_for=use), "recipient": caller.speaker}
        with self._service.deciding([]) as agent:
            decision = agent.attempt("", Request("pass", target, caller.speaker))[0].decision
        found = decision.object.candidates if decision else ()
        return [self._finding(each) for each in found if each.accepted]

    def explain(self, command: str, context: Context[Any]) -> dict[str, Any]:
        """The proof of what would be decided for a command, and what would change it."""
        with self._service.deciding([]) as agent:
            return Explanation(agent, command, self._model(context).speaker).as_json()

    async def teach(self, sentence: str, context: Context[Any]) -> dict[str, Any]:
        """Teach one sentence: "A knife is used for cutting". It counts as little trusted."""
        caller = await self._introduced(context)
        return await self._service.say(Said(text=sentence), caller, "tell").answered()

    async def plan(self, command: str, context: Context[Any]) -> CommandPlan:
        """Decide a command ("pass me the knife by the blade"), with its proof; nothing moves."""
        caller = await self._introduced(context)
        plan = await run_in_threadpool(self._planned, command, caller)
        if plan.outcome == "done":
            now = time.monotonic()
            self._plans = {id_: each for id_, each in self._plans.items() if each[-1] > now}
            plan.id = secrets.token_urlsafe(12)
            self._plans[plan.id] = plan, command, caller, now + PLAN_SECONDS
        return plan

    async def carry_out(self, plan: str, context: Context[Any]) -> dict[str, Any]:
        """Do what was planned, by the id of the plan; each id counts once."""
        caller, found = self._model(context), self._plans.pop(plan, None)
        if found is None or found[2] != caller or found[3] < time.monotonic():
            raise ToolError("There is no such plan of yours, or it is too old. Plan again.")
        planned, command, *_ = found
        again = await run_in_threadpool(self._planned, command, caller)
        if (again.object, again.part, again.outcome) != (planned.object, planned.part, "done"):
            raise ToolError(f"It would be decided otherwise now: {again.said} Plan again.")
        self._service.lease(caller, PLAN_SECONDS)
        try:
            return await self._service.say(Said(text=command), caller, "do").answered()
        finally:
            self._service.lease(caller, 0)

    def _planned(self, command: str, caller: Caller) -> CommandPlan:
        with self._service.deciding([]) as agent:
            reply = agent.hear(command, speaker=caller.speaker, only="do", keep=False)
            decision = reply.decision
            known: dict[str, Any] = {"proofs": decision.proofs_as_json()} if decision else {}
            part, named = (decision.part, decision.named_part) if decision else (None, None)
            denied = part.denied if part and named else ()
            against = [rule for each in denied if each.part == named for rule in each.rules]
            if against:  # a person may name another part than was told; a model may not
                because = "; ".join(agent.dialogue.conversation.words_of(rule) for rule in against)
                return CommandPlan(outcome="refused", said=f"I was told: {because}", **known)
            if decision and decision.object.best:
                known |= {"object": decision.object.best.object, "part": decision.chosen_part}
            return CommandPlan(outcome=reply.ending, said=reply.said, **known)

    async def _introduced(self, context: Context[Any]) -> Caller:
        """The model, of whom the base knows from now on how far it is trusted."""
        caller, base = self._model(context), self._service.base

        def introduce() -> None:
            if base.trust(caller.speaker) is None and caller.roles & {"teacher", "operator"}:
                base.set_trust(caller.speaker, TRUST)

        await self._service.run(introduce)
        return caller

    def _finding(self, found: Candidate) -> Finding:
        verdicts: dict[str, Any] = {"accepted": "proper", "denied": "improper"}
        words_of = self._service.agent.dialogue.conversation.words_of
        return Finding(
            object=found.object,
            part=found.part,
            verdict=verdicts.get(found.verdict, "unknown"),
            lower=found.interval.lower,
            upper=found.interval.upper,
            because=[rule.as_json() | {"said": words_of(rule)} for rule in found.rules],
        )

    def _model(self, context: Context[Any]) -> Caller:
        owner = self._who(context)
        roles = {"teacher", "operator"} if owner.may("admin") else owner.roles
        return Caller(owner.id, f"model of {owner.speaker}", frozenset(roles))


def _told(tool: Callable[..., Any]) -> Callable[..., Awaitable[Any]]:
    """Let a model read why it is refused; what decides does so in a thread."""

    @wraps(tool)
    async def told(*given: Any, **named: Any) -> Any:
        try:
            if iscoroutinefunction(tool):
                return await tool(*given, **named)
            return await run_in_threadpool(tool, *given, **named)
        except (Problem, HiltError) as error:
            raise ToolError(problem_of(error).detail) from error

    return told
