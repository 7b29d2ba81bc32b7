"""The commands on what was said, how bases differ, and whom to believe."""

import json
import shutil
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest

from hilt.agent.agent import Agent
from hilt.agent.cli import main
from hilt.agent.config import AgentConfig
from hilt.kb import KnowledgeBase
from hilt.kb.episodes import Episode, GraspTrial

Run = Callable[..., tuple[int, str, str]]
CUT, PASS = "A knife is used for cutting", "To pass a knife grab the knife by the blade"


@pytest.fixture
def hilt(capfd: pytest.CaptureFixture[str]) -> Run:
    """Runs a command; gives its exit code and what it printed."""

    def call(*arguments: str | Path) -> tuple[int, str, str]:
        capfd.readouterr()
        with pytest.raises(SystemExit) as ended:
            main([str(argument) for argument in arguments])
        return int(ended.value.code or 0), *capfd.readouterr()

    return call


@pytest.fixture(scope="module")
def taught(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a base that was taught two sentences; only for copying."""
    folder = tmp_path_factory.mktemp("taught") / "kb"
    with Agent.open(str(folder), AgentConfig(simulate=False)) as agent:
        for sentence in (CUT, PASS):
            agent.hear(sentence)
    return folder


@pytest.fixture
def run(hilt: Run, tmp_path: Path, taught: Path) -> Run:
    """The same on one base that was taught two sentences."""
    shutil.copytree(taught, tmp_path / "kb")
    return lambda *arguments: hilt(*arguments, "--kb", tmp_path / "kb")


def document(result: tuple[int, str, str]) -> object:
    """What a command printed, which succeeded."""
    assert result[0] == 0, result
    return json.loads(result[1])


def test_history_tells_what_was_said_and_did(run: Run):
    """All of it, or what one said, or the last."""
    run("tell", "A mug is used for drinking", "--speaker", "anna")

    said = document(run("history", "--json"))
    last = document(run("history", "--json", "--last", "1"))
    hers = document(run("history", "--json", "--speaker", "anna"))

    assert [each["text"] for each in said[:2]] == [CUT, PASS]
    assert [each["sequence"] for each in last] == [3]
    assert [each["accepted"] for each in hers] == [False]
    assert "told 1" in run("history")[1]


def test_history_of_a_rule_tells_what_touched_it(run: Run):
    """From being told to being taken back."""
    rule = document(run("rules", "--json", "--part", "blade"))[0]["id"]
    run("forget", rule)

    said = document(run("history", "--about", rule, "--json"))

    assert [each["text"] for each in said] == [PASS, f"forget {rule}"]


def test_forgotten_rule_is_gone_but_was_there(run: Run):
    """`--at` shows the base before; the history keeps both."""
    code, said, _ = run("forget", "last")

    assert (code, "graspObject(part:blade)" in said) == (0, True)
    assert len(document(run("rules", "--json"))) == 1
    assert len(document(run("rules", "--at", "2", "--json"))) == 2
    assert document(run("rules", "--at", "2020-01-01", "--json")) == []


def test_forgetting_by_a_start_of_the_id(run: Run):
    """A few digits are enough; the second time it is over already."""
    rule = document(run("rules", "--json", "--affordance", "cutting"))[0]["id"]

    gone = document(run("forget", rule[5:13], "--json"))
    again = run("forget", rule[5:13])

    assert [each["id"] for each in gone["retracted"]] == [rule]
    assert again[0] == 1
    assert "is retracted already" in again[2]


def test_forgetting_a_word(run: Run):
    """A learned word is known no more."""
    run("tell", "A zester is used for grating")
    learned = document(run("words", "--json"))[0]["word"]

    code, said, _ = run("forget", "word", learned)

    assert (code, said) == (0, f'Forgot the word "{learned}".\n')
    assert learned not in {each["word"] for each in document(run("words", "--json"))}


def test_forgetting_a_phrase(run: Run, tmp_path: Path):
    """It is named by what was said, and is remembered no more."""
    said = "a spoon is what comes out here for cutting"
    with Agent.open(str(tmp_path / "kb"), AgentConfig(simulate=False)) as agent:
        agent.hear(said)
        agent.hear("yes")
    (phrase,) = (each for each in document(run("words", "--json")) if each["kind"] == "phrase")

    code, answer, _ = run("forget", "phrase", said)

    assert (code, answer) == (0, f'Forgot the phrase "{phrase["word"]}".\n')
    assert "phrase" not in {each["kind"] for each in document(run("words", "--json"))}


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("forget", "rule/0000000000000000"), 1, "no rule"),
        (("forget", "a", "b", "c"), 2, 'Expected RULE, "last"'),
        (("forget", "last", "--speaker", "eve"), 1, 'holds by "eve"'),
        (("forget", "word", "zester"), 1, 'no learned word "zester"'),
        (("rules", "--at", "yesterday"), 2, "expected a date"),
        (("rules", "--at", "99"), 1, "no utterance"),
        (("rules", "--according-to", "eve"), 1, 'no speaker "eve"'),
        (("history", "--about", "rule/0000000000000000"), 1, "no rule"),
        (("trust", "eve"), 1, 'no trusted speaker "eve"'),
    ],
)
def test_what_is_not_there_and_what_is_no_use_are_told_apart(
    run: Run, arguments: tuple[str, ...], code: int, said: str
):
    """In one line each: 1 where the base does not have it, 2 where it makes no sense."""
    found, out, error = run(*arguments)

    assert (found, out) == (code, "")
    assert said in error
    assert error.count("\n") == 1


def test_one_persons_view(run: Run):
    """What one taught, whatever others took back."""
    run("trust", "anna", "0.5")
    run("tell", "A mug is used for drinking", "--speaker", "anna")
    run("forget", "last", "--speaker", "anna")

    assert len(document(run("rules", "--according-to", "sam", "--json"))) == 2
    assert document(run("rules", "--according-to", "anna", "--json")) == []


def test_trust_is_set_and_shown(run: Run):
    """One speaker, or all."""
    run("trust", "anna", "0.5")

    assert document(run("trust", "anna", "--json")) == {"anna": {"lower": 0.5, "upper": 1.0}}
    assert set(document(run("trust", "--json"))) == {"anna", "sam"}
    assert "anna is trusted to 0.5." in run("trust")[1]


def test_untrusted_speaker_is_not_believed_and_told_so(run: Run):
    """No rule comes of it; the history has it."""
    run("trust", "eve", "0")

    code, said, _ = run("tell", "A mug is used for cutting", "--speaker", "eve")

    assert code == 1
    assert "eve" in said.lower()
    assert len(document(run("rules", "--json"))) == 2
    assert document(run("history", "--speaker", "eve", "--json"))[0]["accepted"] is False


def test_watch_shows_changes_a_line_each(run: Run):
    """From a number on; as JSON one document a line."""
    code, out, _ = run("watch", "--since", "1", "--for", "0", "--json")

    (change,) = map(json.loads, out.splitlines())
    assert (code, change["text"]) == (0, PASS)
    assert [rule["part"] for rule in change["rules"]["told"]] == ["blade"]
    assert "+ object:knife" in run("watch", "--since", "0", "--for", "0")[1]


@pytest.mark.parametrize(
    ("wanted", "shown"),
    [
        (("--object", "mug"), [3]),
        (("--speaker", "Anna"), [3]),
        (("--object", "knife", "--speaker", "sam"), [1, 2, 4]),
        (("--since", "4"), [4]),
    ],
)
def test_feed_is_of_an_object_or_a_speaker(run: Run, wanted: tuple[str, ...], shown: list[int]):
    """Each line has its number, so that who reads can go on behind it."""
    run("trust", "anna", "1")
    run("tell", "A mug is used for drinking", "--speaker", "anna")
    run("forget", "last")

    _, out, _ = run("watch", "--since", "0", *wanted, "--for", "0", "--json")

    changes = [json.loads(line) for line in out.splitlines()]
    touched = [one["sequence"] for one in changes if any(one["rules"].values())]
    assert touched == [number + (number > 2) for number in shown]
    assert all(one["speaker"] and one["time"] for one in changes)


def test_feed_goes_on_where_another_process_writes(run: Run, tmp_path: Path):
    """It shows each change once, however it is polled."""
    feed = subprocess.Popen(
        [sys.executable, "-c", "from hilt.agent.cli import main; main()",
         *("watch", "--since", "2", "--json", "--every", "0.05", "--kb", str(tmp_path / "kb"))],
        stdout=subprocess.PIPE, text=True,
    )  # fmt: skip
    with feed, KnowledgeBase.open(tmp_path / "kb") as base:
        numbers = [
            base.record(f"Hello {number}.", "", "sam", "statement", accepted=True).sequence
            for number in range(5)
        ]
        assert feed.stdout is not None
        seen = [json.loads(feed.stdout.readline())["sequence"] for _ in numbers]
        feed.terminate()
    assert seen == numbers


def test_diff_of_equal_bases_is_empty(run: Run, hilt: Run, tmp_path: Path):
    """An export believes what its base does."""
    run("export", tmp_path / "all.trig")

    code, out, _ = hilt("diff", tmp_path / "kb", tmp_path / "all.trig")

    assert (code, out) == (0, "They believe the same.\n")


def test_diff_tells_what_changed_and_fails(run: Run, hilt: Run, tmp_path: Path):
    """As the lines of a patch, with exit code 1."""
    run("export", tmp_path / "all.trig")
    run("forget", "last")
    run("tell", "A mug is used for drinking")

    code, out, _ = hilt("diff", tmp_path / "all.trig", tmp_path / "kb")

    assert code == 1
    assert "+ object:mug" in out
    assert "[0.95, 1.00] -> retracted" in out
    found = json.loads(hilt("diff", tmp_path / "all.trig", tmp_path / "kb", "--json")[1])
    assert (len(found["added"]), len(found["altered"])) == (1, 1)


def test_merge_reports_conflicts(run: Run, hilt: Run, tmp_path: Path):
    """What came, and what it contradicts; a dry run changes nothing."""
    other = tmp_path / "other"
    hilt("tell", "A knife is never used for cutting", "--kb", other)

    dry = document(hilt("merge", tmp_path / "kb", other, "--dry-run", "--json"))
    before = document(run("rules", "--json"))
    code, _, said = hilt("merge", tmp_path / "kb", other)

    (conflict,) = dry["conflicts"]
    assert (len(before), dry["new"], dry["applied"]) == (2, 1, False)
    assert code == 0
    assert f"Read 1 rule from {other}: 1 new, 0 already known, 1 conflicting." in said
    assert f"usedFor(cutting) [0.95, 1.00]>: {conflict['weight']:.4f}" in said
    assert len(document(run("rules", "--json"))) == 3


def test_merging_what_is_not_there_is_an_error(run: Run, hilt: Run, tmp_path: Path):
    """Neither a base nor a file."""
    code, _, error = hilt("merge", tmp_path / "kb", tmp_path / "nothing")

    assert code == 2
    assert "neither a knowledge base nor a file" in error


# --- The graph


def test_graph_is_drawn_and_filtered(run: Run, tmp_path: Path):
    """All rules, or those of a context."""
    picture, image = tmp_path / "rules.svg", tmp_path / "rules.png"

    whole = run("graph", picture)
    some = run("graph", image, "--context", "pass")

    assert (whole[0], some[0]) == (0, 0)
    assert "Drew 2 rules" in whole[2]
    assert "Drew 1 rule " in some[2]
    assert "cutting" in picture.read_text(encoding="utf-8")
    assert image.read_bytes().startswith(b"\x89PNG")


def test_graph_as_json_is_nodes_and_edges(run: Run):
    """For other programs; nothing is drawn."""
    found = document(run("graph", "--json", "--object", "knife"))

    assert {node["id"] for node in found["nodes"]} == {
        "object:knife", "affordance:cutting", "part:blade",
    }  # fmt: skip
    assert {(edge["from"], edge["to"]) for edge in found["edges"]} == {
        ("object:knife", "affordance:cutting"),
        ("object:knife", "part:blade"),
    }


def test_graph_goes_to_stdout_too(run: Run):
    """A dash is standard output."""
    assert "<svg" in run("graph", "-")[1]


@pytest.mark.parametrize(
    ("file", "said"), [("rules.txt", "no picture"), ("no/such/rules.svg", "cannot be written")]
)
def test_graph_that_cannot_be_drawn_is_an_error(run: Run, file: str, said: str):
    """A line, and code 2."""
    code, _, error = run("graph", file)

    assert (code, said in error) == (2, True)


# --- Experience ------------------------------------------------------------------------------


@pytest.fixture
def tried(run: Run, tmp_path: Path) -> Run:
    """The same after grasps: 4 of 5 slipped by the blade, and 5 of 5 held by the handle."""
    trials = [GraspTrial("knife", "blade", "pass", "held", "panda")]
    trials += [GraspTrial("knife", "blade", "pass", "slipped", "panda")] * 4
    trials += [GraspTrial("knife", "handle", "pass", "held", "panda")] * 5
    done = Episode(
        goal="pass(self,knife)", text="pass me the knife", speaker="sam", outcome="done",
        said="Here is the knife.", seed=0, document="{}", trials=tuple(trials),
    )  # fmt: skip
    with Agent.open(str(tmp_path / "kb"), AgentConfig(simulate=False)) as agent:
        agent.base.record_episode(done)
    return run


def test_experience_is_listed_with_its_interval(tried: Run):
    """A row for each part, with counts and what follows from them; also for one part alone."""
    blade, handle = document(tried("experience", "--json"))
    assert document(tried("experience", "--json", "--part", "blade")) == [blade]

    assert blade == {
        "object": "knife", "part": "blade", "context": "pass", "robot": "panda", "trials": 5,
        "outcomes": {"held": 1, "slipped": 4}, "lower": 0.005051, "upper": 0.716418,
    }  # fmt: skip
    assert (handle["part"], handle["lower"], handle["upper"]) == ("handle", 0.478176, 1.0)
    assert "held 1, slipped 4 of 5" in tried("experience")[1]


def test_trust_is_suggested_and_not_changed(tried: Run):
    """What the record says about a teacher is shown, and nothing else happens."""
    (sam,) = document(tried("trust", "--suggest", "--json"))

    assert (sam["speaker"], sam["trust"], sam["suggested"]) == ("sam", 1.0, 0.716418)
    assert "0.72" in tried("trust", "sam", "--suggest")[1]
    assert document(tried("trust", "--json"))["sam"] == {"lower": 1.0, "upper": 1.0}
    assert tried("trust", "sam", "0.5", "--suggest")[0] == 2


def test_experience_is_kept_and_can_be_forgotten(tried: Run):
    """It makes Hilt ask, in each later process, until it is forgotten."""
    command = ("do", "pass me the knife", "--no-sim", "--scene", "objects:knife", "--json")

    asked = json.loads(tried(*command)[1])
    code, said, _ = tried("forget", "experience", "knife", "blade")

    assert asked["outcome"] == "asked"
    assert asked["said"] == (
        "You told me the blade, but it slipped 4 times of 5. By the handle it held 5 of 5. "
        "Shall I take the handle?"
    )
    assert (code, said) == (0, "Forgot what 5 grasps came to.\n")
    assert document(tried(*command))["outcome"] == "done"
    assert tried("forget", "experience", "mug")[0] == 1
