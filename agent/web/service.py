"""The agent as a service: one thread hears and moves, others read.

What is said waits in one queue, so a conversation has an order; "stop" and "wait" pass it by. Who
holds the lease of the robot commands it alone.
"""

from __future__ import annotations

import asyncio
import secrets
import time
from collections import OrderedDict
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from itertools import count
from typing import Literal, TypeVar

from pydantic import BaseModel, Field
from starlette.concurrency import run_in_threadpool

from ...kb.knowledge_base import KnowledgeBase
from ...nlu.parsing.understanding import Understanding
from ...nlu.semantics import meaning
from ..agent import Agent
from ..config import AgentConfig
from ..dialogue.manager import KINDS
from ..dialogue.reply import OpenQuestion, Reply
from ..execution.embodiment import Embodiment
from ..execution.outcome import Json, WalkStep
from .events import Hub, news
from .live_scene import LiveScene
from .problems import Problem, forbidden
from .security import check_role
from .tokens import Caller

T = TypeVar("T")
Listens = Literal["tell", "ask", "do"] | None
MOST_WAITING = 3  # utterances behind the one that is heard
MOST_KEPT = 1_000  # jobs, whose answers can be asked for
CONFIRM_SECONDS = 60
GOODBYE_SECONDS = 1.0  # for readers of events
STOP_SECONDS = 10.0  # in which a motion may end when the service does
_ROLES = {"tell": "teacher", "do": "operator"}
_STATEMENTS, _COMMANDS = {*KINDS["tell"]}, {*KINDS["do"]}


class Alternative(BaseModel):
    """What a recogniser may have heard instead."""

    text: str = Field(max_length=2000)
    heard: float = Field(default=1.0, ge=0, le=1)


class Said(BaseModel):
    """What somebody says; `heard` is the confidence of a recogniser, best alternative first."""

    text: str = Field(min_length=1, max_length=2000)
    heard: float = Field(default=1.0, ge=0, le=1)
    alternatives: list[Alternative] = Field(default=[], max_length=10)
    context: list[str] = Field(default=[], max_length=20, description="place:kitchen, ...")
    dry: bool = Field(default=False, description="decide a command, and do not move")
    speaker: str | None = Field(default=None, max_length=200, description="an admin may name one")


@dataclass
class Job:
    """One utterance that is to be heard, and how far that is."""

    id: str
    said: Said
    caller: Caller
    listens: Listens
    stops: int
    state: Literal["queued", "begun", "done"] = "queued"
    answer: asyncio.Future[Json] = field(default_factory=asyncio.Future)

    def as_json(self) -> Json:
        """How far it is, and its answer once it has one."""
        known = {"id": self.id, "text": self.said.text, "speaker": self.speaker}
        failed = self.answer.done() and self.answer.exception()
        done = self.answer.result() if self.answer.done() and not failed else None
        return known | {"state": self.state, "answer": done, "error": str(failed or "") or None}

    async def answered(self) -> Json:
        """The answer, when there is one; who asked may go away meanwhile."""
        return await asyncio.shield(self.answer)

    @property
    def speaker(self) -> str:
        """Who says it: whom the token stands for; an admin may name another."""
        return self.said.speaker or self.caller.speaker


