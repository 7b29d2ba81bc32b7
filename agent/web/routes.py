"""The JSON interface below `/api/v1`, apart from evaluations and streams."""

import gzip
import tempfile
from dataclasses import dataclass
from datetime import timedelta
from itertools import islice
from pathlib import Path
from typing import Annotated, Any, TypeAlias

from fastapi import APIRouter, Body, Depends, Header, Query, Request, Response
from fastapi import Path as InPath
from starlette.background import BackgroundTask
from starlette.concurrency import run_in_threadpool
from starlette.requests import HTTPConnection
from starlette.responses import FileResponse

from ...inference.induction import induce
from ...inference.rule_analysis import find_conflicts
from ...kb.backup import backup as save
from ...kb.formats.import_export import export_file, import_file
from ...kb.formats.registry import FORMATS
from ...kb.knowledge_base import KnowledgeBase
from ...kb.rule import Rule
from ...kb.sparql.named_queries import named_query, query_names
from ...kb.sparql.results import QueryLimits
from ...kb.stores.rdf_text import write_result
from ...kb.views import find_rule, parse_moment, view
from ...nlu.language import Session
from ...ontology.errors import DataError, NotFoundError
from .. import documents
from ..execution.outcome import Json
from ..speech.voices import find_voice, spoken_form
from .problems import Problem, forbidden
from .sayings import Listens, Said
from .security import Admin, Gate, Operator, Reader, Teacher
from .service import Service

talk, knowledge, administration = (
    APIRouter(prefix="/api/v1", tags=[tag])
    for tag in ("conversation and robot", "knowledge", "administration")
)
Documents = list[dict[str, Any]]
Name = Annotated[str | None, Query(max_length=200)]
Since = Annotated[int, Query(ge=0, le=2**53)]
Limit = Annotated[int, Query(ge=1, le=10_000)]
Format = Annotated[str, Query(description=", ".join(FORMATS))]
IdempotencyKey = Annotated[str | None, Header(max_length=200)]
Prefer = Annotated[str | None, Header(description='"respond-async" answers 202 at once')]
Text = Annotated[str, Body(embed=True, min_length=1, max_length=2000)]
ShortText = Annotated[str, Body(embed=True, min_length=1, max_length=200)]
Texts = Annotated[list[str], Body(max_length=20)]
ACCEPTED: dict[int | str, dict[str, Any]] = {202: {"description": "It waits, or is done."}}


async def service_of(connection: HTTPConnection) -> Service:
    """The service that a request is for."""
    return connection.app.state.service


async def _gate_of(connection: HTTPConnection) -> Gate:
    return connection.app.state.gate


TheService: TypeAlias = Annotated[Service, Depends(service_of)]
TheGate: TypeAlias = Annotated[Gate, Depends(_gate_of)]

# --- What is said, and the robot ----------------------------------------------------------------


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
    talk.add_api_route(
        f"/{_name}", _say, methods=["POST"], name=_name, summary=_summary, responses=ACCEPTED
    )


@talk.post("/listen", openapi_extra={"requestBody": {"content": {"application/octet-stream": {}}}})
async def listen(service: TheService, request: Request, _: Reader) -> Json:
    """What two recognisers hear in a WAV file of at most 30 s, to be said with `hear` then."""
    return (await run_in_threadpool(service.listen, await request.body())).as_json()


@talk.get("/voice", response_class=Response)
def voice(_: Reader, text: Annotated[str, Query(min_length=1, max_length=2000)]) -> Response:
    """What is spoken of an answer: its short form, as a WAV file."""
    with tempfile.NamedTemporaryFile(suffix=".wav") as file:
        find_voice("espeak").save(spoken_form(text), Path(file.name))
        return Response(Path(file.name).read_bytes(), media_type="audio/wav")


@talk.get("/commands/{id}")
async def command(service: TheService, caller: Reader, id: str) -> Json:  # noqa: A002
    """How far a command is, and its answer; kept for the last 1,000."""
    job = service.jobs.get(id)
    if job is None or not (job.caller.id == caller.id or caller.may("admin")):
        raise Problem(404, "not-found", "Not found", f'There is no command "{id}" of yours.')
    return job.as_json()


