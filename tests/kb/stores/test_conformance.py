"""Claims that every store keeps: in memory, in a folder, and behind three real endpoints."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import ExitStack, closing
from dataclasses import replace
from datetime import datetime, timezone
from decimal import Decimal
from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.agent.execution.embodiment import Embodiment
from hilt.kb.formats.ontology import import_ontology
from hilt.kb.interval import CERTAIN, Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.rdf.terms import Literal, Quad, Term
from hilt.kb.rule import Atom, functional, grasping, norm
from hilt.kb.sparql.named_queries import query_names
from hilt.kb.sparql.results import (
    STATEMENT,
    BooleanResult,
    ConstructResult,
    QueryLimits,
    SelectResult,
)
from hilt.kb.stores.base import Store
from hilt.kb.stores.http import parse_address
from hilt.kb.stores.opening import open_store
from hilt.kb.stores.remote import BATCH, RemoteStore, open_remote
from hilt.kb.validation import check_invariants
from hilt.nlu.language import Language
from hilt.ontology.actions import load_actions
from hilt.ontology.errors import QueryError, StoreError
from hilt.ontology.objects import load_objects
from hilt.ontology.vocabulary import GRAPH_NAMES, Iri, iri

from .. import endpoints
from ..conftest import BLADE, CUTTING, PAPER, teach, ticking
from ..test_episodes import EPISODE

S, P = (Iri(f"urn:{name}") for name in "sp")
G, H = iri("graph", "beliefs"), iri("graph", "history")
ENDPOINTS = {
    "oxigraph server": endpoints.oxigraph,
    "virtuoso": endpoints.virtuoso,
    "hilt serve": endpoints.hilt,
}
Opener = Callable[[], Store]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Callable[[str], Opener]]:
    """Starts each server when it is first asked for, and stops them all."""
    openers: dict[str, Opener] = {}
    with ExitStack() as running:

        def serve(name: str) -> Opener:
            if name not in openers:
                folder = tmp_path_factory.mktemp("endpoint") / "data"
                found = running.enter_context(ENDPOINTS[name](folder))
                address = replace(
                    parse_address(found.location, {}), user=found.user, password=found.password
                )
                openers[name] = lambda: open_remote(address)
            return openers[name]

        yield serve


@pytest.fixture(params=["memory", "folder", *ENDPOINTS])
def opener(
    request: pytest.FixtureRequest, tmp_path: Path, served: Callable[[str], Opener]
) -> Opener:
    """Opens an empty store; opened again, it is the same store (but for the memory)."""
    if request.param == "memory":
        return lambda: open_store("memory:")
    if request.param == "folder":
        return lambda: open_store(tmp_path / "store")
    opened = served(request.param)
    store = opened()
    for name in (*GRAPH_NAMES, "ontology.kitchen"):
        store.update(f"CLEAR SILENT GRAPH graph:{name}")
    store.close()
    return opened


@pytest.fixture
def store(opener: Opener) -> Iterator[Store]:
    """An empty store."""
    opened = opener()
    yield opened
    opened.close()


def quad(value: Term = 1, graph: Iri = G) -> Quad:
    """A statement with a value."""
    return Quad(S, P, value, graph)


@pytest.mark.parametrize(
    "value",
    [
        Iri("urn:x"),
        "text",
        'quote " and \n newline, ünïcode 刀',
        True,
        -3,
        Decimal("0.95"),
        Decimal(1),
        0.25,
        datetime(2026, 11, 21, 9, 0, 0, 5000, tzinfo=timezone.utc),
        Literal("knife", language="en"),
        Literal("x", "urn:type"),
    ],
)
def test_every_value_comes_back(store: Store, value: Term):
    """What is written is read back, compared by value."""
    store.apply(insert=[quad(value)])

    assert list(store.quads()) == [quad(value)]
    assert store.properties(S, G) == [(P, value)]
    assert list(store.quads(None, None, value)) == [quad(value)]


def test_insertion_is_idempotent(store: Store):
    """A statement stands there once."""
    store.apply(insert=[quad(), quad()])
    store.apply(insert=[quad()])

    assert len(list(store.quads())) == 1


def test_deletion_comes_before_insertion(store: Store):
    """One unit deletes, then inserts; what is both is there afterwards."""
    store.apply(insert=[quad(1), quad(2)])

    store.apply(delete=[quad(1), quad(2)], insert=[quad(2), quad(3, H)])

    assert set(store.quads()) == {quad(2), quad(3, H)}


def test_pattern_matches_only_what_it_says(store: Store):
    """Each of the four places narrows what is found."""
    store.apply(insert=[quad(1), quad(1, H), Quad(P, P, 1, G)])

    assert set(store.quads(graph=H)) == {quad(1, H)}
    assert set(store.quads(subject=P)) == {Quad(P, P, 1, G)}
    assert not list(store.quads(predicate=S))


def test_select_gives_all_rows(store: Store):
    """Rows are complete, unbound variables are None."""
    store.apply(insert=[quad(1), quad(2)])

    found = store.select("SELECT ?o ?x WHERE { GRAPH graph:beliefs { ?s ?p ?o } } ORDER BY ?o")

    assert (found.variables, found.rows) == (("o", "x"), ((1, None), (2, None)))


def made(*quads: Quad) -> ConstructResult:
    """The result of a CONSTRUCT query."""
    return ConstructResult(STATEMENT, tuple(quad[:3] for quad in quads))


def test_ask_and_construct_answer(store: Store):
    """The other two forms."""
    store.apply(insert=[quad(1)])

    assert store.run("ASK { GRAPH graph:beliefs { <urn:s> ?p 1 } }") == BooleanResult(True)
    none, some = "GRAPH ?g { ?s ?p ?o FILTER(false) }", "GRAPH graph:beliefs { ?s ?p ?o }"
    assert store.run(f"CONSTRUCT {{ ?o ?p ?s }} WHERE {{ {none} }}") == made()
    assert store.run(f"CONSTRUCT {{ ?s ?p ?o }} WHERE {{ {some} }}") == made(Quad(S, P, 1))


def test_query_of_the_wrong_form_is_refused(store: Store):
    """Rows are selected only."""
    with pytest.raises(QueryError, match="Expected a"):
        store.select("ASK { ?s ?p ?o }")


def test_wrong_update_changes_nothing(store: Store):
    """A mistake anywhere in an update undoes all of it."""
    store.apply(insert=[quad(1)])

    with pytest.raises(QueryError):
        store.update("DELETE WHERE { GRAPH graph:beliefs { ?s ?p ?o } } ; INSERT DATA {")

    assert list(store.quads()) == [quad(1)]


def test_update_is_applied(store: Store):
    """A SPARQL update works on named graphs."""
    store.update("INSERT DATA { GRAPH graph:beliefs { <urn:s> <urn:p> 1 } }")

    assert list(store.quads()) == [quad(1)]


def test_threads_lose_no_update(store: Store):
    """Four threads that count up under the lock reach the sum."""
    store.apply(insert=[quad(0)])

    def count(times: int = 15) -> None:
        for _ in range(times):
            with store.writing():
                (now,) = store.quads(S, P, None, G)
                store.apply(delete=[now], insert=[quad(int(str(now.object)) + 1)])

    threads = [threading.Thread(target=count) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()

    assert list(store.quads()) == [quad(60)]


def test_closed_store_says_so(store: Store):
    """Closing twice is allowed, using a closed store is not."""
    store.close()
    store.close()

    with pytest.raises(StoreError, match="is closed"):
        store.apply(insert=[quad()])
    with pytest.raises(StoreError, match="is closed"):
        list(store.quads())


def test_triple_terms_are_refused(store: Store):
    """RDF 1.2 is not what a base holds, and a query that makes such terms fails."""
    with pytest.raises(QueryError, match=r"RDF 1\.2|The endpoint says"):
        store.select("SELECT (TRIPLE(<urn:a>, <urn:b>, 1) AS ?t) WHERE {}")


def test_query_that_chooses_its_graphs_sees_those(store: Store):
    """FROM is what the standard says: these graphs, and no others."""
    store.apply(insert=[quad(1, G), quad(2, H)])

    assert list(store.select("SELECT ?o FROM graph:history { ?s ?p ?o }")) == [(2,)]
    assert not list(store.select("SELECT ?o FROM graph:lexicon { ?s ?p ?o }"))


def test_query_sees_all_graphs_as_one(store: Store):
    """Who asks without naming graphs finds what is in any of them."""
    store.apply(insert=[quad(1), Quad(P, P, 2, H)])

    found = store.select("SELECT ?o WHERE { ?s ?p ?o } ORDER BY ?o")

    assert found.rows == ((1,), (2,))
    assert store.run("ASK { <urn:s> <urn:p> ?o . GRAPH ?g { ?o2 ?p2 2 } }") == BooleanResult(True)


def test_run_answers_every_form(store: Store):
    """Rows, yes or no, and statements, as the methods for each form give them."""
    store.apply(insert=[quad(1), quad(1, H)])
    limits = QueryLimits(seconds=20)

    assert store.run("SELECT ?s WHERE { GRAPH ?g { ?s ?p ?o } }", limits) == SelectResult(
        ("s",), ((S,), (S,))
    )
    assert store.run("ASK { ?s ?p 2 }", limits) == BooleanResult(False)
    assert store.run("CONSTRUCT { ?s ?p 3 } WHERE { ?s ?p ?o }", limits) == made(Quad(S, P, 3))
    with pytest.raises(QueryError):
        store.run("SELECT WHERE {", limits)


def test_run_stops_a_query_that_takes_too_long(store: Store):
    """Whatever it is doing; and the store answers afterwards."""
    store.apply(insert=[quad(number) for number in range(200)])
    endless = "SELECT (COUNT(*) AS ?n) WHERE { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l . ?m ?n ?o FILTER(?c + ?f + ?i + ?l + ?o < 0) }"  # noqa: E501

    with pytest.raises(QueryError, match=r"took longer than 0\.5 s|The endpoint says"):
        store.run(endless.replace("?n)", "?count)"), QueryLimits(seconds=0.5))

    assert store.run("ASK { ?s ?p 7 }") == BooleanResult(True)


def test_long_results_are_not_cut(store: Store):
    """More rows than the endpoint gives at once are read on, each once."""
    many = [quad(number) for number in range(2 * endpoints.MAX_ROWS + 7)]
    store.apply(insert=many)

    assert sorted(store.quads(), key=lambda one: int(str(one.object))) == many
    rows = store.select("SELECT ?o WHERE { GRAPH ?g { ?s ?p ?o } } ORDER BY DESC(?o)").rows
    assert [row[0] for row in rows] == list(range(len(many)))[::-1]
    found = store.run("CONSTRUCT { ?s ?p ?o } WHERE { GRAPH ?g { ?s ?p ?o } }")
    assert isinstance(found, ConstructResult)
    assert {one.object for one in found.quads} == set(range(len(many)))


def test_large_units_are_written_whole(store: Store):
    """More statements than one operation takes; what is deleted and inserted is there."""
    many = {quad(number, G if number % 2 else H) for number in range(2 * BATCH + 1)}
    store.apply(insert=many)

    store.apply(delete=many, insert=[quad(1), quad(-1)])

    assert set(store.quads()) == {quad(1), quad(-1)}


def test_whole_numbers_are_deleted_by_value(store: Store):
    """A decimal that comes back as an integer can still be deleted."""
    store.apply(insert=[quad(Decimal("1.0")), quad(Decimal("0.50"))])
    store.apply(delete=list(store.quads()))

    assert list(store.quads()) == []


# --- A base on every store


def questioned(store: Store) -> KnowledgeBase:
    """A base that was told the paper's sentences, one of them taken back and one doubted."""
    kb = KnowledgeBase(store, clock=ticking())
    for text, predicate, rule in PAPER:
        kb.believe(text, predicate, "sam", [rule])
    never = functional("knife", "cutting", interval=Interval(0, 0.2))
    kb.believe("Never.", "", "anna", [never])
    child = [Atom("role", "child")]
    kb.believe("No.", "", "anna", [norm("forbidden", "pass", interval=CERTAIN, contexts=child)])
    kb.retract(BLADE.id, "Forget it.", "", "sam")
    kb.set_trust("anna", 0.5)
    hot = functional("mug", "cutting", interval=Interval(0.4, 1), properties=("hot",))
    kb.believe("Hot ones.", "", "anna", [hot])
    kb.record_episode(EPISODE)
    return kb