class Service:
    """An agent that many may talk to; it is closed with the service.

    Attributes:
        agent: which hears; another one after the table is set anew.
        hub: where what happens is made known.
        is_stopping: whether nothing new is begun.
    """

    def __init__(self, agent: Agent) -> None:
        self.agent, self.hub = agent, Hub()
        self.is_stopping = False
        self.jobs = OrderedDict[str, Job]()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="agent")
        self._numbers, self._stops = count(1), 0
        self._current: Job | None = None
        self._by_key = OrderedDict[tuple[str, str], Job]()
        self._asked: tuple[str, OpenQuestion, str, float] | None = None
        self._lease: tuple[Caller, float] | None = None
        self._told, self._scenes = agent.base.sequence, count(1)
        self.live_scene: LiveScene | None = None
        agent.watchers.append(self._on_step)

    @property
    def base(self) -> KnowledgeBase:
        """What is known."""
        return self.agent.base

    @property
    def waiting(self) -> int:
        """How many utterances wait to be heard."""
        return sum(job.state == "queued" for job in self.jobs.values())

    async def run(self, work: Callable[[], T]) -> T:
        """Do something in the thread of the agent, and make known what it changed."""

        def told() -> T:
            try:
                return work()
            finally:
                self._tell_news()

        self._check_open()
        return await asyncio.get_running_loop().run_in_executor(self._thread, told)

    # --- What is said ---------------------------------------------------------------------------

    def say(self, said: Said, caller: Caller, listens: Listens, key: str | None = None) -> Job:
        """Begin to hear an utterance; with the key of an earlier one, return that.

        Problem 403 if somebody may not say that, 409 if too many wait or another has the robot.
        """
        known = self._by_key.get((caller.id, key)) if key else None
        if known:
            if (known.said, known.listens) != (said, listens):
                raise Problem(422, "key", "Used before", "The key belongs to another request.")
            return known
        self._check(said, caller, listens)
        job = Job(f"c{next(self._numbers)}", said, caller, listens, self._stops)
        self.jobs[job.id] = job
        if key:
            self._by_key[caller.id, key] = job
        for kept in (self.jobs, self._by_key):
            while len(kept) > MOST_KEPT:
                kept.popitem(last=False)
        self._publish_job(job)
        job.answer = asyncio.ensure_future(self._heard(job))
        job.answer.add_done_callback(lambda done: done.cancelled() or done.exception())
        return job

    def _check(self, said: Said, caller: Caller, listens: Listens) -> None:
        self._check_open()
        if listens in _ROLES:
            check_role(caller, _ROLES[listens])
        if said.speaker not in {None, caller.speaker} and not caller.may("admin"):
            raise forbidden(f"This token speaks for {caller.speaker}.", needs="admin")
        if said.dry and listens != "do":
            raise Problem(422, "wrong-form", "Not of the expected form", "Only commands are dry.")
        if listens == "do" and not said.dry:
            self.check_lease(caller)
        if self.waiting >= MOST_WAITING:
            busy = self._current.speaker if self._current else caller.speaker
            raise Problem(409, "busy", "Busy", f"{busy} is heard, and {self.waiting} wait.")

    async def _heard(self, job: Job) -> Json:
        loop = asyncio.get_running_loop()
        try:
            if job.said.dry:
                return await run_in_threadpool(self._decided, job)
            if self.agent.is_busy and await run_in_threadpool(self._is_control, job):
                return await run_in_threadpool(self._hear, job)  # it interrupts
            return await loop.run_in_executor(self._thread, self._hear, job)
        finally:
            job.state = "done"
            self._publish_job(job)

    def _is_control(self, job: Job) -> bool:
        understood = self.agent.dialogue.conversation.language.understand(job.said.text)
        return isinstance(understood.meaning, meaning.Control)

    def _decided(self, job: Job) -> Json:
        with self.deciding(job.said.context) as agent:
            reply = agent.hear(job.said.text, speaker=job.speaker, only="do", keep=False)
        return reply.as_do_json()

    @contextmanager
    def deciding(self, contexts: list[str], scene: str | None = None) -> Generator[Agent]:
        """An agent for the block that knows the same, keeps nothing and moves nothing."""
        agent, embodiment = self.agent, self.agent.embodiment
        chosen = embodiment.scene
        if scene is not None:
            chosen = Embodiment.from_config(replace(agent.config, scene=safe_scene(scene))).scene
        with agent.in_scene(chosen) as other:
            other.dialogue.contexts.update(agent.dialogue.contexts)
            other.dialogue.contexts.update(AgentConfig(contexts=(*contexts,)).context_intervals())
            yield other

    def _hear(self, job: Job) -> Json:
        if job.stops != self._stops:
            raise Problem(409, "stopped", "Stopped", "The robot was stopped before this.")
        job.state, outer, self._current = "begun", self._current, job
        self._publish_job(job)
        before = dict(self.agent.dialogue.contexts)
        try:
            contexts = AgentConfig(contexts=(*job.said.context,)).context_intervals()
            self.agent.dialogue.contexts.update(contexts)
            found = self._reply(job)
            self._tell_news(found)
            return found
        finally:
            self.agent.dialogue.contexts.clear()
            self.agent.dialogue.contexts.update(before)
            self._current = outer

    def _reply(self, job: Job) -> Json:
        conversation = self.agent.dialogue.conversation
        text, heard = self._likeliest(job)
        self._check_content(job, text)
        reply = self.agent.hear(text, speaker=job.speaker, only=job.listens, heard=heard)
        found = reply_as_json(reply, job.listens)
        asked, self._asked = conversation.open_question, None
        if asked is not None and not self._may_answer(job.caller, reply, asked):
            conversation.open_question = asked = None
        if asked is not None and reply.ending == "asked":
            until = time.monotonic() + CONFIRM_SECONDS
            self._asked = (secrets.token_urlsafe(16), asked, job.caller.id, until)
            found |= {"confirm": self._asked[0], "expires_s": CONFIRM_SECONDS}
        if reply.decision:
            decision = {"decision": reply.decision.as_json()}
            proofs = {"proofs": reply.decision.proofs_as_json()}
            self.hub.publish({"type": "decision", "command": job.id, **decision, **proofs})
        if reply.result and reply.result.world.touched:
            touched = {"parts": [*reply.result.world.touched]}
            self.hub.publish({"type": "touch", "command": job.id, **touched})
        return found

    def _likeliest(self, job: Job) -> tuple[str, float]:
        said = job.said
        for each in (said, *said.alternatives) if said.alternatives else ():
            if self._understood(each.text, job.speaker).kind != "error":
                return each.text, each.heard
        return said.text, said.heard

    def _understood(self, text: str, speaker: str) -> Understanding:
        return self.agent.dialogue.conversation.understand(text, speaker, heard=1.0)

    def _check_content(self, job: Job, text: str) -> None:
        """Refuse what the words themselves ask for, and the caller may not."""
        if job.caller.may("admin"):
            return
        conversation = self.agent.dialogue.conversation
        asked, question = self._asked, conversation.open_question
        was_own = asked is not None and asked[1] is question and asked[2] == job.caller.id
        if question and question.asked == job.speaker and not was_own:
            conversation.open_question = None
        introduction = conversation.language.introduction(text)
        said = self._understood((introduction and introduction.rest) or text, job.speaker)
        name = (introduction and introduction.name) or getattr(said.meaning, "name", None)
        person = conversation.base.match_speaker(str(name)) if name else job.speaker
        introduces = introduction or isinstance(said.meaning, meaning.Acknowledgement)
        if introduces and person != job.speaker and conversation.base.trust(person):
            raise forbidden(f"This token speaks for {job.speaker}.", needs="admin")
        if isinstance(said.meaning, meaning.TrustStatement):
            check_role(job.caller, "admin")
        if said.kind in _STATEMENTS:
            check_role(job.caller, "teacher")
        if said.kind in _COMMANDS and job.listens != "tell":
            check_role(job.caller, "operator")
            self.check_lease(job.caller)

    def _may_answer(self, caller: Caller, reply: Reply, asked: OpenQuestion) -> bool:
        """Whether what an answer to a question of Hilt leads to is what the caller may do."""
        teaches, moves = caller.may("teacher"), caller.may("operator")
        kind = reply.understanding.kind
        if teaches and moves:
            return True
        if kind in _COMMANDS:
            return moves and asked.tell is None and asked.choose is None
        return teaches and kind in {*_STATEMENTS, "question"}

    async def confirm(self, id: str, caller: Caller, *, yes: bool) -> Json:  # noqa: A002 - in JSON
        """Answer a question of Hilt by the name that it was given; Problem 410 if it is over."""
        asker = self._asked and self._asked[1].asked
        said = Said(text="yes" if yes else "no", speaker=asker)
        job = Job(f"c{next(self._numbers)}", said, caller, None, self._stops)

        def answered() -> Json:
            found, question = self._asked, self.agent.dialogue.conversation.open_question
            if found is None or found[0] != id or found[1] is not question:
                raise Problem(410, "over", "Over", "Something else was said since, or it is long.")
            if found[2] != caller.id or found[3] < time.monotonic():
                raise Problem(410, "over", "Over", "It was asked of another, or is too long ago.")
            return self._reply(job)

        return await self.run(answered)

    # --- The robot ------------------------------------------------------------------------------

    def stop_robot(self) -> None:
        """Stop what moves, and forget the commands that wait; any thread may call it."""
        self._stops += 1
        self.agent.interrupt("stop")

    def lease(self, caller: Caller, seconds: float) -> Json:
        """Let one caller alone command the robot for some time; 0 gives it back."""
        self.check_lease(caller)
        self._lease = (caller, time.monotonic() + seconds) if seconds else None
        return {"holder": caller.speaker if seconds else None, "seconds": seconds}

    def check_lease(self, caller: Caller) -> None:
        """Problem 409 if another holds the robot."""
        if self._lease and self._lease[1] > time.monotonic() and self._lease[0].id != caller.id:
            left = round(self._lease[1] - time.monotonic())
            detail = f"{self._lease[0].speaker} holds the robot for another {left} s."
            raise Problem(409, "leased", "Held by another", detail)

    async def set_scene(self, scene: str, seed: int) -> None:
        """Lay the table anew; DataError if there is no such scene."""

        def laid() -> None:
            old = self.agent
            config = replace(old.config, scene=safe_scene(scene), seed=seed)
            embodiment, language = (
                Embodiment.from_config(config),
                old.dialogue.conversation.language,
            )
            self.agent = Agent(old.base, language, old.actions, embodiment, config)
            self.agent.watchers.append(self._on_step)
            old.release_body()
            self.show_scene()

        await self.run(laid)

    def show_scene(self) -> None:
        """Make the body and its picture known, in the thread of the agent; without one the table.

        A robot that is moved by something else is not shown.
        """
        agent = self.agent
        self.live_scene = (
            LiveScene(agent.body, next(self._scenes), self.hub) if agent.simulate else None
        )
        self.hub.publish({"type": "scene", **self.scene_as_json()})
        self.show_frame()

    def show_frame(self) -> None:
        """Send a frame to who has just come."""
        if self.live_scene:
            self.live_scene.show()

    def scene_as_json(self) -> Json:
        """What is on the table; with a body, what is drawn, and where the picture is."""
        scene = self.agent.embodiment.scene
        things = [{"name": each.name, "object": each.object} for each in scene.placements]
        known: Json = {"scene": self.agent.config.scene, "seed": scene.seed, "things": things}
        known["moves"] = self.agent.simulate
        return known | (self.live_scene.as_json() if self.live_scene else {})

    # --- What happens ---------------------------------------------------------------------------

    def _on_step(self, step: WalkStep) -> None:
        job = self._current.id if self._current else None
        self.hub.publish({"type": "step", "command": job, **step.as_json()})

    def _publish_job(self, job: Job) -> None:
        known = {"command": job.id, "state": job.state, "text": job.said.text}
        self.hub.publish({"type": "command", **known, "speaker": job.speaker})

    def _tell_news(self, reply: Json | None = None) -> None:
        for event in news(self.base, self._told):
            self._told = event.get("id", self._told)
            is_reply = reply is not None and event.get("id") == self.base.sequence
            self.hub.publish({**event, "reply": reply} if is_reply else event)

    def _check_open(self) -> None:
        if self.is_stopping:
            headers = {"Retry-After": "10"}
            raise Problem(503, "stopping", "Stopping", "The service ends.", headers=headers)

    async def stop(self) -> None:
        """Begin nothing more, let the motion under way end or stop it, and end all streams."""
        self.is_stopping = True
        jobs = [job.answer for job in self.jobs.values() if not job.answer.done()]
        if jobs and (await asyncio.wait(jobs, timeout=STOP_SECONDS))[1]:
            self.stop_robot()
        self.hub.close()
        end = time.monotonic() + GOODBYE_SECONDS
        while self.hub.readers and time.monotonic() < end:
            await asyncio.sleep(0.02)

    async def close(self) -> None:
        """Release the body and the base, after what the agent does now."""
        await asyncio.get_running_loop().run_in_executor(self._thread, self.agent.close)
        self._thread.shutdown()


def reply_as_json(reply: Reply, listens: Listens) -> Json:
    """The document that `hilt tell`, `ask` or `do` print, with how it ended.

    What was not understood says where, what was expected, and what could be said instead.
    """
    kind = reply.understanding.kind
    name = listens or ("tell" if kind in _STATEMENTS else "do" if kind in _COMMANDS else "ask")
    found: Json = {"kind": kind, "outcome": reply.ending, **getattr(reply, f"as_{name}_json")()}
    if kind == "error":
        found["error"] = reply.understanding.meaning.as_json()
    return found


def safe_scene(scene: str) -> str:
    """A scene that names no file of the service's machine; a problem 422 if it does."""
    if scene != "all" and not scene.startswith(("objects:", "random:")):
        detail = 'A scene is "all", "objects:knife,mug" or "random:SEED".'
        raise Problem(422, "scene", "No such scene", detail)
    return scene