@talk.post("/confirm")
async def confirm(
    service: TheService,
    caller: Reader,
    id: ShortText,  # noqa: A002
    yes: Annotated[bool, Body()],
) -> Json:
    """Answer a question of Hilt; the answer is that of what was asked about."""
    return await service.confirm(id, caller, yes=yes)


@talk.post("/parse")
def parse(service: TheService, caller: Reader, text: Text, before: Texts = []) -> Json:  # noqa: B006
    """How a sentence is understood, after others; nothing is kept."""
    session = Session(service.agent.dialogue.conversation.language)
    session = session.after(before, speaker=caller.speaker)
    return session.hear(text, speaker=caller.speaker)[0].as_json()


@talk.post("/explain")
def explain(
    service: TheService,
    caller: Reader,
    text: Text,
    scene: Annotated[str | None, Body(max_length=500)] = None,
    context: Texts = [],  # noqa: B006 - as FastAPI has it
) -> Json:
    """The proof of a decision, why not another, and what would change it."""
    with service.deciding(context, scene) as agent:
        return documents.Explanation(agent, text, caller.speaker).as_json()


@talk.get("/scene")
async def scene(service: TheService, _: Reader) -> Json:
    """What stands on the table and, with a body, where: at most 0.2 s of the world ago."""
    known, shown = service.scene_as_json(), service.live_scene
    return known | ({"things": shown.things} if shown else {})


@talk.get("/scene.glb", response_class=Response)
def picture(service: TheService, _: Reader) -> Response:
    """The shapes of all that can be seen, as glTF; another scene has another address."""
    if (live_scene := service.live_scene) is None:
        raise Problem(404, "no-body", "No body", "There is no simulated robot to be seen.")
    headers = {"Cache-Control": "private, max-age=31536000, immutable", "Content-Encoding": "gzip"}
    packed = gzip.compress(live_scene.model.file.read_bytes(), 6)
    return Response(packed, media_type="model/gltf-binary", headers=headers)


@talk.post("/scene")
async def set_scene(
    service: TheService,
    caller: Operator,
    scene: Annotated[str, Body(max_length=500, examples=["all", "objects:knife,mug", "random:7"])],
    seed: Annotated[int, Body(ge=0, le=2**31 - 1)] = 0,
) -> Json:
    """Lay the table anew."""
    service.check_lease(caller)
    await service.set_scene(scene, seed)
    return service.scene_as_json()


@talk.post("/robot/stop")
async def stop(service: TheService, _: Operator) -> Json:
    """Stop what moves, and drop the commands that wait, whoever holds the lease."""
    service.stop_robot()
    return {"stopped": True}


@talk.post("/robot/lease")
async def lease(
    service: TheService,
    caller: Operator,
    seconds: Annotated[float, Body(embed=True, ge=0, le=600)] = 60,
) -> Json:
    """Command the robot alone for some time; 0 seconds give it back."""
    return service.lease(caller, seconds)


# --- What is known ------------------------------------------------------------------------------


@dataclass(frozen=True)
class RuleFilter:
    """Which rules: about what, as they were when, according to whom."""

    object: Name = None
    affordance: Name = None
    context: Name = None
    part: Name = None
    at: Annotated[str | None, Query(description="a date, a time, an utterance number")] = None
    according_to: Name = None

    def rules(self, base: KnowledgeBase) -> list[Rule]:
        """The rules, in the order in which they were last said."""
        wanted = {name: getattr(self, name) for name in ("object", "affordance", "context", "part")}
        if self.at is None and self.according_to is None:
            return base.rules(**wanted)
        moment = None if self.at is None else parse_moment(self.at)
        speaker = self.according_to and base.match_speaker(self.according_to)
        return view(base, at=moment, according_to=speaker).rules(**wanted)


Wanted = Annotated[RuleFilter, Depends()]


@knowledge.get("/rules")
def rules(  # noqa: PLR0917 - dependencies
    service: TheService,
    request: Request,
    response: Response,
    _: Reader,
    wanted: Wanted,
    limit: Limit = 1_000,
    cursor: Name = None,
) -> Documents:
    """Rules; the header Link leads to the next ones, if there are more."""
    found = wanted.rules(service.base)
    if cursor:
        number, last = cursor.split("~", 1) if "~" in cursor else (cursor, "")
        place = (int(number) if number.isdecimal() else 0, last)
        found = [rule for rule in found if (rule.utterance or 0, rule.id) > place]
    shown = found[:limit]
    if len(found) > limit:
        following = f"{shown[-1].utterance or 0}~{shown[-1].id}"
        address = request.url.include_query_params(cursor=following)
        response.headers["Link"] = f'<{address.path}?{address.query}>; rel="next"'
    return [rule.as_json() for rule in shown]


