"""The agent as a service: one thread hears and moves, others read.

What is said waits in one queue, so a conversation has an order; "stop" and "wait" pass it by. Who
holds the lease of the robot commands it alone.
"""

import asyncio
import secrets
import time
from collections import OrderedDict
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from io import BytesIO
from itertools import count
from threading import Lock
from typing import TYPE_CHECKING, NamedTuple, TypeVar

from starlette.concurrency import run_in_threadpool

from ...kb.knowledge_base import KnowledgeBase
from ...nlu.semantics.meaning import Control
from ...sim.physics.engine import TIME_STEP
from ..agent import Agent
from ..config import AgentConfig
from ..dialogue.reply import OpenQuestion, Reply
from ..documents import things_as_json
from ..execution.embodiment import Embodiment
from ..execution.outcome import Json, WalkStep
from ..speech.listening import Heard, Listener
from ..speech.sound import Sound
from .events import Hub, news
from .problems import Problem, forbidden
from .sayings import Job, Listens, Said, check_words, may_answer, reply_as_json
from .security import check_role
from .tokens import Caller

if TYPE_CHECKING:
    from ...sim.body import Body

T = TypeVar("T")
MOST_WAITING = 3  # utterances behind the one that is heard
MOST_KEPT = 1_000  # jobs, whose answers can be asked for
CONFIRM_SECONDS = 60
STOP_SECONDS = 10.0  # in which a motion may end when the service does
GOODBYE_SECONDS = 1.0  # for readers of events
STEPS_A_FRAME = 8  # 30 frames a second of the world
STEPS_A_LOOK = 48  # after which it is known anew where things are
_LATE_S = 0.2  # behind the clock, from which a slow world does not try to catch up
_ROLES = {"tell": "teacher", "do": "operator"}


class _Asked(NamedTuple):
    id: str
    question: OpenQuestion
    caller: Caller
    until: float


class LiveScene:
    """The scene of one body, which tells readers of events where everything is."""

    def __init__(self, body: "Body", number: int, hub: Hub, *, pace: float) -> None:
        """Make its model, and watch it; `pace`: seconds of the world in one of who looks, or 0."""
        from ...sim.media.gltf import pose_frame, scene_model

        self._engine, self._number, self._hub = body.world.engine, number, hub
        self._body, self._pace, self._due = body, pace, 0.0
        self.model = scene_model(self._engine)
        self.look()
        self._frame = partial(pose_frame, self._engine, self.model.nodes, scene=number)
        body.world.engine.watchers.append(self._watch)

    def as_json(self) -> Json:
        """Where the shapes are, and the names of their nodes in the order of frames."""
        address = f"/api/v1/scene.glb?v={self.model.key}"
        return {"number": self._number, "url": address, "nodes": list(self.model.node_names)}

    def show(self) -> None:
        """Send a frame now."""
        self._hub.publish(self._frame())

    def look(self) -> None:
        """See where things are now, in the thread that moves them; others read `things`."""
        self.things = things_as_json(self._body)

    def _watch(self) -> None:
        if self._engine.steps % STEPS_A_LOOK == 0:
            self.look()
        if self._hub.readers and self._engine.steps % STEPS_A_FRAME == 0:
            self.show()
            if self._pace:  # let the clock go on as far: who looks can stop what is seen
                now = time.monotonic()
                start = self._due if self._due > now - _LATE_S else now
                self._due = start + STEPS_A_FRAME * TIME_STEP / self._pace
                time.sleep(max(0.0, self._due - now))


