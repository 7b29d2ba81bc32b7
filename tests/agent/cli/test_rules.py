"""The commands query and update: names, arguments, formats, limits, and what is refused."""

from __future__ import annotations

import csv
import io
import subprocess
import sys
from pathlib import Path

import pytest

from hilt.kb import Interval, KnowledgeBase, functional, grasping
from hilt.kb.sparql.named_queries import query_names

from .test_commands import LESSONS, Hilt

HIGH = Interval(0.95, 1)
RULES = (
    functional("knife", "cutting", interval=HIGH),
    grasping("knife", "handle", "pickUp", interval=HIGH),
    grasping("knife", "blade", "pass", interval=HIGH),
)


@pytest.fixture
def taught(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Hilt:
    """The command line over a base that was taught the running example."""
    with KnowledgeBase.open(tmp_path / "kb") as kb:
        for sentence, rule in zip(LESSONS, RULES, strict=True):
            kb.believe(sentence, "implies(x,y,high)", "sam", [rule])
    return Hilt(tmp_path / "kb", capfd)


USES = "SELECT ?object { ?object hilt:usedFor ?use }"
CROSS = "SELECT * { ?a ?b ?c . ?d ?e ?f . ?g ?h ?i . ?j ?k ?l } ORDER BY ?a"
TRUST = (
    "DELETE { GRAPH graph:beliefs { speaker:sam hilt:trustLower ?was } } "
    "INSERT { GRAPH graph:beliefs { speaker:sam hilt:trustLower 0.9 } } "
    "WHERE { GRAPH graph:beliefs { speaker:sam hilt:trustLower ?was } }"
)


def test_list_shows_every_question(taught: Hilt):
    """With its parameters, as a table or as JSON."""
    listed = taught("query", "--list", "--json").document

    assert tuple(one["name"] for one in listed) == query_names()
    assert all(one["question"].endswith("?") or one["parameters"] for one in listed)
    assert "best-for" in taught("query", "--list").out


def test_question_is_asked_by_its_name(taught: Hilt):
    """Arguments are bindings."""
    document = taught("query", "best-for", "--arg", "affordance=cutting", "--json").document

    (row,) = document["results"]["bindings"]
    assert row["object"]["value"].endswith("/object/knife")


def test_own_question_takes_arguments(taught: Hilt):
    """A value with a prefix is an individual; nothing is pasted into the text."""
    asked = "SELECT ?part { ?object hilt:graspedBy ?part } ORDER BY ?part"

    found = taught("query", asked, "--arg", "object=object:knife", "--json").document
    none = taught("query", asked, "--arg", "object=knife } #", "--json").document

    assert len(found["results"]["bindings"]) == 2
    assert none["results"]["bindings"] == []


def test_long_table_says_that_there_is_more(taught: Hilt):
    """Only the first thousand rows are laid out."""
    shown = taught("query", "SELECT ?o { ?s ?p ?o . ?a a ?b }").out

    assert "rows, of which the first 1000 are shown; all of them: --format csv" in shown


@pytest.mark.parametrize(
    ("format", "begins"),
    [("csv", "object\r\n"), ("tsv", "?object\n"), ("xml", "<?xml"), ("json", "{")],
)
def test_rows_come_in_every_format(taught: Hilt, format: str, begins: str):
    """And nothing else is on stdout."""
    assert taught("query", USES, "--format", format).out.startswith(begins)
    assert taught.code == 0


def test_csv_is_what_a_spreadsheet_reads(taught: Hilt):
    """One header, one row."""
    rows = list(csv.reader(io.StringIO(taught("query", USES, "--format", "csv").out)))

    assert rows == [["object"], ["https://w3id.org/hilt/object/knife"]]


def test_statements_come_as_turtle(taught: Hilt):
    """A CONSTRUCT gives a graph."""
    made = taught("query", "CONSTRUCT WHERE { ?s hilt:usedFor ?o }", "--format", "turtle").out

    assert "object:knife hilt:usedFor affordance:cutting ." in made


def test_question_is_read_from_a_file_or_stdin(
    taught: Hilt, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """A .rq file with declared parameters takes them as the named ones do."""
    (tmp_path / "mine.rq").write_text(
        "# What is it used for?\n# ?object  object  it\nSELECT ?use { ?object hilt:usedFor ?use }"
    )
    stdin = io.TextIOWrapper(io.BytesIO(USES.encode()))

    by_file = taught("query", str(tmp_path / "mine.rq"), "--arg", "object=knife", "--json").document
    monkeypatch.setattr("sys.stdin", stdin)
    by_stdin = taught("query", "-", "--json").document

    assert len(by_file["results"]["bindings"]) == len(by_stdin["results"]["bindings"]) == 1


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (("SELECT * { SERVICE <http://x/> { ?s ?p ?o } }",), "SERVICE is refused"),
        (("bestfor",), 'Did you mean "best-for"?'),
        (("best-for", "--arg", "affordance"), "expected NAME=VALUE"),
        (("best-for", "--arg", "object=knife"), 'no parameter "object"'),
        ((USES, "--format", "pdf"), 'no result format "pdf"'),
        ((USES, "--format", "turtle"), "CONSTRUCT or DESCRIBE"),
        ((), "No query was given"),
        (("nowhere.rq",), "cannot be read"),
    ],
)
def test_what_goes_wrong_is_one_line(taught: Hilt, arguments: tuple[str, ...], said: str):
    """And exit code 2: the question is to be changed."""
    taught("query", *arguments)

    assert (taught.code, taught.out) == (2, "")
    assert said in taught.err and len(taught.err.splitlines()) == 1


