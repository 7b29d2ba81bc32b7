"""What is known: rules, their graph, the history, episodes, words, actions, objects, questions."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import islice
from typing import Annotated, Any

from fastapi import APIRouter, Depends, Query, Request, Response

from ....inference.induction import induce
from ....inference.rule_analysis import find_conflicts
from ....kb.knowledge_base import KnowledgeBase
from ....kb.rule import Rule
from ....kb.sparql.named_queries import named_query, query_names
from ....kb.sparql.results import QueryLimits
from ....kb.stores.rdf_text import write_result
from ....kb.views import find_rule, parse_moment, view
from ....ontology.errors import NotFoundError
from ... import documents
from ...execution.outcome import Json
from ..problems import forbidden
from ..security import Reader, Teacher
from .conversation import TheService

router = APIRouter(prefix="/api/v1", tags=["knowledge"])
Name = Annotated[str | None, Query(max_length=200)]
Since = Annotated[int, Query(ge=0, le=2**53)]
Limit = Annotated[int, Query(ge=1, le=10_000)]
Documents = list[dict[str, Any]]
_LIMITS = QueryLimits(30.0, 2048)


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
        names = ("object", "affordance", "context", "part")
        wanted = {name: getattr(self, name) for name in names}
        if self.at is None and self.according_to is None:
            return base.rules(**wanted)
        moment = None if self.at is None else parse_moment(self.at)
        speaker = self.according_to and base.match_speaker(self.according_to)
        return view(base, at=moment, according_to=speaker).rules(**wanted)


Wanted = Annotated[RuleFilter, Depends()]


@router.get("/rules")
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


@router.get("/rules/{id:path}")
def rule(service: TheService, _: Reader, id: str) -> Json:  # noqa: A002 - its name in JSON
    """One rule, by its id or the first digits of it, whatever its status."""
    base = service.base
    found = find_rule(base, id)
    said = base.utterance(found.utterance).as_json() if found.utterance else None
    return {**found.as_json(), "status": found.status, "utterance": said}


@router.delete("/rules/{id:path}")
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


@router.get("/graph")
def graph(service: TheService, _: Reader, wanted: Wanted) -> Json:
    """The rules as nodes and edges, with their intervals."""
    return documents.graph_as_json(wanted.rules(service.base))


@router.get("/conflicts")
def conflicts(service: TheService, _: Reader) -> Documents:
    """The rules that contradict each other, the heaviest conflict first."""
    return [each.as_json() for each in find_conflicts(service.base.rules())]


@router.get("/induced")
def induced(service: TheService, _: Reader) -> Documents:
    """The rules that follow by similarity from those that were taught."""
    kinds = service.agent.embodiment.household
    found = induce(service.base.rules(), kinds.objects, classes=kinds.classes)
    return [each.as_json() for each in found]


@router.get("/words")
def words(service: TheService, _: Reader) -> Documents:
    """The words and the turns of phrase that were learned."""
    base = service.base
    return [each.as_json() for each in (*base.words(), *base.phrases())]


@router.get("/history")
def history(service: TheService, _: Reader, since: Since = 0, limit: Limit = 1_000) -> Documents:
    """What was said after an utterance, in order."""
    return [each.as_json() for each in islice(service.base.history(since=since), limit)]


@router.get("/episodes")
def episodes(service: TheService, _: Reader, limit: Limit = 100) -> Documents:
    """The last commands, with their decisions, steps and results."""
    found = [*service.base.episodes()][-limit:]
    return [documents.episode_as_json(each) for each in found]


@router.get("/episodes/{id}")
def episode(service: TheService, _: Reader, id: str) -> Json:  # noqa: A002
    """One command, with its decision, steps and result."""
    found = {each.id: each for each in service.base.episodes()}
    if id not in found:
        raise NotFoundError("episode", id, found)
    return documents.episode_as_json(found[id])


@router.get("/actions")
def actions(service: TheService, _: Reader) -> Json:
    """The action trees as the paths of their nodes, and the actions that were taught."""
    known = service.agent.dialogue.lessons.actions
    taught = [each.as_json() for each in service.base.actions()]
    trees = {name: list(tree.parameters) for name, tree in known.trees.items()}
    return {"trees": trees, "nodes": list(known.nodes), "taught": taught}


@router.get("/objects")
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


@router.get("/questions")
def questions(_: Reader) -> Documents:
    """The named questions, with their parameters."""
    return [documents.question_as_json(named_query(name)) for name in query_names()]


@router.post("/questions/{name}", response_class=Response)
def question(service: TheService, _: Reader, name: str, arguments: dict[str, str]) -> Response:
    """The answer to a named question, as SPARQL 1.1 Query Results JSON."""
    found = service.base.answer(name, limits=_LIMITS, **arguments)
    return Response(write_result(found, "json"), media_type="application/sparql-results+json")
