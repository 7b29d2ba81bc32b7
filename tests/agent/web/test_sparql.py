"""SPARQL over HTTP: what the test suites of the W3C leave open, and the laws of a base."""

from __future__ import annotations

import threading
from collections.abc import Iterator

import httpx
import pytest

from hilt.agent.agent import Agent
from hilt.agent.config import AgentConfig
from hilt.kb import KnowledgeBase
from hilt.kb.learned import LEXICON
from hilt.kb.sparql.query_text import insert_data
from hilt.ontology.errors import StoreError

from .running_service import RunningService, end, say, start

RULE = "SELECT ?rule { GRAPH graph:beliefs { ?rule a hilt:AffordanceRule } }"
USES = "SELECT ?s { ?s hilt:usedFor ?o }"
CROSS = "SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l . ?m ?n ?o } ORDER BY ?a ?o"
TRUST = """DELETE { GRAPH graph:beliefs { speaker:anna hilt:trustLower ?low } }
INSERT { GRAPH graph:beliefs { speaker:anna hilt:trustLower %s } }
WHERE { GRAPH graph:beliefs { speaker:anna hilt:trustLower ?low } }"""
ROWS, BOOLEANS = "SELECT ?x { VALUES ?x { 1 } }", "ASK {}"
STATEMENTS = "CONSTRUCT { <s> <p> 1 } WHERE {}"


@pytest.fixture(scope="module")
def admin(service: RunningService) -> Iterator[httpx.Client]:
    """Sam, who may do everything, and told something."""
    with service.client("admin", speaker="sam") as client:
        client.event_hooks["response"] = []
        say(client, "tell", "A knife is used for cutting").raise_for_status()
        client.put("/api/v1/trust/anna", json={"degree": 0.5}).raise_for_status()
        yield client