class Service:
    """An agent that many may talk to; it is closed with the service."""

    def __init__(self, agent: Agent, *, pace: float = 0.0) -> None:
        """Serve an agent; `pace` is that of a `LiveScene`."""
        self.agent = agent  # another one after the table is set anew
        self.hub, self._pace = Hub(), pace
        self.is_stopping = False  # then nothing new is begun
        self.jobs = OrderedDict[str, Job]()
        self._thread = ThreadPoolExecutor(1, thread_name_prefix="agent")
        self._numbers, self._stops = count(1), 0
        self._current: Job | None = None
        self._by_key = OrderedDict[tuple[str, str], Job]()
        self._asked: _Asked | None = None
        self._lease: tuple[Caller, float] | None = None
        self._told, self._telling = agent.base.sequence, Lock()
        self._scenes = count(1)
        self._listener: Listener | None = None
        self._hearing = Lock()  # a recogniser hears one sound at a time
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
        if key and (known := self._by_key.get((caller.id, key))):
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
        job.answer = asyncio.ensure_future(self._answered(job))
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

    async def _answered(self, job: Job) -> Json:
        def is_control() -> bool:
            language = self.agent.dialogue.conversation.language
            return isinstance(language.understand(job.said.halting(language).text).meaning, Control)

        def decided() -> Json:
            with self.deciding(job.said.context) as agent:
                reply = agent.hear(job.said.text, speaker=job.speaker, only="do", keep=False)
            return reply_as_json(reply, "do")

        try:
            if job.said.dry:
                return await run_in_threadpool(decided)
            if self.agent.is_busy and await run_in_threadpool(is_control):
                return await run_in_threadpool(self._reply, job)  # it interrupts
            return await asyncio.get_running_loop().run_in_executor(self._thread, self._hear, job)
        finally:
            job.state = "done"
            self._publish_job(job)

    def listen(self, wav: bytes) -> Heard:
        """What is heard in a WAV file; errors are those of `Listener.open` and `Sound.read`."""
        conversation = self.agent.dialogue.conversation
        with self._hearing:
            language = conversation.language
            self._listener = (self._listener or Listener.open((), language)).learned(language)
            return self._listener.hear(Sound.read(BytesIO(wav)), conversation.discourse)

    @contextmanager
    def deciding(self, contexts: list[str], scene: str | None = None) -> Generator[Agent]:
        """An agent for the block that knows the same, keeps nothing and moves nothing."""
        chosen = self.agent.embodiment.scene
        if scene is not None:
            config = replace(self.agent.config, scene=safe_scene(scene))
            chosen = Embodiment.from_config(config).scene
        with self.agent.in_scene(chosen) as other:
            own = AgentConfig(contexts=(*contexts,)).context_intervals()
            other.dialogue.contexts.update({**self.agent.dialogue.contexts, **own})
            yield other

    def _hear(self, job: Job) -> Json:
        if job.stops != self._stops:
            raise Problem(409, "stopped", "Stopped", "The robot was stopped before this.")
        job.state, self._current = "begun", job
        self._publish_job(job)
        contexts = self.agent.dialogue.contexts
        before = {**contexts}
        try:
            contexts.update(AgentConfig(contexts=(*job.said.context,)).context_intervals())
            return self._reply(job)
        finally:
            contexts.clear()
            contexts.update(before)
            self._current = None
            if self.live_scene:
                self.live_scene.look()

    def _reply(self, job: Job) -> Json:
        conversation = self.agent.dialogue.conversation
        asked, question = self._asked, conversation.open_question
        is_own = asked and asked.question is question and asked.caller.id == job.caller.id
        if question and question.asked == job.speaker and not is_own:
            conversation.open_question = None  # another one, who may do more, was asked
        said = job.said.halting(conversation.language)
        moves = [check_words(job, text, conversation) for text in said.texts]  # all of them
        if any(moves):
            self.check_lease(job.caller)
        reply = self.agent.hear(
            said.text,
            speaker=job.speaker,
            only=job.listens,
            heard=said.heard,
            alternatives=[(each.text, each.heard) for each in said.alternatives],
            pointing_at=said.at,
        )
        found = reply_as_json(reply, job.listens) | self._wait_for_answer(job, reply)
        if job.said.alternatives:
            found["heard"] = round(reply.heard, 6)
        if reply.decision:
            known = {"type": "decision", "command": job.id, "decision": reply.decision.as_json()}
            self.hub.publish(known | {"proofs": reply.decision.proofs_as_json()})
        if reply.result and reply.result.world.touched:
            parts = [*reply.result.world.touched]
            self.hub.publish({"type": "touch", "command": job.id, "parts": parts})
        self._tell_news(found)
        return found

    def _wait_for_answer(self, job: Job, reply: Reply) -> Json:
        conversation, before = self.agent.dialogue.conversation, self._asked
        question = conversation.open_question
        if question and before and question is before.question and question.asked != job.speaker:
            return {}  # it still waits for another's answer
        self._asked = None
        if question is None or not may_answer(job.caller, reply, question):
            conversation.open_question = None
            return {}
        until = time.monotonic() + CONFIRM_SECONDS
        self._asked = _Asked(secrets.token_urlsafe(16), question, job.caller, until)
        if reply.ending != "asked":
            return {}
        known: Json = {"confirm": self._asked.id, "expires_s": CONFIRM_SECONDS}
        return known | ({"choices": len(question.choices)} if question.choices else {})

    async def confirm(self, id: str, caller: Caller, *, yes: bool) -> Json:  # noqa: A002 - in JSON
        """Answer a question of Hilt by the name that it was given; Problem 410 if it is over."""
        if not (asked := self._asked) or (asked.id, asked.caller.id) != (id, caller.id):
            raise Problem(410, "over", "Over", "There is no such question to you any more.")
        said = Said(text="yes" if yes else "no", speaker=asked.question.asked)
        job = Job(f"c{next(self._numbers)}", said, caller, None, self._stops)

        def answered() -> Json:
            is_open = self.agent.dialogue.conversation.open_question is asked.question
            if not is_open or asked.until < time.monotonic():
                raise Problem(410, "over", "Over", "Something else was said since, or it is long.")
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
            embodiment = Embodiment.from_config(config)
            language = old.dialogue.conversation.language
            self.agent = Agent(old.base, language, old.actions, embodiment, config)
            self.agent.watchers.append(self._on_step)
            old.release_body()
            self.show_scene()

        await self.run(laid)

    def show_scene(self) -> None:
        """Make the body and its picture known, in the thread of the agent; without one the table.

        A robot that is moved by something else is not shown.
        """
        self.live_scene = None
        if self.agent.simulate:
            number, body = next(self._scenes), self.agent.body
            self.live_scene = LiveScene(body, number, self.hub, pace=self._pace)
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
        with self._telling:
            for event in news(self.base, self._told):
                self._told = event.get("id", self._told)
                is_reply = reply is not None and event.get("id") == self.base.sequence
                self.hub.publish({**event, "reply": reply} if is_reply else event)

    def _check_open(self) -> None:
        if self.is_stopping:
            later = {"Retry-After": "10"}
            raise Problem(503, "stopping", "Stopping", "The service ends.", headers=later)

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


def safe_scene(scene: str) -> str:
    """A scene that names no file of the service's machine; a problem 422 if it does."""
    if scene != "all" and not scene.startswith(("objects:", "random:")):
        detail = 'A scene is "all", "objects:knife,mug" or "random:SEED".'
        raise Problem(422, "scene", "No such scene", detail)
    return scene
