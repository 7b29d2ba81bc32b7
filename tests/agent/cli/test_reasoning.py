"""The commands that show the reasoning."""

import json
import shutil
import sys
from collections.abc import Callable
from pathlib import Path
from xml.etree import ElementTree

import pytest

from hilt.agent.agent import Agent
from hilt.agent.cli import main
from hilt.agent.config import AgentConfig
from hilt.inference.interval_operators import (
    ACCEPTANCES,
    CONJUNCTIONS,
    FUSIONS,
    MODUS_PONENS,
    RANKINGS,
)
from hilt.inference.settings import DETECTIONS, STAGES

Run = Callable[..., tuple[int, str]]
TAUGHT = (
    "A knife is often used for cutting",
    "A spoon is sometimes used for cutting",
    "To pass a knife grab the knife by the blade",
)


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A base that was taught the three sentences, to be copied."""
    folder = tmp_path_factory.mktemp("taught") / "kb"
    with Agent.open(str(folder), AgentConfig(simulate=False)) as agent:
        for sentence in TAUGHT:
            agent.hear(sentence)
    return folder


@pytest.fixture
def run(taught: Path, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> Run:
    """Runs a command on a taught base; gives its exit code and what it printed."""
    shutil.copytree(taught, tmp_path / "kb")

    def call(*arguments: str) -> tuple[int, str]:
        capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([*arguments, "--kb", str(tmp_path / "kb")])
        return int(ended.value.code or 0), capfd.readouterr().out

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


def test_explain_says_which_norm_prevails_and_why(run: Run):
    """Both norms stand in words with the reason, and by their ids in the JSON."""
    run("tell", "never pick up the mug")
    run("tell", "you may pick up the mug by the handle")

    _, said = run("explain", "pick up the mug by the handle")
    _, out = run("explain", "--json", "pick up the mug by the handle")

    said = " ".join(said.split())
    assert said.index('"I must not pick up a mug": it is more specific') > said.index("prevails")
    (conflict,) = json.loads(out)["norms"][0]["conflicts"]
    assert conflict["because"] == "more specific"


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
    assert "told Sam: " in words


def test_drawing_without_matplotlib_names_the_extra(
    taught: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
):
    """The error is one line that says which extra of Hilt to install."""
    monkeypatch.setitem(sys.modules, "matplotlib", None)
    command = "pass me something used for cutting"
    picture = tmp_path / "proof.svg"

    with pytest.raises(SystemExit) as ended:
        main(["explain", command, "--svg", str(picture), "--kb", str(taught)])

    (line,) = capfd.readouterr().err.splitlines()
    assert ended.value.code == 1 and "hilt[report]" in line and not picture.exists()


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


# --- Choices, contexts, actions ------------------------------------------------------------

COMMAND = "pass me something used for cutting"
CHOICES = [
    f"{choice}={name}"
    for choice, names in {
        "conjunction": CONJUNCTIONS,
        "modus_ponens": MODUS_PONENS,
        "fusion": FUSIONS,
        "ranking": RANKINGS,
        "acceptance": ACCEPTANCES,
        "stage": STAGES,
        "detection": DETECTIONS,
    }.items()
    for name in names
]


@pytest.mark.parametrize("choice", CHOICES)
def test_every_choice_of_the_theory_can_be_made_by_name(run: Run, choice: str):
    """With each of them the knife is still the better thing to cut with."""
    code, out = run("explain", "--json", "--set", choice, COMMAND)

    assert code == 0
    first = json.loads(out)["proofs"][0]
    assert (first["name"], first["accepted"]) == ("knife", True)


def test_settings_come_from_a_file_and_single_ones_go_before_it(run: Run, tmp_path: Path):
    """The file asks for too much; the option takes that back."""
    path = tmp_path / "careful.yaml"
    path.write_text("threshold: {default: 0.5}\nfusion: cautious\n", encoding="utf-8")

    careful, _ = run("do", "--no-sim", "--settings", str(path), COMMAND)
    done, _ = run("do", "--no-sim", "--settings", str(path), "--set", "threshold=0.1", COMMAND)

    assert (careful, done) == (1, 0)


@pytest.mark.parametrize(
    "options",
    [
        ["--set", "fusion=mixed"],
        ["--set", "fusion"],
        ["--context", "kitchen"],
        ["--context", "place:kitchen=much"],
        ["--context", "place:kitchen=1.5"],
        ["--settings", "nowhere.yaml"],
        ["--actions", "nowhere.yaml"],
    ],
)
def test_wrong_choice_is_wrong_usage(run: Run, options: list[str]):
    """One line, exit code 2, and nothing is done."""
    code, out = run("do", "--no-sim", *options, COMMAND)

    assert (code, out) == (2, "")


SHEET = """speaker: sam
rules:
  - {features: [property:sharp, part:blade], contexts: [place:kitchen], functor: cutWith,
     argument: object:bread, interval: [0.9, 1]}