@knowledge.get("/rules/{id:path}")
def rule(service: TheService, _: Reader, id: str) -> Json:  # noqa: A002 - its name in JSON
    """One rule, by its id or the first digits of it, whatever its status."""
    base = service.base
    found = find_rule(base, id)
    said = base.utterance(found.utterance).as_json() if found.utterance else None
    return {**found.as_json(), "status": found.status, "utterance": said}


@knowledge.delete("/rules/{id:path}")
async def forget(service: TheService, caller: Teacher, id: str) -> Json:  # noqa: A002
    """Forget a rule of one's own, or the "last"; an admin forgets any. The history keeps it."""

    def forgotten() -> Json:
        base, before = service.base, service.base.sequence
        found = documents.rules_to_forget(base, id, caller.speaker)
        if not caller.may("admin") and any(each.speaker != caller.speaker for each in found):
            raise forbidden("Others' rules are forgotten by an admin.", needs="admin")
        said = documents.forget_rules(base, found, f"forget {id}", caller.speaker)
        return documents.forgotten_as_json(base, said, before)

    return await service.run(forgotten)


@knowledge.get("/graph")
def graph(service: TheService, _: Reader, wanted: Wanted) -> Json:
    """The rules as nodes and edges, with their intervals."""
    return documents.graph_as_json(wanted.rules(service.base))


@knowledge.get("/conflicts")
def conflicts(service: TheService, _: Reader) -> Documents:
    """The rules that contradict each other, the heaviest conflict first."""
    return [each.as_json() for each in find_conflicts(service.base.rules())]


@knowledge.get("/induced")
def induced(service: TheService, _: Reader) -> Documents:
    """The rules that follow by similarity from those that were taught."""
    kinds = service.agent.embodiment.household
    found = induce(service.base.rules(), kinds.objects, classes=kinds.classes)
    return [each.as_json() for each in found]


@knowledge.get("/words")
def words(service: TheService, _: Reader) -> Documents:
    """The words and the turns of phrase that were learned."""
    base = service.base
    return [each.as_json() for each in (*base.words(), *base.phrases())]


@knowledge.get("/history")
def history(service: TheService, _: Reader, since: Since = 0, limit: Limit = 1_000) -> Documents:
    """What was said after an utterance, in order."""
    return [each.as_json() for each in islice(service.base.history(since=since), limit)]


@knowledge.get("/episodes")
def episodes(service: TheService, _: Reader, limit: Limit = 100) -> Documents:
    """The last commands, with their decisions, steps and results."""
    return [documents.episode_as_json(each) for each in [*service.base.episodes()][-limit:]]


@knowledge.get("/episodes/{id}")
def episode(service: TheService, _: Reader, id: str) -> Json:  # noqa: A002
    """One command, with its decision, steps and result."""
    if id not in (found := {each.id: each for each in service.base.episodes()}):
        raise NotFoundError("episode", id, found)
    return documents.episode_as_json(found[id])


@knowledge.get("/actions")
def actions(service: TheService, _: Reader) -> Json:
    """The action trees as the paths of their nodes, and the actions that were taught."""
    known = service.agent.dialogue.lessons.actions
    taught = [each.as_json() for each in service.base.actions()]
    trees = {name: list(tree.parameters) for name, tree in known.trees.items()}
    return {"trees": trees, "nodes": list(known.nodes), "taught": taught}


@knowledge.get("/objects")
def objects(service: TheService, _: Reader) -> Documents:
    """The household: objects with their kinds, properties and parts."""
    return [
        {
            "name": kind.name,
            "is_a": kind.is_a,
            "properties": sorted(kind.properties),
            "parts": [{"name": part.name, "role": part.role} for part in kind.parts.values()],
        }
        for kind in service.agent.objects.values()
    ]


@knowledge.get("/questions")
def questions(_: Reader) -> Documents:
    """The named questions, with their parameters."""
    return [documents.question_as_json(named_query(name)) for name in query_names()]