QUESTIONS: list[tuple[str, dict[str, str]]] = [
    ("best-for", {"affordance": "cutting"}),
    ("changed-since", {"since": "2"}),
    ("changed-since", {}),
    ("contradictions", {}),
    ("contradictions", {"object": "knife"}),
    ("counts", {}),
    ("experience", {}),
    ("experience", {"object": "knife", "before": "9"}),
    ("features-of-node", {"node": "findObject.cutting"}),
    ("forbidden", {}),
    ("forbidden", {"action": "pass"}),
    ("how-to-grasp", {"object": "knife"}),
    ("how-to-grasp", {"object": "knife", "context": "pickUp"}),
    ("rules-of-node", {"node": "pickUp.graspObject"}),
    ("uses-of", {"object": "knife"}),
    ("trust-in", {}),
    ("trust-in", {"speaker": "anna"}),
    ("who-said", {"rule": CUTTING.id}),
]


def test_every_question_is_answered_alike_everywhere(store: Store):
    """Each named query gives the same rows on every store as in memory."""
    asked, reference = questioned(store), questioned(open_store("memory:"))

    for name, arguments in QUESTIONS:
        expected = reference.answer(name, **arguments)
        assert expected.rows, name
        assert asked.answer(name, **arguments).variables == expected.variables
        assert set(asked.answer(name, **arguments).rows) == set(expected.rows), name


