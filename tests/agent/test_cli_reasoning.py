# SPDX-License-Identifier: Apache-2.0
"""The commands that show the reasoning."""

import json
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from hilt.agent.cli import main

Run = Callable[..., tuple[int, str]]
TAUGHT = (
    "A knife is often used for cutting",
    "A spoon is sometimes used for cutting",
    "To pass a knife grab the knife by the blade",
)


@pytest.fixture
def run(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Run:
    """Runs a command on one base; gives its exit code and what it printed."""

    def call(*arguments: str) -> tuple[int, str]:
        capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([*arguments, "--kb", str(tmp_path / "kb")])
        return int(ended.value.code or 0), capfd.readouterr().out

    for sentence in TAUGHT:
        call("tell", sentence)
    return call


def test_explain_proves_every_candidate_and_what_would_change_it(run: Run):
    """The proofs rest on the sentences; the smallest change is told first."""
    code, out = run("explain", "--json", "pass me something used for cutting")

    document = json.loads(out)
    assert (code, document["outcome"]) == (0, "done")
    about = [(proof["name"], proof["node"]) for proof in document["proofs"]]
    assert about == [
        ("knife", "pass/findObject"),
        ("spoon", "pass/findObject"),
        ("knife", "pass/graspObject"),
    ]
    assert document["changes"][0]["chosen"] == "spoon"


def test_explain_leaves_no_trace(run: Run):
    """Explaining is not commanding: nothing goes into the history."""
    run("explain", "pass me something used for cutting")

    _, out = run("query", "--json", "SELECT ?e { GRAPH ?g { ?e a hilt:Episode } }")

    assert json.loads(out)["results"]["bindings"] == []


def test_explain_draws_the_proof(run: Run, tmp_path: Path):
    """The picture is SVG with a box for each step."""
    run("explain", "pass me something used for cutting", "--svg", str(tmp_path / "proof.svg"))

    root = ElementTree.parse(tmp_path / "proof.svg").getroot()  # noqa: S314 - our own file
    words = " ".join(text.text or "" for text in root.iter("{http://www.w3.org/2000/svg}text"))
    assert words.count("modus ponens") == 2
    assert "said sam" in words


def test_conflicts_list_what_contradicts(run: Run):
    """A denial of what was told before is a conflict."""
    run("tell", "A knife is never used for cutting")

    _, out = run("conflicts", "--json")

    (conflict,) = json.loads(out)
    assert conflict["weight"] == pytest.approx(0.75 * 0.95)
    assert {rule["upper"] for rule in conflict["rules"]} == {1.0, 0.05}


def test_induce_gives_rules_with_their_reasons(run: Run):
    """The screwdriver is like the knife, and its shaft like the blade."""
    _, out = run("induce", "--json")

    rules = {(rule["object"], rule["context"]): rule for rule in json.loads(out)}
    screwdriver = rules["screwdriver", "pass"]
    assert (screwdriver["part"], screwdriver["status"]) == ("shaft", "induced")
    assert "property:pointed" in screwdriver["shared"]


def test_abduce_names_the_context_that_explains(run: Run):
    """Passing explains a knife held by the blade; nothing explains a mug held so."""
    code, out = run("abduce", "--json", "part:blade", "--given", "object:knife")
    nothing, _ = run("abduce", "--json", "part:blade", "--given", "object:mug")

    assert (code, nothing) == (0, 1)
    assert json.loads(out)[0]["contexts"] == ["action:pass"]


def test_learned_words_are_listed_and_known_in_the_next_process(run: Run):
    """A word taught once is in the base."""
    run("tell", "A saw is used for slicing")

    _, out = run("words", "--json")
    _, answer = run("ask", "--json", "what are saws used for?")

    assert {(word["word"], word["kind"]) for word in json.loads(out)} == {
        ("saw", "object"),
        ("slicing", "affordance"),
    }
    assert json.loads(answer)["said"] == "A saw is used for slicing."


def test_tables_are_printed_for_people(run: Run):
    """Without `--json` each shows a table."""
    run("tell", "A knife is never used for cutting")

    for arguments in (["conflicts"], ["induce"], ["abduce", "part:blade"], ["words"]):
        _, out = run(*arguments)
        assert "┃" in out
    assert "speaks against it" in run("explain", "pass me something used for cutting")[1]