@pytest.fixture(scope="module")
def bare(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    """A plain store."""
    running = start(tmp_path_factory.mktemp("bare") / "store", "--bare")
    with running.client() as client:
        yield client
    end(running)


def ask(client: httpx.Client, query: str, **headers: str) -> httpx.Response:
    """The response to a query."""
    return client.get("/sparql", params={"query": query}, headers=headers)


@pytest.mark.parametrize(
    ("query", "accept", "expected"),
    [
        (ROWS, "*/*", "application/sparql-results+json"),
        (ROWS, "text/html, */*;q=0.1", "application/sparql-results+json"),
        (ROWS, "text/csv;q=0.4, application/sparql-results+xml;q=0.5", "sparql-results+xml"),
        (ROWS, "text/*", "text/csv"),
        (ROWS, "text/tab-separated-values", "text/tab-separated-values"),
        (ROWS, "text/turtle", None),
        (ROWS, "text/csv;q=0", None),
        (BOOLEANS, "application/json", "application/json"),
        (BOOLEANS, "text/csv", None),
        (STATEMENTS, "*/*", "text/turtle"),
        (STATEMENTS, "application/rdf+xml, text/turtle;q=0.9", "application/rdf+xml"),
        (STATEMENTS, "application/sparql-results+json", None),
    ],
)
def test_result_has_the_form_that_is_liked_best(
    bare: httpx.Client, query: str, accept: str, expected: str | None
):
    """By the q-values, for each kind of result; where none fits, that is said."""
    found = ask(bare, query, Accept=accept)

    assert found.status_code == (406 if expected is None else 200)
    if expected:
        assert expected in found.headers["content-type"]
        assert found.headers["vary"] == "Accept"


def test_head_answers_as_get(bare: httpx.Client):
    """With the same headers, and without the body."""
    got, head = ask(bare, ROWS), bare.head("/sparql", params={"query": ROWS})

    assert (head.status_code, head.content) == (200, b"")
    assert head.headers["content-length"] == got.headers["content-length"]


@pytest.mark.parametrize(
    "query", ["ASK { SERVICE <http://127.0.0.1:1/> {} }", "ASK { \\u0053ERVICE <urn:x> {} }"]
)
def test_nothing_is_asked_elsewhere(bare: httpx.Client, query: str):
    """A query or an update that would reach out is refused."""
    load = bare.post("/update", data={"update": "LOAD <file:///etc/passwd>"})

    assert (ask(bare, query).status_code, load.status_code) == (400, 400)
    assert load.json()["detail"].startswith("LOAD is refused")


def test_mistake_is_shown_where_it_was_typed(bare: httpx.Client):
    """With its line and column, in queries and in updates."""
    query = ask(bare, "SELECT ?x WHERE\n{ ?x }")
    update = bare.post("/update", data={"update": "INSERT DATA\n{ <urn:s> }"})

    assert query.json()["detail"].startswith("The query is wrong at line 2, column 7")
    assert update.json()["detail"].startswith("The query is wrong at line 2, column 11")


@pytest.mark.parametrize(
    "broken", [b"query=%ff", b"query=ASK {}&query=ASK {}", b"update=x&query=y"]
)
def test_wrong_form_is_refused(bare: httpx.Client, broken: bytes):
    """What is not UTF-8, and what asks for two things."""
    headers = {"Content-Type": "application/x-www-form-urlencoded"}

    assert bare.post("/sparql", content=broken, headers=headers).status_code == 400


@pytest.mark.parametrize("place", ["", "?default&graph=urn:x", "?graph=here", "/x?default"])
def test_one_graph_is_named(bare: httpx.Client, place: str):
    """None, two, and one that is no IRI are refused."""
    assert bare.get(f"/store{place}").status_code == 400


def test_wrong_document_changes_nothing(bare: httpx.Client):
    """A graph that cannot be read is not replaced, however much of it can be."""
    place = {"graph": "urn:kept"}
    turtle = {"Content-Type": "text/turtle"}
    bare.put("/store", params=place, content="<urn:s> <urn:p> 1 .", headers=turtle)

    wrong = bare.put("/store", params=place, content="<urn:s> <urn:p> 2 . oops", headers=turtle)
    other = bare.put("/store", params=place, content="x", headers={"Content-Type": "text/plain"})

    assert (wrong.status_code, other.status_code) == (422, 415)
    kept = bare.get("/store", params=place, headers={"Accept": "application/n-triples"})
    assert '"1"' in kept.text and '"2"' not in kept.text


def test_documents_with_the_same_blank_nodes_stay_apart(bare: httpx.Client):
    """`_:a` of one is not `_:a` of another."""
    place, turtle = {"graph": "urn:blank"}, {"Content-Type": "text/turtle"}
    for value in (1, 2):
        bare.post("/store", params=place, content=f"_:a <urn:p> {value} .", headers=turtle)

    query = "SELECT DISTINCT ?s { GRAPH <urn:blank> { ?s ?p ?o } }"
    assert len(ask(bare, query).json()["results"]["bindings"]) == 2


def test_graph_of_many_megabytes_is_taken(bare: httpx.Client):
    """It may be larger than other bodies, which are cut at one megabyte."""
    lines = "".join(f"<urn:s{number}> <urn:p> {number} .\n" for number in range(60_000))
    turtle = {"Content-Type": "text/turtle"}

    stored = bare.put("/store", params={"graph": "urn:many"}, content=lines, headers=turtle)

    assert stored.status_code == 201
    count = ask(
        bare, "SELECT (COUNT(*) AS ?n) { GRAPH <urn:many> { ?s ?p ?o } }", Accept="text/csv"
    )
    assert count.text.split() == ["n", "60000"]
    assert bare.post("/update", data={"update": "#" * 2**21}).status_code == 413


def test_quick_query_does_not_wait_for_slow_ones(admin: httpx.Client, service: RunningService):
    """Three that take long may run; a fourth is refused, and quick ones are answered."""
    ended = list[int]()

    def ask_much() -> None:
        with service.client("reader") as client:
            ended.append(ask(client, CROSS).status_code)

    asking = [threading.Thread(target=ask_much) for _ in range(4)]
    for each in asking:
        each.start()
    while not ended:
        assert ask(admin, USES).status_code == 200
        threading.Event().wait(0.2)
    assert ended == [503]
    assert ask(admin, USES).status_code == 200
    for each in asking:
        each.join()

    assert ended == [503, 400, 400, 400]


def test_query_is_stopped_when_nobody_waits(bare: httpx.Client):
    """Those who left do not keep others from asking what takes long."""
    bare.put(
        "/store?default", content="<urn:s> <urn:p> 1 .", headers={"Content-Type": "text/turtle"}
    )
    for _ in range(6):
        with pytest.raises(httpx.ReadTimeout):
            bare.get("/sparql", params={"query": CROSS}, timeout=1.5)

    assert ask(bare, ROWS).status_code == 200


# --- A base


def test_answer_says_of_when_it_is(admin: httpx.Client):
    """By the number of the last utterance; who wants today's gets it."""
    say(admin, "tell", "A mug is used for drinking").raise_for_status()

    found = ask(admin, USES, Prefer="fresh")

    assert int(found.headers["hilt-as-of"]) == admin.get("/readyz").json()["sequence"]
    assert "object/mug" in found.text


@pytest.mark.parametrize("count", [3, 2_000])
def test_lookup_has_all_rows(bare: httpx.Client, count: int):
    """Few are answered at once, and many by another process; both are all."""
    turtle = "".join(f"<urn:many> <urn:p> {number} ." for number in range(count))
    headers = {"Content-Type": "text/turtle"}
    bare.put("/store", params={"graph": "urn:m"}, content=turtle, headers=headers)

    found = ask(bare, "SELECT ?o { <urn:many> ?p ?o }", accept="text/csv").text.split()

    assert sorted(map(int, found[1:])) == list(range(count))


def test_what_is_looked_up_again_is_what_is_stored_now(bare: httpx.Client):
    """An answer is kept for each form and each dataset, and for as long as nothing is written."""
    update = "INSERT DATA { GRAPH <urn:k> { <urn:kept> <urn:p> %d } }"
    query = "SELECT ?o { <urn:kept> <urn:p> ?o }"

    seen = list[str]()
    for number in range(3):
        assert bare.post("/update", data={"update": update % number}).status_code == 204
        for _ in range(2):
            seen.append("".join(sorted(ask(bare, query, accept="text/csv").text.split()[1:])))
    elsewhere = {"query": query, "default-graph-uri": "urn:none"}

    assert seen == ["0", "0", "01", "01", "012", "012"]
    assert len(ask(bare, query).json()["results"]["bindings"]) == 3
    assert bare.get("/sparql", params=elsewhere).json()["results"]["bindings"] == []


def test_update_changes_what_the_next_query_sees(admin: httpx.Client):
    """It is an utterance of the one whose token it was."""
    changed = admin.post("/update", data={"update": TRUST % "0.25"})

    asked = ask(admin, "ASK { speaker:anna hilt:trustLower 0.25 }")
    said = admin.get("/api/v1/history").json()
    assert (changed.status_code, asked.json()["boolean"]) == (204, True)
    assert "0.25" in str(said)


def test_laws_of_a_base_hold(admin: httpx.Client):
    """What `hilt update` refuses is refused with the reasons, by every way to write."""
    before = ask(admin, "SELECT * { GRAPH ?g { ?s ?p ?o } }", Prefer="fresh").json()
    turtle = {"Content-Type": "text/turtle"}
    graphs = [f"https://w3id.org/hilt/graph/{name}" for name in ("beliefs", "history", "mine")]

    refused = [admin.post("/update", data={"update": TRUST % "7"})]
    refused += [admin.post("/update", data={"update": "DROP GRAPH graph:history"})]
    for graph in graphs:
        place = {"graph": graph}
        refused += [admin.put("/store", params=place, content="<urn:s> <urn:p> 1", headers=turtle)]
        refused += [admin.post("/store", params=place, content="[] <urn:p> 1 .", headers=turtle)]
    refused += [admin.delete("/store", params={"graph": graphs[0]})]

    assert {one.status_code for one in refused} <= {409, 422}, [one.text for one in refused]
    assert refused[0].json()["findings"]
    after = ask(admin, "SELECT * { GRAPH ?g { ?s ?p ?o } }", Prefer="fresh").json()
    key = lambda row: sorted(map(str, row.items()))  # noqa: E731
    assert sorted(before["results"]["bindings"], key=key) == sorted(
        after["results"]["bindings"], key=key
    )


@pytest.mark.parametrize("roles", [("reader",), ("teacher", "operator")])
def test_only_admins_write_by_sparql(service: RunningService, roles: tuple[str, ...]):
    """Others may ask."""
    with service.client(*roles) as client:
        refused = [
            client.post("/update", data={"update": TRUST % "0"}),
            client.put("/store?default", content=""),
            client.delete("/store?default"),
        ]

        assert [one.status_code for one in refused] == [403, 403, 403]
        assert ask(client, USES).status_code == 200


def test_browser_is_led_to_the_page(admin: httpx.Client):
    """Who opens the address finds where to ask; a program finds what is offered."""
    page = admin.get("/sparql", headers={"Accept": "text/html,application/xhtml+xml,*/*;q=0.8"})
    description = admin.get("/sparql", headers={"Accept": "text/turtle"})

    assert (page.status_code, page.headers["location"]) == (303, "/#ask")
    assert "sparql-service-description#Service" in description.text


def test_commands_read_a_served_base(
    service: RunningService, admin: httpx.Client, monkeypatch: pytest.MonkeyPatch
):
    """As at any endpoint; its owner alone writes, and says so."""
    monkeypatch.setenv("HILT_KB_TOKEN", admin.headers["Authorization"].removeprefix("Bearer "))
    address = f"{service.url}/sparql#update,store"

    with KnowledgeBase.open(address) as base:
        assert [rule.object for rule in base.rules(affordance="cutting")] == ["knife"]
        assert base.answer("uses-of", object="knife").rows
        with pytest.raises(StoreError, match="has an owner"):
            base.set_trust("anna", 1)


def test_words_that_an_update_teaches_are_understood(admin: httpx.Client):
    """The agent of the service notices what was written past it."""
    command = "pass me the saw"
    with Agent.open("memory:", AgentConfig(simulate=False)) as other:
        other.hear("A saw is used for slicing")
        taught = list(other.base.store.quads(None, None, None, LEXICON))

    before = say(admin, "do", command, dry=True).json()["said"]
    changed = admin.post("/update", data={"update": insert_data(taught)})
    after = say(admin, "do", command, dry=True).json()["said"]

    assert changed.status_code == 204, changed.text
    assert before.startswith("I don't know what saw means")
    assert after == "I don't see a saw."
