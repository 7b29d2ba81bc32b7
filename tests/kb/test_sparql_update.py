"""Claims about SPARQL updates by hand."""

from __future__ import annotations

import pytest

from hilt.kb.interval import Interval
from hilt.kb.knowledge_base import KnowledgeBase
from hilt.kb.sparql.results import QueryLimits
from hilt.kb.sparql_update import update
from hilt.ontology.errors import QueryError, ValidationError

TRUST = """
DELETE { GRAPH graph:beliefs { speaker:sam hilt:trustLower ?was } }
INSERT { GRAPH graph:beliefs { speaker:sam hilt:trustLower 0.9 } }
WHERE { GRAPH graph:beliefs { speaker:sam hilt:trustLower ?was } }
"""


def test_lawful_update_is_applied_and_remembered(paper: KnowledgeBase):
    """The base changes, and the history says by which update, whose and when."""
    said = update(paper, f"{TRUST} ; # done", speaker="anna")

    assert said is not None
    assert paper.trust("sam") == Interval(0.9, 1)
    assert (paper.sequence, said.sequence) == (4, 4)
    assert paper.utterance(4) == said
    assert (said.kind, said.speaker) == ("update", "anna") and "trustLower" in said.text


@pytest.mark.parametrize(
    "text",
    [
        "INSERT DATA {}",
        "DELETE WHERE { GRAPH graph:beliefs { ?r hilt:lower 0.123 } }",
        "INSERT { GRAPH graph:beliefs { ?s ?p ?o } } WHERE { GRAPH graph:beliefs { ?s ?p ?o } }",
    ],
)
def test_update_that_changes_nothing_is_not_remembered(paper: KnowledgeBase, text: str):
    """The base is as it was, its history too."""
    before = set(paper.store.quads())

    assert update(paper, text) is None
    assert set(paper.store.quads()) == before


def test_dry_run_changes_nothing(paper: KnowledgeBase):
    """It only says that it could be done."""
    before = set(paper.store.quads())

    update(paper, TRUST, dry_run=True)

    assert set(paper.store.quads()) == before


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("DELETE WHERE { GRAPH graph:beliefs { ?r hilt:lower ?l } }", "rule"),
        ("INSERT DATA { <urn:a> <urn:b> 1 }", "without a name"),
        ("INSERT DATA { GRAPH <urn:g> { <urn:a> <urn:b> 1 } }", "is not one of a base"),
        ("CLEAR GRAPH graph:base", "must not change the (number|format)"),
        ("DROP ALL", "must not change the (number|format)"),
        ("DROP GRAPH graph:history", "utterance:1: An update must not change the history"),
        ("DELETE WHERE { GRAPH graph:history { utterance:2 ?p ?o } }", "utterance:2: .* history"),
        ("INSERT DATA { GRAPH graph:history { utterance:9 a hilt:Utterance } }", "utterance:9"),
        ("DROP GRAPH graph:beliefs", "An update must keep every rule"),
        ("INSERT DATA { GRAPH graph:beliefs { rule:1 hilt:lower 2.0 } }", "rule:1"),
    ],
)  # fmt: skip
def test_update_that_would_break_the_base_is_refused(paper: KnowledgeBase, text: str, said: str):
    """It says what would be wrong, and the base is as it was."""
    before = set(paper.store.quads())

    with pytest.raises(ValidationError, match=said):
        update(paper, text)

    assert set(paper.store.quads()) == before


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("LOAD <file:///etc/passwd> INTO GRAPH graph:beliefs", "LOAD is refused"),
        ("INSERT { GRAPH ?g { ?s ?p ?o } } WHERE { SERVICE <urn:x> { ?s ?p ?o } }", "SERVICE is"),
        ("INSERT { GRAPH ?g { <urn:s> ?p ?u } } WHERE { BIND(uuid() AS ?u) }", "UUID is refused"),
        ("INSERT DATA {", "wrong at line 1"),
        (" ; # nothing", "is empty"),
        ("", "is empty"),
    ],
)  # fmt: skip
def test_wrong_update_is_told(paper: KnowledgeBase, text: str, said: str):
    """What reaches outside, what would differ each time, and plain mistakes."""
    with pytest.raises(QueryError, match=said):
        update(paper, text)

    assert paper.sequence == 3


def test_update_that_takes_too_long_is_stopped(paper: KnowledgeBase):
    """Before it has touched the base."""
    endless = (
        "INSERT { GRAPH graph:beliefs { ?a <urn:p> ?x } } WHERE { GRAPH ?g { ?a ?b ?c . ?d ?e ?f . "
        "?k ?h ?i . ?j ?l ?m } BIND(CONCAT(STR(?a), STR(?d), STR(?k), STR(?j)) AS ?x) }"
    )

    with pytest.raises(QueryError, match="took longer than 1 s"):
        update(paper, endless, limits=QueryLimits(seconds=1))

    assert paper.sequence == 3