"""
CUT = """trees:
  cut:
    parameters: [patient, tool]
    defaults: {tool: {affords: cutWith, of: patient}}
    steps: [{pickUp: tool}, {moveAbove: patient}, {lower: }]
"""


def test_general_rule_goes_from_its_sheet_to_the_decision(run: Run, tmp_path: Path):
    """Import, store, inference, proof, decision, walk: with the context, and not without."""
    sheet, actions = tmp_path / "rules.yaml", tmp_path / "actions.yaml"
    sheet.write_text(SHEET, encoding="utf-8")
    actions.write_text(CUT, encoding="utf-8")
    run("import", str(sheet))
    given = ("--actions", str(actions), "--json")

    nowhere, _ = run("do", "--no-sim", *given, "cut the bread")
    code, out = run("do", "--no-sim", *given, "--context", "place:kitchen=0.9", "cut the bread")
    _, why = run("explain", *given, "--context", "place:kitchen=0.9", "cut the bread")

    assert (nowhere, code) == (1, 0)
    decision, steps = json.loads(out)["decision"], json.loads(out)["steps"]
    assert (decision["object"], decision["patient"]) == ("knife", "bread")
    assert decision["lower"] == pytest.approx(0.81)
    assert [step["node"] for step in steps][-2:] == ["cut/moveAbove", "cut/lower"]
    proof = json.loads(why)["proofs"][0]["proof"]
    assert proof["about"] == "knife affords cutWith(object:bread)"
    about = {each.get("about") for each in proof["inputs"][0]["inputs"]}
    assert about == {"part:blade seen on knife", "place:kitchen", "property:sharp seen on knife"}


def test_general_rule_is_read_backwards(run: Run, tmp_path: Path):
    """What would have to be true for something to cut bread?"""
    sheet = tmp_path / "rules.yaml"
    sheet.write_text(SHEET, encoding="utf-8")
    run("import", str(sheet))

    code, out = run("abduce", "--json", "cutWith(bread)", "--given", "property:sharp")

    (found,) = json.loads(out)
    assert (code, found["features"], found["contexts"]) == (0, ["part:blade"], ["place:kitchen"])


def test_full_conflict_under_dempster_is_told(run: Run, tmp_path: Path):
    """Two who are certain of the contrary: nothing can be decided, and the robot says so."""
    run("tell", "A mug is always used for rolling")
    run("trust", "kim", "1")
    sheet = "speaker: kim\nrules: [{object: mug, affordance: rolling, interval: [0, 0]}]\n"
    path = tmp_path / "kim.yaml"
    path.write_text(sheet, encoding="utf-8")
    run("import", str(path))

    code, out = run(
        "do", "--no-sim", "--json", "--set", "fusion=dempster", "pass me something used for rolling"
    )

    assert code == 1
    assert "contradict each other fully" in json.loads(out)["said"]
