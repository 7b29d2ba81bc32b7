"""Claims about SPARQL updates by hand: none breaks a base."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator, Sequence
from dataclasses import replace
from decimal import Decimal
from pathlib import Path

import pytest
import yaml
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from hilt.kb import sparql_update
from hilt.kb.formats.import_export import export_file, import_file
from hilt.kb.formats.registry import FORMATS
from hilt.kb.interval import Interval
from hilt.kb.invariants import check_invariants
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.learned import LearnedPhrase, LearnedWord
from hilt.kb.rdf.terms import Literal, Quad
from hilt.kb.rule import Atom, functional
from hilt.kb.sparql.query_text import delete_insert
from hilt.kb.sparql.results import QueryLimits
from hilt.kb.sparql_update import update
from hilt.kb.stores.opening import open_store
from hilt.kb.stores.query_subprocess import WorkerProcess
from hilt.kb.validation import findings
from hilt.ontology.actions import Actions
from hilt.ontology.errors import QueryError, ValidationError
from hilt.ontology.objects import load_objects
from hilt.ontology.vocabulary import PREFIXES

from .conftest import BLADE, PAPER, ticking
from .test_episodes import EPISODE
from .test_taught_actions import SERVE

TRUST = """
DELETE { GRAPH graph:beliefs { speaker:sam hilt:trustLower ?was } }
INSERT { GRAPH graph:beliefs { speaker:sam hilt:trustLower 0.9 } }
WHERE { GRAPH graph:beliefs { speaker:sam hilt:trustLower ?was } }
"""
UPDATES = yaml.safe_load((Path(__file__).parent / "data" / "updates.yaml").read_text("utf-8"))
MUTATIONS = int(os.environ.get("HILT_MUTATIONS", "12"))
DONE = [case["text"] for case in UPDATES if case.get("done")]
VALUES = (Decimal(7), Decimal("0.5"), 1, "x", True, Literal("0.5", f"{PREFIXES['xsd']}float"))


class SharedWorker(WorkerProcess):
    """A worker process that outlives an update, so that many take little time."""

    def close(self) -> None:
        """Leave it running."""


@pytest.fixture(scope="module")
def worker() -> Iterator[WorkerProcess]:
    """One worker process for all updates of this module."""
    shared = SharedWorker()
    yield shared
    WorkerProcess.close(shared)


@pytest.fixture
def quick(worker: WorkerProcess, monkeypatch: pytest.MonkeyPatch) -> None:
    """Updates use that one."""
    monkeypatch.setattr("hilt.kb.sparql_update.WorkerProcess", lambda: worker)


@pytest.fixture(scope="module")
def shared() -> Iterator[KnowledgeBase]:
    """A base that has something in each graph."""
    with KnowledgeBase(open_store("memory:"), clock=ticking()) as base:
        for text, predicate, rule in PAPER:
            base.believe(text, predicate, "sam", [rule])
        word = LearnedWord(Atom("object", "spork"), "a spork is an object", "sam")
        base.believe(word.said, "", "sam", [], words=[word])
        base.learn_phrase(LearnedPhrase("?object please", '{"goal":"pass"}', "mug please", "sam"))
        base.believe(SERVE.said, "", "sam", (), actions=[SERVE])
        gone = replace(functional("fork", "eating", interval=Interval(0.9, 1)), speaker="anna")
        base.believe("A fork is used for eating.", "", "anna", [gone])
        base.retract(gone.id, "forget it", "", "sam")
        base.set_trust("anna", 0.5)
        base.record_episode(EPISODE)
        base.load_domain({"knife": load_objects()["knife"]}, Actions({}, {}))
        yield base


@pytest.fixture
def base(shared: KnowledgeBase, quick: None) -> Iterator[KnowledgeBase]:
    """That base; what a test changes is undone."""
    before = set(shared.store.quads())
    yield shared
    after = set(shared.store.quads())
    shared.store.apply(delete=after - before, insert=before - after)


def said_of(case_text: str) -> str:
    """The text of a case, with the name of its rule."""
    return case_text.replace("BLADE", BLADE.id.replace("/", ":"))


def check_refused_or_valid(base: KnowledgeBase, text: str) -> None:
    """Whatever an update is, the base is then unchanged, or it is valid and learns."""
    before = set(base.store.quads())
    try:
        update(base, text)
    except (ValidationError, QueryError):
        assert set(base.store.quads()) == before
        return
    assert findings(base.store, whole=True) == []
    mug = functional("mug", "pouring", interval=Interval(0.8, 1))
    said = base.believe("A mug is used for pouring.", "", "sam", [mug])
    assert base.rule(mug.id).utterance == said.sequence == base.sequence
    assert [*check_invariants(base.store, whole=True)] == []


@pytest.mark.parametrize("case", UPDATES, ids=lambda case: " ".join(case["text"].split())[:60])
def test_update_is_refused_or_harmless(case: dict[str, object], base: KnowledgeBase):
    """What is refused leaves the base as it was; after any other one it is valid."""
    text, before = said_of(str(case["text"])), set(base.store.quads())

    if "refused" in case:
        with pytest.raises((ValidationError, QueryError)) as caught:
            update(base, text)
        said = "; ".join(getattr(caught.value, "findings", [str(caught.value)]))
        assert re.search(str(case["refused"]), said), said
    else:
        assert bool(update(base, text)) == case["done"]
        assert [*check_invariants(base.store, whole=True)] == []
    assert (set(base.store.quads()) != before) == case.get("done", False)


def test_base_is_usable_after_all_lawful_updates(base: KnowledgeBase, tmp_path: Path):
    """It validates, learns and answers; each format is written, and comes back."""
    for text in DONE:
        update(base, said_of(text))

    assert findings(base.store, whole=True) == []
    mug = functional("mug", "pouring", interval=Interval(0.8, 1))
    base.believe("A mug is used for pouring.", "", "sam", [mug])
    assert base.answer("best-for", affordance="pouring").rows
    known = {rule.id: rule.status for rule in base.rules(status=None)}
    for name, about in FORMATS.items():
        file = tmp_path / f"all.{name}"
        export_file(base, file, format=name)
        with KnowledgeBase.open("memory:") as other:
            import_file(other, file, format=name)
            came_back = {rule.id: rule.status for rule in other.rules(status=None)}
            assert came_back.items() <= known.items()
            assert not about.whole or came_back == known


@st.composite
def mutations(draw: st.DrawFn, quads: Sequence[Quad]) -> tuple[Quad, Quad | None]:
    """A statement, and what takes its place: another value, subject or graph, or nothing."""
    quad, other = draw(st.sampled_from(quads)), draw(st.sampled_from(quads))
    changed = {
        "none": None,
        "value": quad._replace(object=draw(st.sampled_from([*VALUES, other.object]))),
        "predicate": quad._replace(predicate=other.predicate),
        "subject": quad._replace(subject=other.subject),
        "graph": quad._replace(graph=other.graph),
    }
    return quad, changed[draw(st.sampled_from(sorted(changed)))]


@given(st.data())
@settings(
    max_examples=MUTATIONS,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
def test_no_mutation_of_a_valid_base_breaks_it(base: KnowledgeBase, data: st.DataObject):
    """Any statement deleted, replaced or added: refused, or a base that learns and is valid."""
    before = sorted(base.store.quads(), key=str)
    old, new = data.draw(mutations(before))
    keeps = data.draw(st.booleans())

    check_refused_or_valid(base, delete_insert([] if keeps else [old], [new] if new else []))

    after = set(base.store.quads())
    base.store.apply(delete=after - {*before}, insert={*before} - after)


def test_lawful_update_is_applied_and_remembered(paper: KnowledgeBase):
    """The base changes, and the history says by which update, whose and when."""
    said = update(paper, f"{TRUST} ; # done", speaker="anna")

    assert said is not None
    assert paper.trust("sam") == Interval(0.9, 1)
    assert (paper.sequence, said.sequence) == (4, 4)
    assert paper.utterance(4) == said
    assert (said.kind, said.speaker) == ("update", "anna") and "trustLower" in said.text


def test_update_of_a_status_retracts_the_rule(base: KnowledgeBase):
    """With its edges, and the history says which; made active again it is asserted again."""
    change = """WITH graph:beliefs DELETE { BLADE hilt:status ?was }
        INSERT { BLADE hilt:status hilt:%s } WHERE { BLADE hilt:status ?was }"""

    gone = update(base, said_of(change % "retracted"))

    assert gone and gone.retracts == (BLADE.id,)
    assert base.rules_at_nodes([BLADE.node]) == []
    back = update(base, said_of(change % "active"))
    assert back and back.asserts == (BLADE.id,)
    assert [one.utterance for one in base.rules_at_nodes([BLADE.node])] == [back.sequence]


def test_where_sees_all_graphs_as_a_query_does(base: KnowledgeBase):
    """USING and GRAPH choose one."""
    change = "INSERT { GRAPH graph:beliefs { speaker:eve a hilt:Speaker ; rdfs:label ?name } }"

    assert not update(
        base,
        f'{change} USING graph:lexicon WHERE {{ speaker:sam rdfs:label ?n BIND("eve" AS ?name) }}',
    )
    assert update(base, f'{change} WHERE {{ speaker:sam rdfs:label ?n BIND("eve" AS ?name) }}')


def test_dry_run_changes_nothing(paper: KnowledgeBase):
    """It only says that it could be done."""
    before = set(paper.store.quads())

    assert update(paper, TRUST, dry_run=True)
    assert set(paper.store.quads()) == before


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("LOAD <file:///etc/passwd> INTO GRAPH graph:beliefs", "LOAD is refused"),
        ("INSERT { GRAPH ?g { ?s ?p ?o } } WHERE { SERVICE <urn:x> { ?s ?p ?o } }", "SERVICE is"),
        ("INSERT DATA {", "wrong at line 1, column 14"),
        ("PREFIX a: <u:a>\nADD graph:a TO graph:b ;\nINSERT DATA { a:b a:c }", "line 3, column 23"),
        ("DELETE WHERE { hilt:a hilt:b ?c } INSERT DATA { hilt:a hilt:b 1 }", "line 1, column 35"),
        ("INSERTDATA { }", "is no operation"),
        (" ; # nothing", "is empty"),
        ("", "is empty"),
    ],
)  # fmt: skip
def test_wrong_update_is_told(base: KnowledgeBase, text: str, said: str):
    """What reaches outside, and plain mistakes, at their place in the text as it was typed."""
    before = base.sequence

    with pytest.raises(QueryError, match=said):
        update(base, text)

    assert base.sequence == before


def test_update_that_takes_too_long_is_stopped(paper: KnowledgeBase):
    """Before it has touched the base."""
    endless = (
        "INSERT { GRAPH graph:beliefs { ?a <urn:p> ?x } } WHERE { GRAPH ?g { ?a ?b ?c . ?d ?e ?f . "
        "?k ?h ?i . ?j ?l ?m } BIND(CONCAT(STR(?a), STR(?d), STR(?k), STR(?j)) AS ?x) }"
    )

    with pytest.raises(QueryError, match="took longer than 1 s"):
        update(paper, endless, limits=QueryLimits(seconds=1))

    assert paper.sequence == 3


def test_update_of_too_many_statements_is_refused(
    base: KnowledgeBase, monkeypatch: pytest.MonkeyPatch
):
    """It says how many are allowed."""
    monkeypatch.setattr(sparql_update, "MAX_CHANGED", 3)

    with pytest.raises(QueryError, match="more than 3 statements"):
        update(base, "CLEAR GRAPH graph:lexicon")