@knowledge.post("/questions/{name}", response_class=Response)
def question(service: TheService, _: Reader, name: str, arguments: dict[str, str]) -> Response:
    """The answer to a named question, as SPARQL 1.1 Query Results JSON."""
    found = service.base.answer(name, limits=QueryLimits(), **arguments)
    return Response(write_result(found, "json"), media_type="application/sparql-results+json")


# --- Who may, whole files -----------------------------------------------------------------------


@administration.get("/session")
async def whoami(caller: Reader) -> Json:
    """For whom the token or the session speaks, and what that one may do."""
    return {"id": caller.id, "speaker": caller.speaker, "roles": sorted(caller.roles)}


@administration.post("/session", status_code=204)
async def begin(request: Request, gate: TheGate, key: ShortText) -> None:
    """Take a cookie for a key or a token."""
    gate.begin_session(request, key)


@administration.get("/trust")
def trust(service: TheService, _: Reader) -> Json:
    """The trust in each speaker."""
    return documents.trust_as_json(service.base.trust_by_speaker())


@administration.put("/trust/{speaker}")
async def set_trust(
    service: TheService,
    caller: Admin,
    speaker: Annotated[str, InPath(max_length=200)],
    degree: Annotated[float, Body(embed=True, ge=0, le=1)],
) -> Json:
    """Set the trust in a speaker."""

    def told_so() -> Json:
        name = service.base.match_speaker(speaker)
        interval = service.base.set_trust(name, degree, by=caller.speaker)
        return documents.trust_as_json({name: interval})

    return await service.run(told_so)


@administration.get("/export", response_class=FileResponse)
def export(service: TheService, _: Reader, format: Format = "trig") -> FileResponse:
    """The base as a file."""
    if format not in FORMATS:
        raise DataError(f"expected one of {', '.join(FORMATS)}.", source=format)
    folder = tempfile.TemporaryDirectory(prefix="hilt-")
    file = Path(folder.name) / f"base{FORMATS[format].suffixes[0]}"
    export_file(service.base, file, format=format)
    return FileResponse(file, filename=file.name, background=BackgroundTask(folder.cleanup))


@administration.post("/import")
async def import_(
    service: TheService, request: Request, _: Admin, format: Format, dry: bool = False
) -> Json:
    """Read a file, which is the body: checked first, applied whole or not at all."""
    with tempfile.NamedTemporaryFile(prefix="hilt-") as file:
        async for chunk in request.stream():
            await run_in_threadpool(file.write, chunk)
        file.flush()

        def read() -> Json:
            found = import_file(service.base, file.name, format=format, dry_run=dry)
            return {"applied": not dry, **found.as_json()}

        return await service.run(read)


@administration.post("/backup", status_code=201)
def backup(
    service: TheService,
    _: Admin,
    name: Annotated[str, Body(embed=True, pattern=r"^[A-Za-z0-9][A-Za-z0-9_-]{0,63}$")],
) -> Json:
    """Copy the base into a new folder beside it, while it is in use; the copy is read back."""
    base = service.base
    folder = Path(base.store.location).expanduser()
    target = folder.with_name(f"{folder.name}.backups") / name
    if not folder.is_dir() or target.exists():
        detail = "Only a base in a folder is backed up, under a name that is new."
        raise Problem(409, "no-backup", "No backup", detail)
    return {"backup": name, "sequence": save(base, target)}


@administration.get("/tokens")
def tokens(gate: TheGate, _: Admin) -> Documents:
    """The tokens, without their secrets."""
    return [each.as_json() for each in gate.tokens.tokens()]


@administration.post("/tokens", status_code=201)
def add_token(
    gate: TheGate,
    _: Admin,
    name: ShortText,
    speaker: ShortText,
    roles: Annotated[list[str], Body(min_length=1, max_length=4)],
    days: Annotated[float | None, Body(gt=0, le=3650)] = None,
) -> Json:
    """Make a token; this is the only time that it is shown."""
    lasts = None if days is None else timedelta(days=days)
    made, secret = gate.tokens.add(name, speaker, roles, lasts)
    return {**made.as_json(), "token": secret}


@administration.delete("/tokens/{name}", status_code=204)
def remove_token(gate: TheGate, _: Admin, name: str) -> None:
    """Remove a token, by its id or name; who uses it is out at once."""
    gate.tokens.remove(name)