def test_every_question_is_tried():
    """The list above leaves none out."""
    assert {name for name, _ in QUESTIONS} == set(query_names())


def test_base_learns_and_forgets_on_every_store(opener: Opener):
    """Teaching, correcting, trust and questions give the same everywhere."""
    with KnowledgeBase(opener()) as kb:
        for text, predicate, rule in PAPER:
            kb.believe(text, predicate, "sam", [rule])
        often = grasping("knife", "blade", "pass", interval=Interval(0.75, 1))
        kb.believe("Often.", "", "sam", [often], supersedes=[BLADE.id], kind="correction")
        kb.set_trust("anna", 0.5)
        kb.set_trust("anna", 1)

        assert [rule.id for rule in kb.rules_at_nodes(["pass.graspObject"])] == [often.id]
        assert kb.rule(BLADE.id).status == "superseded"
        assert kb.trust("anna") == Interval(1, 1)
        assert kb.answer("how-to-grasp", object="knife").rows[0][2] == iri("part", "handle")
        assert list(check_invariants(kb.store)) == []


def test_base_is_the_same_when_it_is_opened_again(opener: Opener):
    """What was told is there for the next who opens it."""
    with KnowledgeBase(opener()) as kb:
        if kb.store.location == "memory:":
            pytest.skip("the memory ends with the process")
        teach(kb, BLADE)
        told = kb.rules()

    with KnowledgeBase(opener()) as kb:
        assert (kb.rules(), kb.sequence) == (told, 1)