@pytest.mark.parametrize(
    ("limit", "said"),
    [
        (("--timeout", "0.5"), "longer than 0.5 s and was stopped"),
        (("--memory", "20", "--timeout", "60"), "more than 20 MB and was stopped"),
    ],
)
def test_what_is_stopped_was_asked_for_in_the_right_way(
    taught: Hilt, limit: tuple[str, ...], said: str
):
    """So the exit code is 1: it failed."""
    taught("query", CROSS, *limit)

    assert (taught.code, taught.out) == (1, "")
    assert said in taught.err and len(taught.err.splitlines()) == 1


def test_base_in_use_can_be_asked(taught: Hilt):
    """While another process has it open, it is read as it is now."""
    program = (
        "import sys; from hilt.kb import KnowledgeBase\n"
        "kb = KnowledgeBase.open(sys.argv[1]); print('open', flush=True); sys.stdin.read()"
    )
    with subprocess.Popen(
        [sys.executable, "-c", program, str(taught.kb)],
        stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True,
    ) as owner:  # fmt: skip
        assert owner.stdout is not None
        owner.stdout.readline()
        found = taught("query", USES, "--json").document
        refused = taught("tell", "A saw is used for cutting")
        owner.communicate()

    assert len(found["results"]["bindings"]) == 1
    assert refused.code == 1 and "in use by another process" in refused.err


def test_update_changes_the_base(taught: Hilt):
    """It is kept in the history, and a dry run only says that it could be done."""
    assert taught("update", TRUST, "--dry-run", "--json").document["updated"] is False
    done = taught("update", TRUST, "--json").document
    found = taught("query", "SELECT ?o { speaker:sam hilt:trustLower ?o }", "--format", "csv").out

    assert done == {"updated": True, "sequence": 4}
    assert found.splitlines() == ["o", "0.9"]


def test_update_without_effect_says_so(taught: Hilt):
    """It has no number in the history."""
    assert taught("update", "INSERT DATA {}").err == "That changes nothing.\n"

    done = taught("update", "INSERT DATA {}", "--json").document
    assert done == {"updated": False, "sequence": None}


@pytest.mark.parametrize(
    ("text", "code", "said"),
    [
        ("INSERT DATA {", 2, "wrong at line 1"),
        ("LOAD <http://x/>", 2, "LOAD is refused"),
        ("INSERT DATA { <urn:a> <urn:b> 1 }", 1, "without a name"),
    ],
)
def test_update_that_cannot_be_is_refused(taught: Hilt, text: str, code: int, said: str):
    """One line, and the base is as it was."""
    taught("update", text)

    assert (taught.code, taught.out) == (code, "") and said in taught.err
    assert taught("query", "ASK { <urn:a> ?p ?o }", "--json").document["boolean"] is False
