"""What is said to a service, who may say it, and the document of the reply."""

import asyncio
from dataclasses import dataclass, field
from typing import Literal

from pydantic import BaseModel, Field

from ...nlu.language import Language
from ...nlu.semantics import meaning
from ..dialogue.conversation import Conversation
from ..dialogue.manager import KINDS
from ..dialogue.reply import OpenQuestion, Reply
from ..execution.outcome import Json
from .problems import forbidden
from .security import check_role
from .tokens import Caller

Listens = Literal["tell", "ask", "do"] | None
STATEMENTS, COMMANDS = {*KINDS["tell"]}, {*KINDS["do"]}


class Alternative(BaseModel):
    """What a recogniser may have heard instead."""

    text: str = Field(max_length=2000)
    heard: float = Field(default=1.0, ge=0, le=1)


class Said(BaseModel):
    """What somebody says; with `alternatives`, what a recogniser may have heard instead."""

    text: str = Field(min_length=1, max_length=2000)
    heard: float = Field(default=1.0, ge=0, le=1)
    alternatives: list[Alternative] = Field(default=[], max_length=10)
    context: list[str] = Field(default=[], max_length=20, description="place:kitchen, ...")
    at: tuple[float, float] | None = Field(default=None, description="x and y pointed at, metres")
    dry: bool = Field(default=False, description="decide a command, and do not move")
    speaker: str | None = Field(default=None, max_length=200, description="an admin may name one")

    @property
    def texts(self) -> list[str]:
        """All that may have been said."""
        return [self.text, *(each.text for each in self.alternatives)]

    def halting(self, language: Language) -> "Said":
        """Only what halts the robot, if something does: that needs no certainty."""

        def halts(text: str) -> bool:
            said = language.understand(text).meaning
            return isinstance(said, meaning.Control) and said.is_halt

        own = Alternative(text=self.text, heard=self.heard)
        if not (kept := [each for each in (own, *self.alternatives) if halts(each.text)]):
            return self
        return self.model_copy(update={**dict(kept[0]), "alternatives": kept[1:]})


@dataclass
class Job:
    """One utterance that is to be heard, and how far that is."""

    id: str
    said: Said
    caller: Caller
    listens: Listens
    stops: int  # of the robot, before
    state: Literal["queued", "begun", "done"] = "queued"
    answer: asyncio.Future[Json] = field(default_factory=asyncio.Future)

    @property
    def speaker(self) -> str:
        """Who says it: whom the token stands for; an admin may name another."""
        return self.said.speaker or self.caller.speaker

    async def answered(self) -> Json:
        """The answer, when there is one; who asked may go away meanwhile."""
        return await asyncio.shield(self.answer)

    def as_json(self) -> Json:
        """How far it is, and its answer once it has one."""
        failed = self.answer.exception() if self.answer.done() else None
        answer = self.answer.result() if self.answer.done() and not failed else None
        known: Json = {"id": self.id, "text": self.said.text, "speaker": self.speaker}
        return known | {"state": self.state, "answer": answer, "error": failed and str(failed)}


def check_words(job: Job, text: str, conversation: Conversation) -> bool:
    """Whether what is said moves the robot; a problem 403 if its caller may not say it."""
    caller, speaker = job.caller, job.speaker
    introduction = conversation.language.introduction(text)
    said = conversation.understand((introduction and introduction.rest) or text, speaker, heard=1.0)
    greeted = said.meaning.name if isinstance(said.meaning, meaning.Acknowledgement) else None
    name = introduction.name if introduction else greeted
    person = conversation.base.match_speaker(name) if name else speaker
    if person != speaker and conversation.base.trust(person) and not caller.may("admin"):
        raise forbidden(f"This token speaks for {speaker}.", needs="admin")
    if isinstance(said.meaning, meaning.TrustStatement):
        check_role(caller, "admin")
    kinds = {each.kind for each in conversation.sentences(said)}
    if not kinds.isdisjoint(STATEMENTS):
        check_role(caller, "teacher")
    moves = not kinds.isdisjoint(COMMANDS) and job.listens in {None, "do"}
    if moves:
        check_role(caller, "operator")
    return moves


def may_answer(caller: Caller, reply: Reply, asked: OpenQuestion) -> bool:
    """Whether what an answer to a question of Hilt leads to is what a caller may do."""
    if any(isinstance(each, meaning.TrustStatement) for each in asked.meanings):
        return caller.may("admin")
    teaches, moves = caller.may("teacher"), caller.may("operator")
    read_back = {getattr(each, "kind", "ask_back") for each in asked.meanings}
    kinds = read_back or {reply.understanding.kind}
    if kinds <= COMMANDS:
        return moves and (teaches or not (asked.tell or asked.choose))
    return teaches and (moves or kinds <= {*STATEMENTS, "question"})


def reply_as_json(reply: Reply, listens: Listens) -> Json:
    """The document that `hilt tell`, `ask` or `do` print, with what it was and how it ended.

    What was not understood says where, what was expected, and what could be said instead.
    """
    kind = reply.understanding.kind
    name = listens or ("tell" if kind in STATEMENTS else "do" if kind in COMMANDS else "ask")
    found: Json = {"kind": kind, "outcome": reply.ending, **getattr(reply, f"as_{name}_json")()}
    if kind == "error":
        found["error"] = reply.understanding.meaning.as_json()
    return found
