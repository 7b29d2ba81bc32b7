"""What is said: tell, ask, do, hear, confirm; and how it is understood and proved."""

from __future__ import annotations

from typing import Annotated, Any, TypeAlias

from fastapi import APIRouter, Depends, Header, Request, Response
from pydantic import BaseModel, Field
from starlette.requests import HTTPConnection

from ....nlu.language import Session
from ...documents import Explanation
from ...execution.outcome import Json
from ..problems import Problem
from ..sayings import Listens, Said
from ..security import Reader
from ..service import Service

router = APIRouter(prefix="/api/v1", tags=["conversation"])
IdempotencyKey = Annotated[str | None, Header(max_length=200)]
Prefer = Annotated[str | None, Header(description='"respond-async" answers 202 at once')]
ACCEPTED: dict[int | str, dict[str, Any]] = {202: {"description": "It waits, or is done."}}


async def service_of(connection: HTTPConnection) -> Service:
    """The service that a request is for."""
    return connection.app.state.service


TheService: TypeAlias = Annotated[Service, Depends(service_of)]


class Text(BaseModel):
    """A sentence."""

    text: str = Field(min_length=1, max_length=2000)


class ParseQuestion(Text):
    """A sentence, and what was said before it."""

    before: list[str] = Field(default=[], max_length=20)


class ExplainQuestion(Text):
    """A command that is decided, on another table if one is given."""

    scene: str | None = Field(default=None, max_length=500)
    context: list[str] = Field(default=[], max_length=20)


class Confirmation(BaseModel):
    """The answer to a question of Hilt."""

    id: str
    yes: bool


async def _say(  # noqa: PLR0917 - dependencies
    request: Request,
    service: TheService,
    response: Response,
    caller: Reader,
    said: Said,
    idempotency_key: IdempotencyKey = None,
    prefer: Prefer = None,
) -> Json:
    path = request.url.path.rpartition("/")[2]
    listens: Listens = None if path == "hear" else path  # pyright: ignore[reportAssignmentType]
    job = service.say(said, caller, listens, idempotency_key)
    if "respond-async" in (prefer or ""):
        response.status_code = 202
        response.headers["Location"] = f"/api/v1/commands/{job.id}"
        return job.as_json()
    return await job.answered()


for _name, _summary in (
    ("tell", "Teach something; role teacher"),
    ("ask", "Ask what is known"),
    ("do", "Have something done; role operator"),
    ("hear", "Say anything; what it is decides the role that it needs"),
):
    router.add_api_route(
        f"/{_name}", _say, methods=["POST"], name=_name, summary=_summary, responses=ACCEPTED
    )


@router.get("/commands/{id}")
async def command(service: TheService, caller: Reader, id: str) -> Json:  # noqa: A002
    """How far a command is, and its answer; kept for the last 1,000."""
    job = service.jobs.get(id)
    if job is None or not (job.caller.id == caller.id or caller.may("admin")):
        raise Problem(404, "not-found", "Not found", f'There is no command "{id}" of yours.')
    return job.as_json()


@router.post("/confirm")
async def confirm(service: TheService, caller: Reader, answer: Confirmation) -> Json:
    """Answer a question of Hilt; the answer is that of what was asked about."""
    return await service.confirm(answer.id, caller, yes=answer.yes)


@router.post("/parse")
def parse(service: TheService, caller: Reader, said: ParseQuestion) -> Json:
    """How a sentence is understood; nothing is kept."""
    session = Session(service.agent.dialogue.conversation.language)
    session = session.after(said.before, speaker=caller.speaker)
    return session.hear(said.text, speaker=caller.speaker)[0].as_json()


@router.post("/explain")
def explain(service: TheService, caller: Reader, asked: ExplainQuestion) -> Json:
    """The proof of a decision, why not another, and what would change it."""
    with service.deciding(asked.context, asked.scene) as agent:
        return Explanation.of(agent, asked.text, caller.speaker).as_json()