def test_ontology_is_seen_by_who_opens_the_base_later(opener: Opener, tmp_path: Path):
    """And goes with all the rest when an endpoint's content is replaced."""
    file = tmp_path / "kitchen.ttl"
    file.write_text(
        "@prefix : <urn:> . @prefix rdfs: <http://www.w3.org/2000/01/rdf-schema#> .\n"
        ":Spoon rdfs:subClassOf :Cutlery .\n"
    )
    with KnowledgeBase(opener(), clock=ticking()) as base:
        import_ontology(base, str(file))
        seen = list(base.store.quads(None, None, Iri("urn:Cutlery")))
        base.store.save(tmp_path / "saved")
    if base.store.location != "memory:":
        with closing(opener()) as store:
            assert list(store.quads(None, None, Iri("urn:Cutlery"))) == seen
            if isinstance(store, RemoteStore):
                store.replace([])
                assert not list(store.quads())

    assert [quad.subject for quad in seen] == [Iri("urn:Spoon")]
    with closing(open_store(tmp_path / "saved")) as saved:
        assert list(saved.quads(None, None, Iri("urn:Cutlery"))) == seen


def test_rules_of_a_node_are_asked_in_one_query(store: Store):
    """The hot question by query finds what it finds by patterns."""
    kb = KnowledgeBase(store)
    teach(kb, *(rule for _, _, rule in PAPER))

    found = kb.rules_at_nodes(["pass.graspObject", "graspObject", "findObject.cutting"])

    assert {rule.id for rule in found} == {PAPER[0][2].id, BLADE.id}


def test_whole_agent_works_on_every_store(opener: Opener):
    """It learns by sentences, decides by what it learned, and keeps what it did."""
    base = KnowledgeBase(opener())
    base.load_domain(load_objects(), load_actions())
    bodiless = Embodiment.from_config(AgentConfig(simulate=False))

    with Agent(base, Language.load(), load_actions(), bodiless) as agent:
        for text, _, _ in PAPER:
            assert agent.hear(text).rules
        reply = agent.hear("pass me something used for cutting")

        decision = reply.as_do_json()["decision"]
        assert (decision["object"], decision["part"]) == ("knife", "blade")
        assert [episode.object for episode in base.episodes()] == ["knife"]
